-- A lid drags a fluid round in a box: uniform grid, one phase, all of the step
-- but the interface. For tools/bench.py.

local level = param("level", 8, "cells: 2^level a side")

return {
  title = "Lid-driven cavity",
  dimension = 2,
  domain = { size = 1, level = level },
  gravity = { 0, 0 },
  grains = { density = 1, rheology = { "newtonian", eta = 1e-2 } },
  boundary = {
    left = "no_slip", right = "no_slip", bottom = "no_slip",
    top = { "no_slip", velocity = { 1, 0 } },
    pressure_level = 0,
  },
  output = { stop = 1 },
}
