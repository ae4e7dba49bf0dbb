-- Grains that flow down a rough inclined plane
--
-- Question. A layer of dry grains lies on a plane steeper than the angle at
-- which grains stay. How fast does it flow at each depth once the flow is
-- steady, and what happens on a plane that is not steep enough?
--
-- Geometry. A layer of thickness H on a plane of slope alpha; x along the
-- plane, y across it, so that gravity is inclined. The grains fill the box: a
-- strip of the layer, periodic along x, without gas. They stick to the plane;
-- the surface is free, its pressure 0.
--
--      +------- p = 0 -------+  y = H
--      |                     |
--      | periodic   periodic |   g = (sin alpha, -cos alpha)
--      |                     |
--      +------- plane -------+  y = 0
--
-- Units. Lengths in H, times in sqrt(H/g), the density of the grains is 1: so
-- velocities are in sqrt(g H), viscosities in rho sqrt(g H^3).
--
-- Numbers. Slope alpha = 0.43 rad (24.6 degrees); friction mu(I) = mu_s +
-- delta_mu/(I0/I + 1), I = d gamma/sqrt(p/rho), with 0.38, 0.26 and 0.3; grain
-- diameter d/H = 0.04. Grains stay where tan(alpha) <= 0.38 (0.363 rad) and
-- have no steady flow where tan(alpha) >= 0.64 (0.569 rad).
--
-- Source. P.-Y. Lagree, L. Staron & S. Popinet, The granular column collapse as
-- a continuum: validity of a two-dimensional Navier-Stokes model with a
-- mu(I)-rheology, J. Fluid Mech. 686 (2011) 378, section 2.3.1, equations 2.24
-- to 2.26 and figures 2 and 3.
--
-- In three dimensions. dimension=3: z across the layer, x and y along it, both
-- periodic, and the slope falls towards `heading`, an angle from x in the plane.
--
-- Cost. 32 cells over H, to t = 200: half a second on one core; 64 cells (trees
-- = 16): two.
--
-- Expect. Friction balances weight at every depth, so mu(I) = tan(alpha): I is
-- the same everywhere, I_alpha = I0 (tan(alpha) - mu_s)/(mu_s + delta_mu -
-- tan(alpha)) = 0.130, and
--   u(y) = 2/3 I_alpha/d sqrt(g cos(alpha)) (H^(3/2) - (H - y)^(3/2)),
-- Bagnold's profile, with 2.066 sqrt(g H) at the surface. The flow starts as
-- the plane is let go (t = 0) and is that within 1 % at t = 145.
--
-- Try. start=2: it slows down to the same; slope=0.3: it stays, and with
-- regularisation=clip creeps at rho g sin(alpha) H^2/(2 eta_max); slope=0.5
-- stop=600: four times as fast, in the end; refined=2: cells that get coarser
-- with the distance from the plane.

local dimension = param("dimension", 2, "2, or 3: z is across the layer")
local heading = param("heading", 0, "of the flow from x, in rad, in 3D")
local slope = param("slope", 0.43, "inclination of the plane, in rad")
local trees = param("trees", 8, "trees over H: the strip is H/trees wide")
local level = param("level", 2, "finest grid: H/trees/2^level")
local refined = param("refined", 0, "levels by which the surface is coarser")
local start = param("start", 0, "initial speed over that of the steady flow")
local stop = param("stop", 200, "time of the end, in sqrt(H/g)")
local d = param("d", 0.04, "grain diameter, in H")
local mu_s = param("mu_s", 0.38, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.26, "rise of friction at large I")
local I0 = param("I0", 0.3, "inertial number at half that rise")
local regularisation = param("regularisation", "exact", "of the yield stress")
local eta_max = param("eta_max", 1e4,
                      "cap on viscosity, in rho sqrt(g H^3); of clip only")
local tolerance = param("tolerance", 1e-8, "of the linear solvers")
local picard = param("picard", 0, "repetitions within a step")
param("length_unit", "$H$", "name of the unit, for pictures")
param("time_unit", "$\\sqrt{H/g}$", "name of the unit, for pictures")

local rho, g, H = 1, 1, 1               -- the units

-- the steady flow
local I = I0 * (math.tan(slope) - mu_s) / (mu_s + delta_mu - math.tan(slope))
local speed = 2 / 3 * math.max(I, 0) / d * math.sqrt(g * math.cos(slope) * H^3)
local function profile(y) return speed * (1 - (1 - y / H)^1.5) end

local solid = dimension == 3
local cos, sin = math.cos(heading), math.sin(heading)  -- of the flow

-- cells half as large in the lowest quarter as above, and so on
local function finest(x, y, z)
  return level - math.min(refined, math.floor(4 * (solid and z or y) / H))
end

-- along the slope and across it
local function vector(along, across)
  if solid then return along * cos, along * sin, across end
  return along, across
end

return {
  title = "Grains on an inclined plane, slope " .. slope,
  dimension = dimension,
  domain = { size = H / trees,
             trees = solid and { 1, 1, trees } or { 1, trees },
             level = level, level_min = level - refined },
  gravity = { vector(g * math.sin(slope), -g * math.cos(slope)) },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = 1e-8, regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
  },
  velocity = function(x, y, z)
    return vector(start * profile(solid and z or y), 0)
  end,

  boundary = {
    left = "periodic",
    right = "periodic",
    front = solid and "periodic" or nil,
    back = solid and "periodic" or nil,
    bottom = "no_slip",
    top = { "outflow", pressure = 0 },
  },

  adapt = refined > 0 and { { "position", level = finest } } or nil,
  solver = { tolerance = tolerance, picard = picard },
  output = { stop = stop, series_every = 10 },

  expect = {
    run = "trees=4 stop=150",
    max_speed = { 2.04, 2.07 },
  },
}
