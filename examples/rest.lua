-- A heap of grains that stands, or slides when its floor is tilted too far
--
-- Question. Dry grains rest in a heap whose slope is below their angle of
-- repose. A solver with a capped viscosity lets such a heap creep for ever.
-- Does it rest, and at which tilt of the floor does it begin to slide?
--
-- Geometry. Half a heap between a plane of symmetry and the open floor, height
-- 0.3 at x = 0, slope 0.176 (10 degrees); gas above. `tilt` inclines gravity.
--
--      :  p = 0
--      :
--      |\__
--      |   \__            g = (sin(tilt), -cos(tilt))
--      |      \__
--      +---------\-------- floor: grains stick
--
-- Units. Lengths in half the width of the box, times in the time of free fall
-- over it, the density of the grains is 1.
--
-- Numbers. Friction mu(I) = mu_s + delta_mu/(I0/I + 1) with mu_s = 0.38 (20.8
-- degrees), delta_mu = 0.26, I0 = 0.3, d = 0.04; the yield stress is exact
-- (regularisation = "exact", include/talus/two_phase/yield.h).
--
-- Cost. 64 cells over the box, to t = 20: three seconds on one core.
--
-- Expect. Without tilt the grains are slower than 1e-9 from t = 0.2 on, front
-- and height stay as they are; gas keeps currents of 4e-3, and the end of the run
-- says that the grains came to rest at t = 0. Tilted by 8, 10, 12 degrees the
-- heap settles by 0.0001, 0.0002, 0.0004 at its top and stands, at 12 a little
-- steeper than its angle of repose, as it is short and leans on a wall; at 15 it
-- slides: front 1.67 instead of 1.62, top 0.23 instead of 0.30 at t = 10. The
-- part of the grains at its yield stress (`flowing` of series.csv) is 0, 0.01 at
-- most, and 0.84 then.
--
-- Try. tilt=15; regularisation=clip, which creeps; slope=0.5: a heap that is too
-- steep slumps and rests; the fields `yield_state` and `stress` of snapshots.

local level = param("level", 6, "finest grid: 2/2^level")
local stop = param("stop", 20, "time of the end")
local tilt = param("tilt", 0, "inclination of the floor, degrees")
local slope = param("slope", 0.176, "tangent of the slope of the heap")
local mu_s = param("mu_s", 0.38, "friction coefficient at rest")
local tolerance = param("tolerance", 1e-10, "of the linear solvers")
local regularisation = param("regularisation", "exact", "of the yield stress")

local angle = tilt * math.pi / 180
local rheology = { "mu_i", mu_s = mu_s, delta_mu = 0.26, I0 = 0.3, d = 0.04,
                   regularisation = regularisation }
if regularisation == "clip" then rheology.eta_max = 1e3 end

return {
  title = "A heap of grains at rest",
  dimension = 2,
  domain = { size = 2, level = level, level_min = 4 },
  gravity = { math.sin(angle), -math.cos(angle) },
  grains = {
    density = 1,
    rheology = rheology,
    shape = function(x, y) return 0.3 - slope * x - y end,
  },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-5 } },
  boundary = {
    left = "symmetry",
    right = "no_slip",
    bottom = "no_slip",
    top = { "outflow", pressure = 0 },
  },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = tolerance, dt_max = 1 / 64 },
  output = { stop = stop },

  expect = {
    run = "level=5 stop=10",
    max_speed = { 0, 1e-7 },
    front = { 1.5, 1.6 },
    height = { 0.29, 0.3 },
    volume = { 0.2555, 0.2557 },
  },
}
