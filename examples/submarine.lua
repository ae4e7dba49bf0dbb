-- Collapse under liquid: loose grains run, dense ones creep
--
-- Question. A column of glass beads stands in a viscous liquid behind a gate.
-- Packed loosely it collapses within two seconds and runs far; packed a little
-- more densely it hardly moves at first, and flows down over half a minute. Why?
-- Dense grains must expand before they shear, and suck liquid in; loose ones
-- press it out, and float on it.
--
-- Geometry. A column 6 cm long and H high, in a box of liquid.
--
--      +----------------------------+  8 cm
--      |liquid                      |
--      +-------+                    |
--      | beads | H                  |
--      +-------+------bed-----------+
--        6 cm                       24 cm
--
-- Units. SI.
--
-- Numbers. Glass 2500 kg/m^3, 0.225 mm; liquid 1010 kg/m^3, 0.012 Pa s. Loose:
-- solid fraction 0.55, H = 4.8 cm; dense: 0.60, 4.2 cm. Friction and pressure
-- by the closures critical_state with sedFoam's constants, none of them tuned.
--
-- Source. L. Rondon, O. Pouliquen & P. Aussillous, Granular collapse in a fluid:
-- role of the initial volume fraction, Phys. Fluids 23 (2011) 073301.
-- Montella, Chauchat, Chareyre, Bonamy & Hsu, J. Fluid Mech. 925 (2021) A13.
--
-- Cost. Loose, 9 s, leaves of 2.5 mm: 1216 steps, half a minute on one core.
--
-- Expect. The loose front is at 15.1 cm after 0.64 s, at 19.1 cm after 1.9 s and at
-- 20.7 cm from 5.5 s on, where it stands; in the experiment at 16.3, 20.3 and 21.2 cm.
-- The dense column on leaves of 5 mm (level=3) is at 7.5 cm after 2 s and at 10.9 cm
-- after 10 s, where it rests; in the experiment at 9.3 and 12.1 cm. The liquid at the
-- floor is pressed by +144 Pa in the loose bed at 2 s, here by 122 Pa, and by -126 Pa
-- in the dense one at 1.13 s, here by -193 Pa (docs/notes/two_fluid.md).
--
-- Try. dense=1 stop=30; alpha=0.57; closures of other codes: closure="ktgf".

local dense = param("dense", 0, "1: the dense column")
local level = param("level", 4, "finest grid: 4 cm/2^level")
local stop = param("stop", 5, "time of the end, s")
local closure = param("closure", "critical_state", "closures of the grains")
local height = param("height", dense == 1 and 0.042 or 0.048, "H, m")
local surface = param("surface", "planes", "of the bed: planes, none")
local alpha = param("alpha", dense == 1 and 0.60 or 0.55, "solid fraction")

return {
  title = "Collapse of beads under a viscous liquid",
  model = "two_fluid",
  dimension = 2,
  domain = { size = 0.04, trees = { 6, 2 }, level = level,
             level_min = level - 2 },
  gravity = { 0, -9.81 },
  grains = {
    shape = function(x, y) return math.min(0.06 - x, height - y) end,
    density = 2500, d = 0.225e-3,
    start = "dense", alpha_start = alpha, surface = surface,
    regularisation = param("regularisation", "exact", "of friction: exact, clip"),
  },
  fluid = { density = 1010, eta_0 = 0.012 },
  closure = closure,
  boundary = { left = "slip", right = "no_slip", bottom = "no_slip",
               top = "slip" },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = param("tolerance", 1e-4, "of the solvers"),
             cfl = 0.5 },
  output = { stop = stop, length_scale = 0.06,
             profile_times = { 0, 0.5, 1, 2, 3, stop },
             snapshot_every = param("snapshots", 0.5, "s") },
  expect = {
    run = "level=3 stop=1",
    front = { 0.14, 0.17 },             -- m; level 4: 0.166
  },
}
