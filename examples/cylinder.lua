-- Collapse of a cylinder of grains
--
-- Question. A cylindrical column of dry grains is let go and spreads in all
-- directions. How far does it run, how does that depend on its aspect ratio, and
-- on the number of grains across it?
--
-- Geometry. A column of radius r_i and height h_i = a r_i stands on a floor in a
-- light gas. Nothing depends on the angle around the axis, so that a plane of r
-- and z is enough (coordinates = "axisymmetric"); with dimension=3 it is a
-- quarter of the column between two mirrors, on an octree.
--
--   a +---+-------------open-----------+
--   x |gas|                            |
--   i +---+ h_i = a r_i                | slip
--   s |   |                            |
--     | g |                            |
--     +---+------------floor-----------+
--      r_i
--
-- Units. Lengths in r_i, times in sqrt(r_i/g), the density of the grains is 1.
-- The radius r_i in metres only says how many grains lie across it. Volumes and
-- energies are those of the whole turn, with dimension=3 those of the quarter.
--
-- Numbers. mu(I) with 0.38, 0.28 and I0 = 0.279 [Jop et al. 2006]; d = 0.54 mm;
-- r_i = 0.2 m or 0.02 m. The floor is rough; with strip > 0 gas slips on it for so
-- many grain diameters ahead of the grains.
--
-- Source. R. Valette, S. Riber, L. Sardo, R. Castellani, F. Costes, N. Vriend &
-- E. Hachem, Sensitivity to the rheology and geometry of granular collapses by
-- using the mu(I) rheology, Comput. Fluids 191 (2019), section 4 and figure 33:
--   (r_f - r_i)/r_i = 1.2 a below a = 2.7, 1.93 a^0.54 above.
--
-- Cost. 16 cells to r_i: half a second on one core, 32: one, 64: six; 16 cells
-- with dimension=3: half a minute.
--
-- Expect. The heap comes to rest at about 6 sqrt(h_i/g) with its front at 2.75
-- r_i, at 2.25 r_i if r_i = 0.02 m: fewer grains, larger I, more friction.
--
-- Try. The figures of the paper, with its numbers beside ours:
--   tools/figure.py valette_2019 30 31 32 33
-- r_i=0.02; a=5; strip=3; dimension=3 cells=16; mu_s=0.5.

local a = param("a", 1, "aspect ratio h_i/r_i of the column")
local dimension = param("dimension", 2, "2: axisymmetric, 3: a quarter")
local cells = param("cells", 32, "finest cells to r_i, a power of 2")
local r_i = param("r_i", 0.2, "radius of the column, in m")
local d_mm = param("d_mm", 0.54, "grain diameter, in mm")
local mu_s = param("mu_s", 0.38, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.28, "rise of friction at large I")
local I0 = param("I0", 0.279, "inertial number at half that rise")
local strip = param("strip", 0,
                    "grain diameters of smooth floor ahead of the grains")
local regularisation = param("regularisation", "exact",
                             "of the yield stress; clip: with eta_max")
local stop = param("stop", 8, "time of the end, in sqrt(h_i/g)")
local tolerance = param("tolerance", 1e-4, "of the linear solvers")
local rho_gas = param("rho_gas", 1e-3, "density of the gas, in that of grains")

local d = 1e-3 * d_mm / r_i                     -- in r_i
-- a box for a front 1.3 times as far as the paper's
local run = a < 2.7 and 1.2 * a or 1.93 * a^0.54
local size = 2
while size < 1.3 * (1 + run) or size < 1.2 * a do size = 2 * size end
local level = math.floor(math.log(size * cells, 2) + 0.5)
local time = math.sqrt(a)                       -- sqrt(h_i/g) in sqrt(r_i/g)
local flat = dimension == 2
local times = {}                                -- of outlines
for _, t in ipairs({ 1, 2, 4 }) do
  if t <= stop then times[#times + 1] = t * time end
end

return {
  title = "Collapse of a cylinder of grains, a = " .. a,
  dimension = dimension,
  coordinates = flat and "axisymmetric" or "cartesian",
  domain = { size = size, level = level, level_min = math.min(3, level) },
  gravity = flat and { 0, -1 } or { 0, 0, -1 },
  grains = {
    density = 1,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = math.sqrt(d^3), regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and 5000 * a^1.5 or nil },
    shape = function(x, y, z)
      if flat then return math.min(1 - x, a - y) end
      return math.min(1 - math.sqrt(x^2 + y^2), a - z)
    end,
  },
  gas = { density = rho_gas, rheology = { "newtonian", eta = 1e-4 } },
  boundary = {
    left = "symmetry",
    right = "slip",
    front = not flat and "symmetry" or nil,
    back = not flat and "slip" or nil,
    bottom = strip > 0 and { "slip_strip", length = strip * d } or "no_slip",
    top = { "outflow", pressure = -rho_gas * size },
  },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = tolerance },
  output = { stop = stop * time,
             stop_at_rest = { speed = 1e-3 * time, time = 0.5 * time },
             profile_times = times,
             snapshot_every = 0.25 * time },

  expect = {
    run = "cells=16",
    front = { 2.6, 2.7 },
    height = { 0.52, 0.55 },
    volume = { 3.1415, 3.1417 },
  },
}
