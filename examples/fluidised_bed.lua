-- Fluidised bed: water lifts a bed of grains
--
-- Question. Water flows up through a bed of grains. When does the bed begin to
-- float, and how far does it expand?
--
-- Geometry. A bed of height H in a column, on a plate that lets water in.
--
--      +----+  2 H, open, grains stay
--      |    |
--      |####|  H
--      |####|
--      +-^^-+  U
--
-- Units. SI.
--
-- Numbers. Grains of 1 mm, 2560 kg/m^3, in water. The bed floats above U_mf =
-- 10.3 mm/s, where Ergun's drag on alpha = 0.585 is its weight. Then alpha
-- follows from drag = weight: 0.5411 at 14 mm/s, 0.5198 at 16 mm/s.
--
-- Source. S. Ergun, Fluid flow through packed columns, Chem. Eng. Prog. 48 (1952)
-- 89.
--
-- Cost. 48 leaves high: 950 steps to 10 s, two seconds on one core.
--
-- Expect. The pressure below the bed is the weight of the grains, 842 Pa; alpha is
-- 0.541 in the end.
--
-- Try. U=0.005: the bed rests, and carries what water does not. U=0.016.

local cells = param("cells", 48, "leaves to the height, a multiple of 4")
local U = param("U", 0.014, "velocity of the water far below, m/s")
local stop = param("stop", 10, "time of the end, s")
local H = 0.1                                      -- m

return {
  title = "Fluidised bed in water",
  model = "two_fluid",
  dimension = 2,
  domain = { size = 8 * H / cells, trees = { 1, cells // 4 }, level = 2,
             level_min = 2 },
  gravity = { 0, -9.81 },
  grains = { shape = function(x, y) return H - y end,
             density = 2560, d = 1e-3 },
  fluid = "water",
  closure = "ktgf",
  boundary = { left = "periodic", right = "periodic",
               bottom = { "inflow", velocity = { 0, U } },
               top = { "outflow", pressure = 0 } },
  solver = { tolerance = 1e-6, cfl = 0.5 },
  output = { stop = stop, length_scale = H, snapshot_every = stop / 5 },
  expect = {
    run = "cells=48",
    most_pressure = { 815, 850 },       -- Pa; 843, half a leaf up
    max_alpha = { 0.540, 0.560 },       -- of the top; 0.545
  },
}
