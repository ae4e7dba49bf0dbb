-- A disc of grains in a shear flow, for the model of tests/model/given_flow.c.
local level = param("level", 6, "finest level")
return {
  dimension = 2,
  model = "given_flow",
  shear_rate = 0.5,
  domain = { size = 1, level = level },
  gravity = { 0, -1 },
  grains = {
    density = 1,
    shape = function(x, y) return 0.0225 - (x - 0.5)^2 - (y - 0.5)^2 end,
  },
  boundary = {
    left = "periodic", right = "periodic", bottom = "slip", top = "slip",
  },
  adapt = { { "interface", width = 2 } },
  output = { stop = 1, profile_times = { 0, 1 } },
}
