-- How far does a column run, depending on its friction?
--
-- Question. The friction mu(I) = mu_s + delta_mu/(I0/I + 1) has three
-- parameters. Which of them sets the run-out of a collapsing column, and by
-- what power?
--
-- Geometry. Half of a plane column of half-width L0 and height H0 = a L0 on a
-- rough floor, its plane of symmetry on the left, in a square box of edge 8 L0
-- full of light gas and open at the top. So that the front need not push gas
-- that sticks to the floor, the gas slips on a strip of 4 d ahead of it.
--
-- Units. Lengths in L0, times in sqrt(L0/g), the density of the grains is 1;
-- so pressures are in rho g L0, viscosities in rho sqrt(g L0^3).
--
-- Numbers. a = 1.42; mu_s = 0.32, delta_mu = 0.28, I0 = 0.4, one of which is
-- varied; 6041 grains, so a diameter d/L0 = sqrt(a/6041) = 0.0153; viscosity of
-- the gas, which is also the least of the grains, 1e-4 rho sqrt(g L0^3). (The
-- paper has 1e-4 rho sqrt(g H0^3). For a = 50 that is as thick as to hold the
-- front back by 7 % at 1.6 sqrt(H0/g) and to leave a spire on the axis.) The
-- run ends when the grains rest.
--
-- Source. L. Valette et al., Sensitivity to the rheology and geometry of
-- granular collapses by using the mu(I) rheology, Comput. Fluids 191 (2019),
-- section 3, eqs. 7 and 8, figures 2, 7, 11, 13; the signs also in P.-Y. Lagree
-- et al., J. Fluid Mech. 686 (2011) 378, figure 16.
--
-- Cost. Level 7 (16 cells to L0, about 1,300 cells): half a second a run;
-- level 8 two seconds.
--
-- Expect. Less friction of any kind runs further: the run-out falls with mu_s
-- and delta_mu and rises with I0. Valette finds run-out ~ mu_s^-1.2 (0.32 to
-- 0.62) and I0^0.11 (0.04 to 4), and a power four times weaker for delta_mu
-- than for mu_s; here it is mu_s^-1.10, I0^0.12, delta_mu^-0.31 (at level 8
-- mu_s^-1.08). More friction also means an earlier arrest, from
-- 6.5 sqrt(L0/g) for mu_s = 0.32 to 4.7 for 0.62. The strip makes no odds: the
-- front comes to 4.38 L0 with and without (strip=0), for a=20 to 28.9.
--
-- Try. The figures of the paper, with its numbers beside ours:
--   tools/figure.py valette_2019 7 11 13
-- or one sweep each:
--   tools/sweep.py examples/sensitivity.lua mu_s=0.32,0.42,0.52,0.62
--   tools/sweep.py examples/sensitivity.lua delta_mu=0.18,0.28,0.38,0.48
--   tools/sweep.py examples/sensitivity.lua I0=0.04,0.4,4
-- each with level=8, or with a=10 size=32 level=9.

local a = param("a", 1.42, "aspect ratio H0/L0 of the column")
local size = param("size", 8, "edge of the box, in L0")
local level = param("level", 7, "finest grid: size/2^level")
local stop = param("stop", 12, "time of the end at the latest, in sqrt(H0/g)")
local rest = param("rest", 1e-3, "speed, in sqrt(g H0), at which grains are " ..
                                 "at rest and the run ends")
local d = param("d", math.sqrt(a / 6041), "grain diameter, in L0")
local mu_s = param("mu_s", 0.32, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.28, "rise of friction at large I")
local I0 = param("I0", 0.4, "inertial number at half that rise")
local eta_air = param("eta_air", 1e-4, "viscosity of the gas and the least " ..
                                        "of the grains, in rho sqrt(g L0^3)")
local strip = param("strip", 4 * d, "of the floor ahead of the grains where " ..
                                    "gas slips, in L0; 0: it nowhere does")
local tolerance = param("tolerance", 1e-4, "of the linear solvers")
local picard = param("picard", 0, "repetitions within a step")
local times = param("times", {0, 1, 2, 4},
                    "times of the outlines, in sqrt(H0/g)")
local every = param("every", 0, "time between snapshots, in sqrt(H0/g); " ..
                                "0: the first and the last only")

local rho, g = 1, 1                     -- the units
local rho_gas = 1e-3                    -- rho
local unit = math.sqrt(a / g)           -- of time, sqrt(H0/g)

local profile_times = {}
for i, t in ipairs(times) do profile_times[i] = t * unit end

return {
  title = "Run-out of a column, mu_s = " .. mu_s .. ", delta_mu = " ..
          delta_mu .. ", I0 = " .. I0,
  dimension = 2,
  domain = { size = size, level = level, level_min = 4 },
  gravity = { 0, -g },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = eta_air },
    shape = function(x, y) return math.min(1 - x, a - y) end,
  },
  gas = { density = rho_gas, rheology = { "newtonian", eta = eta_air } },

  boundary = {
    left = "symmetry",
    right = "no_slip",
    bottom = strip > 0 and { "slip_strip", length = strip } or "no_slip",
    -- so that the pressure of the gas vanishes at the floor
    top = { "outflow", pressure = -rho_gas * g * size },
  },

  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = tolerance, picard = picard },
  output = {
    stop = stop * unit,
    stop_at_rest = { speed = rest * math.sqrt(g * a), time = 0.2 * unit },
    profile_times = profile_times,
    snapshot_every = every * unit,
  },

  expect = {
    front = { 4.2, 4.5 },
    height = { 0.72, 0.78 },
    volume = { 1.419, 1.421 },
    max_speed = { 0, 0.005 },           -- at rest
  },
}
