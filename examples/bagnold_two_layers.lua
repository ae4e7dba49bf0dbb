-- Grains under a fluid, both flowing down an inclined channel
--
-- Question. A layer of dry grains flows down a slope under air. How much do the
-- weight and the viscosity of what lies above slow the grains down, and when
-- may they be neglected?
--
-- Geometry. A channel of height 2H and slope alpha, x along it, so that gravity
-- is inclined. Grains fill its lower half, a Newtonian fluid the upper one;
-- both stick to the walls. A strip of it, periodic along x.
--
--      +------- wall --------+  y = 2 H, p = 0
--      |        fluid        |
--      +---------------------+  y = H
--      |        grains       |   g = (sin alpha, -cos alpha)
--      +------- wall --------+  y = 0
--
-- Units. Lengths in H, times in sqrt(H/g), the density of the grains is 1: so
-- velocities are in sqrt(g H), viscosities in rho sqrt(g H^3).
--
-- Numbers. Slope alpha = 0.43 rad; friction mu(I) = mu_s + delta_mu/(I0/I + 1),
-- I = d gamma/sqrt(p/rho), with 0.38, 0.26 and 0.3; grain diameter d/H = 0.04.
-- The fluid: kinematic viscosity 0.1 sqrt(g H^3), density rho_f/rho = 0.001.
--
-- Source. P.-Y. Lagree, L. Staron & S. Popinet, The granular column collapse as
-- a continuum: validity of a two-dimensional Navier-Stokes model with a
-- mu(I)-rheology, J. Fluid Mech. 686 (2011) 378, section 2.3.3, equations 2.30
-- to 2.32 and figure 5.
--
-- Cost. 64 cells over the height, to t = 200: one and a half seconds on
-- one core.
--
-- Expect. The steady flow solves an ordinary differential equation per layer;
-- they join in velocity and stress at y = H. The speed there falls from 2.066
-- without fluid to 2.023, 1.736, 0.706 and 0.0425 sqrt(g H) for rho_f/rho =
-- 0.001, 0.01, 0.1 and 0.4: the fluid bears on the grains, so that they need
-- more stress to yield, and under the heavier two the top of the grains moves
-- like a solid. Under the lightest, air, two percent are lost.
--
-- Try. ratio=0.4: only the lowest fifth of the grains is sheared; nu=1: a
-- fluid ten times as viscous; regularisation=clip eta_max=100: the solid top of
-- ratio=0.4 creeps.

local slope = param("slope", 0.43, "inclination of the channel, in rad")
local ratio = param("ratio", 0.001, "density of the fluid over that of grains")
local nu = param("nu", 0.1, "kinematic viscosity of the fluid, in sqrt(g H^3)")
local trees = param("trees", 16, "trees over 2H: the strip is 2H/trees wide")
local level = param("level", 2, "finest grid: 2H/trees/2^level")
local start = param("start", 1, "initial speed over that without fluid")
local stop = param("stop", 200, "time of the end, in sqrt(H/g)")
local d = param("d", 0.04, "grain diameter, in H")
local mu_s = param("mu_s", 0.38, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.26, "rise of friction at large I")
local I0 = param("I0", 0.3, "inertial number at half that rise")
local regularisation = param("regularisation", "exact", "of the yield stress")
local eta_max = param("eta_max", 1e4,
                      "cap on viscosity, in rho sqrt(g H^3); of clip only")
local tolerance = param("tolerance", 1e-8, "of the linear solvers")
param("length_unit", "$H$", "name of the unit, for pictures")
param("time_unit", "$\\sqrt{H/g}$", "name of the unit, for pictures")

local rho, g, H = 1, 1, 1               -- the units
local rho_f = ratio * rho
local weight = g * math.cos(slope)      -- gravity across the channel

-- to start with: the grains as without fluid, the fluid sheared between them
-- and the wall
local I = I0 * (math.tan(slope) - mu_s) / (mu_s + delta_mu - math.tan(slope))
local speed = 2 / 3 * math.max(I, 0) / d * math.sqrt(weight * H^3)
local function profile(y)
  if y > H then return speed * (2 - y / H) end
  return speed * (1 - (1 - y / H)^1.5)
end

return {
  title = "Grains under a fluid, density ratio " .. ratio,
  dimension = 2,
  domain = { size = 2 * H / trees, trees = { 1, trees }, level = level,
             level_min = level },
  gravity = { g * math.sin(slope), -weight },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = 1e-8, regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
    shape = function(x, y) return H - y end,
  },
  gas = { density = rho_f, rheology = { "newtonian", eta = rho_f * nu } },
  velocity = function(x, y) return start * profile(y), 0 end,

  boundary = {
    left = "periodic",
    right = "periodic",
    bottom = "no_slip",
    top = "no_slip",
    -- the mean over both layers of a pressure that is 0 at y = 2 H:
    -- (rho_f weight H/2 + (rho_f weight H + rho weight H/2))/2
    pressure_level = weight * H * (3 * rho_f + rho) / 4,
  },

  solver = { tolerance = tolerance },
  output = { stop = stop, series_every = 10 },

  expect = {
    run = "trees=8 stop=150",
    max_speed = { 2.0, 2.04 },
    height = { 0.999, 1.001 },
  },
}
