local case = param("case", 2, "which column: 1, 2 or 3")
local level = param("level", 8, "finest grid: 0.64 m/2^level")
local stop = param("stop", 7, "time of the end, in tau_c")
local adaptive = param("adaptive", 1, "1: fine where grains are; 0: uniform")

local size = 0.64
local g = 9.81
local columns = { { 0.0612, 0.102 }, { 0.1344, 0.056 }, { 0.165, 0.01 } }
if not columns[case] then error("case must be 1, 2 or 3") end
local height, length = columns[case][1], columns[case][2]
param("tau_c", math.sqrt(height / g), "time in which grains fall H_i/2, s")
local tau_c = math.sqrt(height / g)

return {
  title = "Column of glass beads, four states, case " .. case,
  model = "four_state",
  dimension = 2,
  domain = { size = size, level = level, level_min = 4 },
  gravity = { 0, -g },
  grains = {
    shape = function(x, y) return math.min(length - x, height - y) end,
    eta_S = param("eta_S", 0.42, "friction coefficient at rest"),
    e_eff = param("e_eff", 0.58, "effective coefficient of restitution"),
  },
  boundary = { left = "slip", right = "no_slip", bottom = "no_slip", top = "slip" },
  adapt = adaptive == 1 and { { "interface", width = 3 }, { "inside" } } or nil,
  solver = { tolerance = 1e-4, cfl = 0.45 },
  output = { stop = stop * tau_c, length_scale = length,
             profile_times = { 0, 0.5 * tau_c, tau_c, 2 * tau_c, 3 * tau_c },
             snapshot_every = param("snap", 0.5, "") * tau_c },
}
