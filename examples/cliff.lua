-- Collapse of a cliff of sand in air, water or polymer
--
-- Question. A cliff of sand stands in a fluid and its gate goes. How does the
-- fluid between the grains change how far it runs?
--
-- Geometry. A cliff of length x_0 and height a x_0 at a smooth wall, in a box of
-- 4 x_0.
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
-- Source. B. Busch & S. T. Johansen, On the validity of the two-fluid-KTGF
-- approach for dense gravity-driven granular flows as implemented in ANSYS Fluent
-- R17.2, Powder Technol. 364 (2020) 429, whose closures are closure="ktgf".
--
-- Cost. Level 6, 1 s: 330 steps in air, 170 in water, 5 to 8 s on one core.
--
-- Expect. After 1 s the front is at 2.46 x_0 in air and at 2.96 x_0 in water, and
-- grains of the surface still creep by 2 cm/s: leaves of the surface have no
-- strength yet (docs/notes/two_fluid.md).
--
-- Try. fluid=water, fluid=pac4 d=1e-4 stop=20, a=2, closure=ktgf.

local fluid = param("fluid", "air", "air, water, pac2 or pac4")
local a = param("a", 1, "height over length")
local x_0 = param("x_0", 0.1, "length, m")
local level = param("level", 6, "finest grid: 4 x_0/2^level")
local stop = param("stop", 1, "time of the end, s")

return {
  title = "Collapse of a cliff of sand, fluid " .. fluid,
  model = "two_fluid",
  dimension = 2,
  domain = { size = 4 * x_0, level = level, level_min = level - 2 },
  gravity = { 0, -9.81 },
  grains = {
    shape = function(x, y) return math.min(x_0 - x, a * x_0 - y) end,
    density = 2560, d = param("d", 1e-3, "grain diameter, m"),
    start = param("start", "settled", "settled, patched or dense"),
    alpha_start = param("alpha", 0.6, "solid fraction, unless settled"),
  },
  fluid = fluid,
  closure = param("closure", "critical_state", "closures of the grains"),
  boundary = { left = "slip", right = "no_slip", bottom = "no_slip",
               top = "slip" },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = 1e-4, cfl = 0.5 },
  output = { stop = stop, length_scale = x_0, snapshot_every = stop / 10,
             profile_times = { 0, 0.25 * stop, 0.5 * stop, stop } },
  expect = {
    run = "level=5 stop=0.3",
    front = { 0.20, 0.26 },             -- m; level 6: 0.219
  },
}
