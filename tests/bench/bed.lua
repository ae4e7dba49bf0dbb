-- Grains under a tilted surface in a box, uniform grid: all of the step, on as
-- many cells as asked for. For tools/bench.py: memory, and time against size.

local dimension = param("dimension", 2, "2 or 3")
local level = param("level", 8, "cells: 2^level a side")
local d = 0.02

local gravity = dimension == 2 and { 0, -1 } or { 0, 0, -1 }
return {
  title = "Grains slide down",
  dimension = dimension,
  domain = { size = 1, level = level },
  gravity = gravity,
  grains = {
    density = 1,
    rheology = { "mu_i", d = d, eta_min = math.sqrt(d^3),
                 regularisation = "clip", eta_max = 10 },
    shape = function(x, y, z)
      return 0.7 - 0.6 * x - (dimension == 2 and y or z)
    end,
  },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-4 } },
  boundary = {
    left = "no_slip", right = "no_slip",
    front = dimension == 3 and "slip" or nil,
    back = dimension == 3 and "slip" or nil,
    bottom = "no_slip", top = { "outflow", pressure = 0 },
  },
  output = { stop = 1 },
}
