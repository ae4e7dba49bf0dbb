-- Collapse of a tall column of grains
--
-- Question. A column of dry grains, held by a wall, is let go. How does its
-- outline change with time, how far does the front run, and what becomes of the
-- inner part of the column?
--
-- Geometry. Half of a plane column of half-width L0 and height H0 = a L0 stands
-- on a rough floor; the left side is its plane of symmetry. A light gas fills
-- the rest of a square box of edge 32 L0, so wide that its sides do not matter.
--
--      |<---------------- size ---------------->|
--      +-----------------open-------------------+
--      |gas                                     |
--   s  |                                        | w
--   y  +---+                                    | a
--   m  |   |                                    | l
--   m  | g | H0 = a L0                          | l
--      +---+--------------floor-----------------+
--       L0
--
-- Units. Lengths in L0, times in sqrt(L0/g), the density of the grains is 1;
-- so pressures are in rho g L0, velocities in sqrt(g L0), viscosities in
-- rho sqrt(g L0^3).
--
-- Numbers. Aspect ratio a = H0/L0 = 6.26; friction mu(I) = mu_s + delta_mu/
-- (I0/I + 1), I = d gamma/sqrt(p/rho), with 0.32, 0.28 and 0.4; grain diameter
-- d/L0 = 0.0462; gas 1000 times lighter than the grains.
--
-- Source. P.-Y. Lagree, L. Staron & S. Popinet, The granular column collapse as
-- a continuum: validity of a two-dimensional Navier-Stokes model with a
-- mu(I)-rheology, J. Fluid Mech. 686 (2011) 378, section 3.2 and figure 10.
--
-- Cost. Level 10 (32 cells to L0, about 9,000 cells): three seconds on one
-- core. Level 9: less than one; level 8: a fraction of one.
--
-- Expect. The column falls and spreads. At 2.28 sqrt(H0/g) the front is between
-- 8.8 and 10.1 L0 and still advances (discrete grains: 9.7, Gerris: 8.95), the
-- top is at about 1.3 L0 and nearly at rest; what was the core lies as a bent
-- band in the flank. With stop=12 the heap comes to rest with its front near
-- 12 L0, at about 4 sqrt(H0/g).
--
-- Try. a=1.42 d=0.0219 stop=4.77 and a=0.5 d=0.0168 stop=2.83 (figures 9 and 8,
-- to 4 sqrt(H0/g)); mu_s=0.4: a stiffer heap; delta_mu=0: friction that does
-- not know the rate; eta_max=24000: a heap at rest that stays. The default is
-- the cap of Gerris, for comparison: with it a slope at rest creeps at up to
-- rho g sin(alpha) H0^2/(2 eta_max), tan(alpha) = mu_s, 0.6 sqrt(g L0), so do
-- not read a deposit from it; below 1e-4 sqrt(g H0) need eta_max = 5000
-- sin(alpha) a^1.5. Front and top at the end, level 9: 9.195, 1.300 and 9.200,
-- 1.307, for two thirds more viscous iterations. advection=off: the grains lose
-- their inertia and run as a wave (figure 14e). The figures of the paper, with
-- its numbers beside ours: tools/figure.py lagree_staron_popinet_2011 12

local a = param("a", 6.26, "aspect ratio H0/L0 of the column")
local size = param("size", 32, "edge of the box, in L0")
local level = param("level", 10, "finest grid: size/2^level")
local stop = param("stop", 5.8, "time of the end, in sqrt(L0/g)")
local d = param("d", 0.04623, "grain diameter, in L0")
local mu_s = param("mu_s", 0.32, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.28, "rise of friction at large I")
local I0 = param("I0", 0.4, "inertial number at half that rise")
local eta_max = param("eta_max", 10, "cap on viscosity, in rho sqrt(g L0^3)")
local eta_min = param("eta_min", math.sqrt(d^3),
                      "least viscosity, in rho sqrt(g L0^3)")
local regularisation = param("regularisation", "clip",
                             "of the yield stress; exact: without eta_max")
local slip = param("slip", 0, "slip length of the floor, in L0; 0: rough")
local advection = param("advection", "on", "of momentum; off: without inertia")
local rho_gas = param("rho_gas", 1e-3, "density of the gas, in rho")
local shift = param("shift", 0, "cells by which the side misses a face")
local tolerance = param("tolerance", 1e-4, "of the linear solvers")
local cfl = param("cfl", 0.7, "bound on sum |u_f| A dt/(2 V), the time step")
local times = param("times", {0.66, 0.95, 1.24, 1.52, 2.28},
                    "times of the outlines, in sqrt(H0/g)")
local every = param("every", 0.1, "time between snapshots, in sqrt(L0/g)")
local front_height = param("front_height", 0, "of the heap where its front " ..
                           "is, in L0; 0: half the finest cell")
local rest = param("rest", 0, "speed, in sqrt(g H0), at which grains are at " ..
                              "rest and the run ends; 0: it goes on to stop")
param("reference", a == 6.26 and "reference/contact_dynamics_a6.26.csv" or "",
      "outlines of the grains that `talus plot` lays over ours")

local rho, g = 1, 1                     -- the units
local eta_gas = 1e-4                    -- rho sqrt(g L0^3)
local width, height = 1, a              -- of the column
-- a box so much smaller that its cells end `shift` cells off the side
local box = size / (1 + shift * size / 2^level)

local profile_times = {}                -- in sqrt(L0/g): sqrt(H0/g) = sqrt(a)
for i, t in ipairs(times) do profile_times[i] = t * math.sqrt(a) end

return {
  title = "Collapse of a column of grains, a = " .. a,
  dimension = 2,
  domain = { size = box, level = level, level_min = 4 },
  gravity = { 0, -g },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = eta_min, regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
    -- distance to the edges of the column, positive inside
    shape = function(x, y) return math.min(width - x, height - y) end,
  },
  gas = { density = rho_gas, rheology = { "newtonian", eta = eta_gas } },

  -- The white part of the column in figure 10: black are the 4 d next to the
  -- plane of symmetry, 5 d at the side and 9 d at the top.
  tracers = {
    core = function(x, y)
      return math.min(x - 4 * d, width - 5 * d - x, height - 9 * d - y)
    end,
  },

  boundary = {
    left = "symmetry",
    right = "no_slip",
    bottom = slip > 0 and { "navier_slip", slip_length = slip } or "no_slip",
    -- so that the pressure of the gas vanishes at the floor
    top = { "outflow", pressure = -rho_gas * g * box },
  },

  adapt = { { "interface", width = 4 }, { "inside" } },
  solver = { tolerance = tolerance, cfl = cfl, advection = advection },
  output = {
    stop = stop,
    stop_at_rest = rest > 0 and { speed = rest * math.sqrt(g * a),
                                  time = 0.2 * math.sqrt(a / g) } or nil,
    profile_times = profile_times,
    snapshot_every = every,
    front_height = front_height,
  },

  expect = {
    run = "level=8",
    front = { 8.8, 10.1 },
    height = { 1.2, 1.4 },
    volume = { 6.259, 6.261 },
  },
}
