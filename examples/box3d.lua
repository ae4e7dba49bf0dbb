-- A block of grains collapses in a box
--
-- Question. Does the three-dimensional program run? A small block in the corner
-- of a box is let go and spreads over the floor between two mirrors, a quarter
-- of a square heap. Not a validation: see column.lua for that.
--
-- Geometry. A cube of edge 4 L0; the block is L0 x L0 x a L0 and stands in the
-- corner of the two planes of symmetry, left and front. z points up.
--
-- Units. Lengths in L0, times in sqrt(L0/g), the density of the grains is 1.
--
-- Numbers. a = 1; mu(I) with 0.32, 0.28, 0.4; d/L0 = 0.05.
--
-- Cost. Level 5 (8 cells to L0): a few thousand cells, half a second on one
-- core.
--
-- Expect. A quarter of a low square pyramid with rounded corners.
--
-- Try. level=6; a=2; mu_s=0.6.

local a = param("a", 1, "height of the block, in L0")
local level = param("level", 5, "finest grid: 4 L0/2^level")
local stop = param("stop", 2, "time of the end, in sqrt(L0/g)")
local d = param("d", 0.05, "grain diameter, in L0")
local mu_s = param("mu_s", 0.32, "friction coefficient at rest")

local regularisation = param("regularisation", "exact", "of the yield stress")

-- of clip: its heap at rest creeps at rho g sin(alpha) a^2/(2 eta_max),
-- tan(alpha) = mu_s, less than 1e-4 sqrt(g a)
local eta_max = 6000 * math.sin(math.atan(mu_s)) * a^1.5  -- rho sqrt(g L0^3)

return {
  title = "A block of grains collapses in a box",
  dimension = 3,
  domain = { size = 4, level = level, level_min = 2 },
  gravity = { 0, 0, -1 },

  grains = {
    density = 1,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = 0.28, I0 = 0.4, d = d,
                 eta_min = math.sqrt(d^3),  -- rho sqrt(g d^3)
                 regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
    shape = function(x, y, z) return math.min(1 - x, 1 - y, a - z) end,
  },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-4 } },

  boundary = {
    left = "symmetry", front = "symmetry",
    right = "no_slip", back = "no_slip",
    bottom = "no_slip",
    top = { "outflow", pressure = 0 },
  },

  adapt = { { "interface", width = 2 }, { "inside" } },
  output = { stop = stop, profile_times = { 1 }, snapshot_every = 0.5 },

  expect = {
    front = { 1.9, 2.2 },
    height = { 0.65, 0.75 },
    volume = { 0.999, 1.001 },
  },
}
