-- Grains that fall through a vertical chute
--
-- Question. Dense grains fall between two rough vertical walls, pressed
-- together so that pressure is the same everywhere. How wide is the plug in the
-- middle that falls without being sheared, and how fast does it fall?
--
-- Geometry. Half of a chute of half-width H; the left side is its plane of
-- symmetry, the right one a wall to which the grains stick. A strip of it,
-- periodic along y, filled with grains, without gas.
--
--      +------- periodic -------+
--   s  |                        | w
--   y  | plug    :    shear     | a   g downwards
--   m  |         :              | l
--      +------- periodic -------+ l
--    x = 0      w_p           x = H
--
-- Units. Lengths in grain diameters d, times in sqrt(d/g), the density of the
-- grains is 1: so pressures are in rho g d, velocities in sqrt(g d).
--
-- Numbers. H = 14, pressure P = 28; friction mu(I) = mu_s + delta_mu/(I0/I +
-- 1), I = d gamma/sqrt(P/rho), with 0.32, 0.28 and 0.4. The flow is steady for
-- rho g H/P between mu_s and mu_s + delta_mu; below, nothing moves.
--
-- Source. One of the flows of GDR MiDi, On dense granular flows, Eur. Phys. J.
-- E 14 (2004) 341 (vertical chute). Pressure does not depend on y, so the
-- balance of forces and P. Jop, Y. Forterre & O. Pouliquen, A constitutive law
-- for dense granular flows, Nature 441 (2006) 727, equation 1, give what is
-- below.
--
-- Cost. 64 cells over H, to t = 400: a second on one core.
--
-- Expect. Stress balances weight, tau = rho g x, so where tau < mu_s P nothing
-- is sheared: a plug of half-width w_p = mu_s P/(rho g) = 8.96. Beyond it
-- mu(I) = rho g x/P, and the shear rate adds up to a plug that falls at
--   I0/d sqrt(P/rho) P/(rho g) (delta_mu ln(delta_mu/(mu_s + delta_mu - m))
--     - (m - mu_s)),  m = rho g H/P = 0.5:
-- 6.418 sqrt(g d). Let go from rest, it is within 1 % of that at t = 180.
--
-- Try. pressure=40: a slower, wider plug; pressure=44: the grains stay, and with
-- regularisation=clip creep at rho g (H^2 - x^2)/(2 eta_max); I0=0.2: grains
-- that resist more.

local half_width = param("half_width", 14, "half-width of the chute, in d")
local pressure = param("pressure", 28, "pressure between grains, in rho g d")
local trees = param("trees", 16, "trees over H: the strip is H/trees high")
local level = param("level", 2, "finest grid: H/trees/2^level")
local stop = param("stop", 400, "time of the end, in sqrt(d/g)")
local mu_s = param("mu_s", 0.32, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.28, "rise of friction at large I")
local I0 = param("I0", 0.4, "inertial number at half that rise")
local regularisation = param("regularisation", "exact", "of the yield stress")
local eta_max = param("eta_max", 1e5,
                      "cap on viscosity, in rho sqrt(g d^3); of clip only")
local tolerance = param("tolerance", 1e-8, "of the linear solvers")
param("length_unit", "$d$", "name of the unit, for pictures")
param("time_unit", "$\\sqrt{d/g}$", "name of the unit, for pictures")

local rho, g, d = 1, 1, 1               -- the units

return {
  title = "Grains in a vertical chute, pressure " .. pressure,
  dimension = 2,
  domain = { size = half_width / trees, trees = { trees, 1 }, level = level,
             level_min = level },
  gravity = { 0, -g },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = 1e-8, regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
  },

  boundary = {
    left = "symmetry",
    right = "no_slip",
    bottom = "periodic",
    top = "periodic",
    pressure_level = pressure,
  },

  solver = { tolerance = tolerance },
  output = { stop = stop, series_every = 10, length_scale = half_width },

  expect = {
    run = "trees=8 stop=300",
    max_speed = { 6.36, 6.48 },
  },
}
