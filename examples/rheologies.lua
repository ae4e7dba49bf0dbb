-- Which fluids behave like grains?
--
-- Question. A column of grains collapses as the mu(I) rheology says. Which part
-- of that would any thick fluid do: one of constant viscosity, one with a yield
-- stress, one with Bagnold's viscosity, one with constant friction?
--
-- Geometry. Half of a plane column of half-width L0 and height H0 = a L0 on a
-- rough floor, its plane of symmetry on the left, in a square box of edge
-- 8 L0 full of light gas and open at the top.
--
-- Units. Lengths in L0, times in sqrt(L0/g), the density of the grains is 1;
-- so pressures are in rho g L0, velocities in sqrt(g L0), viscosities in
-- rho sqrt(g L0^3).
--
-- Numbers. law = mu_i: mu(I) = mu_s + delta_mu/(I0/I + 1) with 0.32, 0.28, 0.4
--   and d = 0.0219; newtonian: eta = 0.1; bingham: eta = 0.001 + 0.1/gamma;
--   bagnold: eta = rho d^2 gamma with d = 1/32; coulomb: mu = 0.33. The grains
--   are never stiffer than eta_max, as in the paper (regularisation=exact caps
--   nothing); the gas is 1000 times lighter.
--
-- Source. P.-Y. Lagree, L. Staron & S. Popinet, The granular column collapse as
-- a continuum: validity of a two-dimensional Navier-Stokes model with a
-- mu(I)-rheology, J. Fluid Mech. 686 (2011) 378, section 4.1, figures 14 and
-- 15. (Its text and caption give Bingham's two constants the opposite way
-- round; these are those that keep a corner.)
--
-- Cost. Level 7 (16 cells to L0, about 1,300 cells): less than a second.
--
-- Expect. mu_i and coulomb come to rest as heaps (stop=8), with fronts at
-- 4.1 and 4.9 L0; outlines are 0.7 d apart at 1.5 sqrt(H0/g), 1.6 d at 4, in
-- the mean. newtonian and bagnold never stop (fronts at 3.2 and 5.4 L0 at
-- 4 sqrt(H0/g), 3.8 and 7.7 at 8): a layer with a blunt front, and a thin one.
-- bingham stops with a steep rounded front (4.1 L0), and carries the upper
-- corner of the column along as a solid, a hump in the deposit.
--
-- Try. All in one picture of five panels:
--   tools/sweep.py examples/rheologies.lua \
--     law=mu_i,newtonian,bingham,bagnold,coulomb stop=8
-- and a=6.26 size=32 level=9, where constant friction does worse.

local law = param("law", "mu_i",
                  "mu_i, newtonian, bingham, bagnold or coulomb")
local a = param("a", 1.42, "aspect ratio H0/L0 of the column")
local size = param("size", 8, "edge of the box, in L0")
local level = param("level", 7, "finest grid: size/2^level")
local stop = param("stop", 4, "time of the end, in sqrt(H0/g)")
-- so that heaps of friction 0.33 creep at less than 1e-4 sqrt(g H0): rho g
-- sin(alpha) H0^2/(2 eta_max), tan(alpha) = 0.33
local regularisation = param("regularisation", "clip",
                             "of a yield stress; exact: without eta_max")
local eta_max = param("eta_max", 6000 * math.sin(math.atan(0.33)) * a^1.5,
                      "cap on viscosity, in rho sqrt(g L0^3)")
local tolerance = param("tolerance", 1e-4, "of the linear solvers")

local rho, g = 1, 1                     -- the units
local rho_gas, eta_gas = 1e-3, 1e-4     -- rho, rho sqrt(g L0^3)
local d = 0.0219                        -- grain diameter, L0
local eta_min = rho * math.sqrt(g * d^3)

local laws = {
  mu_i = { "mu_i", mu_s = 0.32, delta_mu = 0.28, I0 = 0.4, d = d,
           eta_min = eta_min },
  newtonian = { "newtonian", eta = 0.1 },
  bingham = { "bingham", tau_y = 0.1, eta_0 = 0.001 },
  bagnold = { "bagnold", d = 1/32 },
  coulomb = { "coulomb", mu_s = 0.33, eta_min = eta_min },
}
local rheology = laws[law]
if not rheology then error("no such law: " .. law) end
local yields = law ~= "newtonian" and law ~= "bagnold"
if yields then rheology.regularisation = regularisation end
if regularisation ~= "exact" or not yields then rheology.eta_max = eta_max end

local profile_times = {}                -- every half sqrt(H0/g)
for i = 0, 2 * stop do profile_times[i + 1] = 0.5 * i * math.sqrt(a / g) end

return {
  title = "Collapse of a column, " .. law,
  dimension = 2,
  domain = { size = size, level = level, level_min = 4 },
  gravity = { 0, -g },

  grains = {
    density = rho,
    rheology = rheology,
    shape = function(x, y) return math.min(1 - x, a - y) end,
  },
  gas = { density = rho_gas, rheology = { "newtonian", eta = eta_gas } },

  boundary = {
    left = "symmetry",
    right = "no_slip",
    bottom = "no_slip",
    -- so that the pressure of the gas vanishes at the floor
    top = { "outflow", pressure = -rho_gas * g * size },
  },

  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = tolerance },
  output = { stop = stop * math.sqrt(a / g), profile_times = profile_times,
             snapshot_every = 0.5 },

  expect = {
    front = { 3.9, 4.2 },
    height = { 0.69, 0.77 },
    volume = { 1.419, 1.421 },
  },
}
