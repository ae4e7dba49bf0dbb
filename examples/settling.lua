-- Settling of a suspension: two fronts
--
-- Question. Grains are stirred up evenly in a closed column of liquid. How fast
-- does the clear liquid above them deepen, and the bed below them grow?
--
-- Geometry. A column H high, full of a suspension of solid fraction alpha.
--
--      +----+  H
--      |....|     clear liquid: its lower end falls at w
--      |....|     suspension, alpha
--      |....|     bed: its surface rises at alpha w/(alpha_b - alpha)
--      +----+  0
--
-- Units. SI.
--
-- Numbers. One grain alone would sink at w_0, as Stokes says; among others it
-- sinks at w = w_0 (1 - alpha)^4.65, as inertia is taken out of the drag
-- (wen_yu_factor = 0). The bed has the solid fraction that carries its weight.
--
-- Source. G. J. Kynch, A theory of sedimentation, Trans. Faraday Soc. 48 (1952)
-- 166. J. F. Richardson & W. N. Zaki, Trans. Inst. Chem. Eng. 32 (1954) 35.
--
-- Cost. 100 leaves high: 345 steps, a second on one core.
--
-- Expect. The upper front has fallen 0.306 H at stop = 0.5 H/w_0; here it is
-- right to 5e-4 H, as is the lower one (make convergence CASE=two_fluid).
--
-- Try. alpha=0.3; fluid of one's own: eta=0.1; drag of real grains: inertia=0.15.

local cells = param("cells", 100, "leaves to the height, a multiple of 4")
local alpha = param("alpha", 0.1, "solid fraction at the start")
local eta = param("eta", 0.03, "viscosity of the liquid, Pa s")
local inertia = param("inertia", 0, "0: Stokes; 0.15: Wen & Yu")
local stop = param("stop", 0.5, "time of the end, in H/w_0")

local H, d = 0.1, 1e-3                             -- m
local rho_s, rho_f, g = 2560, 1000, 9.81           -- kg/m^3, m/s^2
local w_0 = (rho_s - rho_f) * g * d^2 / (18 * eta) -- m/s
param("w", w_0 * (1 - alpha)^4.65, "speed of the upper front, m/s")

return {
  title = "Settling of a suspension",
  model = "two_fluid",
  dimension = 2,
  domain = { size = 4 * H / cells, trees = { 1, cells // 4 }, level = 2,
             level_min = 2 },
  gravity = { 0, -g },
  grains = { density = rho_s, d = d, start = "patched", alpha_start = alpha,
             alpha_surface = alpha / 2 },
  fluid = { density = rho_f, eta_0 = eta },
  drag = { "wen_yu", wen_yu_factor = inertia },
  closure = "ktgf",
  boundary = { left = "periodic", right = "periodic", bottom = "no_slip",
               top = "slip" },
  solver = { tolerance = 1e-6, cfl = 0.5 },
  output = { stop = stop * H / w_0, length_scale = H,
             snapshot_every = 0.1 * H / w_0 },
  expect = {
    run = "cells=48",
    height = { 0.0684, 0.0714 },        -- m; 0.0694 = H - 0.5 H (1 - alpha)^4.65
    max_alpha = { 0.5, 0.63 },
  },
}
