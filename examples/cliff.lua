-- Collapse of a cliff of sand in air, water or polymer
--
-- Question. A cliff of sand stands in a fluid and its gate goes. How does the
-- fluid between the grains change how far it runs?
--
-- Geometry. A cliff of length x_0 and height a x_0 at a smooth wall, in a box
-- that is at least 4 x_0 high and `reach` long; gate=1 leaves the gate in place.
--
--      +----------------------+  4 x_0
--      |fluid                 |
--      +----+                 |
--      |sand| a x_0           |
--      +----+-----bed---------+
--       x_0
--
-- Units. SI.
--
-- Numbers. The regime follows from St = sqrt(rho_s (rho_s - rho_f) g d^3/2)/(18
-- eta) and r = sqrt(rho_s/rho_f), which `talus check` prints. Grains 2560 kg/m^3.
--
-- Source. A. Busch & S. T. Johansen, On the validity of the two-fluid-KTGF
-- approach for dense gravity-driven granular flows as implemented in ANSYS Fluent
-- R17.2, Powder Technol. 364 (2020) 429, whose closures are closure="ktgf". Its
-- figures: tools/figure.py busch_johansen_2020.
--
-- Cost. 16 leaves to x_0, 1 s: 230 steps in air, 150 in water, 3 to 5 s on one
-- core.
--
-- Expect. After 1 s the front is at 2.19 x_0 in air and at 2.40 x_0 in water, where
-- heaps stand (docs/notes/two_fluid.md).
--
-- Try. fluid=water, fluid=pac4 d=1e-4 stop=20, a=2, closure=ktgf,
-- closure=mu_i_phi_i; surface=none regularisation=clip: leaves of the surface have
-- no strength, and the heap levels out.

local fluid = param("fluid", "air", "air, water, pac2 or pac4")
local a = param("a", 1, "height over length")
local x_0 = param("x_0", 0.1, "length, m")
local cells = param("cells", 16, "finest leaves to x_0")
local reach = param("reach", 4, "least length of the box, in x_0")
local gate = param("gate", 0, "1: the gate stays, a bed from wall to wall")
local stop = param("stop", 1, "time of the end, s")
local regularisation = param("regularisation", "exact", "of friction: exact, clip")
local eta_max = param("eta_max", 0, "cap of clip, Pa s; 0: by the height")

-- the box is 4 x_0 high, or more, so that leaves are x_0/cells; with the gate a
-- quarter as long
local level = math.ceil(math.log(4 * cells, 2) - 1e-9)
local high = 2^level / cells                       -- x_0
local trees = { math.ceil(reach / high - 1e-9), 1 }
if gate == 1 then level, trees = level - 2, { 1, 4 } end

local outlines = {}                                -- s
for k = 0, 10 do outlines[k + 1] = 0.1 * k * stop end

return {
  title = "Collapse of a cliff of sand, fluid " .. fluid,
  model = "two_fluid",
  dimension = 2,
  domain = { size = high * x_0 / trees[2], trees = trees, level = level,
             level_min = math.max(level - 2, 0) },
  gravity = { 0, -9.81 },
  grains = {
    shape = function(x, y)
      if gate == 1 then return a * x_0 - y end
      return math.min(x_0 - x, a * x_0 - y)
    end,
    density = 2560, d = param("d", 1e-3, "grain diameter, m"),
    start = param("start", "settled", "settled, patched or dense"),
    alpha_start = param("alpha", 0.6, "solid fraction, unless settled"),
    surface = param("surface", "planes", "of the bed: planes, none"),
    regularisation = regularisation,
    eta_max = regularisation == "clip" and eta_max or nil,
  },
  fluid = fluid,
  closure = param("closure", "critical_state", "closures of the grains"),
  boundary = { left = "slip", right = "no_slip", bottom = "no_slip",
               top = "slip" },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = 1e-4, cfl = 0.5 },
  output = { stop = stop, length_scale = x_0, snapshot_every = stop / 10,
             profile_times = outlines },
  expect = {
    run = "cells=8 stop=0.3",
    front = { 0.18, 0.22 },             -- m; 16 leaves: 0.205
  },
}
