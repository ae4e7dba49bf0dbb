-- A cylinder of glass beads in four states
--
-- Question. A cylindrical column of beads is let go and spreads in all
-- directions. How far does it run, and does the plane of r and z say the same
-- as a run in three dimensions?
--
-- Geometry. A column of radius r_i and height a r_i on a rough bed, in a vacuum.
-- Nothing depends on the angle around the axis: a plane of r and z is enough
-- (coordinates = "axisymmetric"); with dimension=3 it is a quarter of the column
-- between two mirrors, on an octree.
--
--   a +---+------------------------+
--   x |vacuum                      |
--   i +---+ a r_i                  |
--   s |   |                        |
--     +---+----------bed-----------+
--      r_i
--
-- Units. SI. Volumes and energies are those of the whole turn, with dimension=3
-- those of the quarter.
--
-- Numbers. Table I of the source; r_i = 10 cm, beads of 1.15 mm.
--
-- Source. C.-H. Lee, Z. Huang & Y.-M. Chiew, A three-dimensional continuum
-- model incorporating static and kinetic effects for granular flows, Phys.
-- Fluids 27 (2015) 113303, for the model; their columns are plane ones.
--
-- Cost. 16 cells to r_i: a second on one core; with dimension=3 a minute
-- and a half.
--
-- Expect. The contour comes to rest at 24.2 cm and 5.8 cm high, on 32 cells at
-- 25.3 cm; with dimension=3 at 24.3 cm and 5.8 cm.
--
-- Try. dimension=3; a=2; eta_S=0.3; examples/cylinder.lua, the same column with
-- the mu(I) rheology in a light gas.

local a = param("a", 1, "aspect ratio of the column, height over radius")
local dimension = param("dimension", 2, "2: axisymmetric, 3: a quarter")
local cells = param("cells", 16, "finest cells to r_i, a power of 2")
local r_i = param("r_i", 0.1, "radius of the column, m")
local d = param("d", 1.15e-3, "grain diameter, m")
local eta_S = param("eta_S", 0.42, "friction coefficient at rest")
local regularisation = param("regularisation", "exponential",
                             "of friction: exponential or exact")
local stop = param("stop", 6, "time of the end, in sqrt(a r_i/g)")
local snapshots = param("snapshots", 0.5, "interval of snapshots, likewise")

local g = 9.81                          -- m/s^2
local flat = dimension == 2
local time = math.sqrt(a * r_i / g)     -- s
-- a box twice the run of a cylinder, 1.2 a r_i and 1.9 sqrt(a) r_i
local size = 4
while size < 1.3 * (1 + math.min(1.2 * a, 1.9 * math.sqrt(a))) or size < 1.2 * a do
  size = 2 * size
end

return {
  title = "Cylinder of glass beads in four states, a = " .. a,
  model = "four_state",
  dimension = dimension,
  coordinates = flat and "axisymmetric" or "cartesian",
  domain = { size = size * r_i, level_min = 3,
             level = math.floor(math.log(size * cells, 2) + 0.5) },
  gravity = flat and { 0, -g } or { 0, 0, -g },
  grains = {
    rho_d = 2500, d = d, eta_S = eta_S, regularisation = regularisation,
    shape = function(x, y, z)
      if flat then return math.min(r_i - x, a * r_i - y) end
      return math.min(r_i - math.sqrt(x^2 + y^2), a * r_i - z)
    end,
  },
  boundary = {
    left = "symmetry", right = "no_slip",
    front = not flat and "symmetry" or nil,
    back = not flat and "no_slip" or nil,
    bottom = "no_slip", top = "slip",
  },
  adapt = { { "interface", width = 2 }, { "inside" } },
  output = { stop = stop * time, length_scale = r_i,
             profile_times = { time, 2 * time, stop * time },
             snapshot_every = snapshots * time },

  expect = {
    run = "cells=16",
    front = { 0.23, 0.26 },
    height = { 0.055, 0.061 },
  },
}
