-- A silo empties through a slot in its floor
--
-- Question. How fast does a silo empty? A tank of water (a clepsydra) runs
-- slower as its level sinks; an hour-glass does not: its rate depends on the
-- width of the outlet alone. Does a fluid with the friction of grains know?
--
-- Geometry. A plane silo of width L = 5, filled to the height `fill`, with a
-- slot of width 2 W in the middle of its floor. Grains and gas leave through
-- the slot, where the pressure is 0 and below which there is nothing; gas comes
-- in at the open top. Walls and floor hold the grains (no slip). With `half`
-- the left side is the axis, a plane of symmetry.
--
--         |<-------- L -------->|
--       w +--------open---------+ w
--       a |         gas         | a
--       l +---------------------+ l
--       l |                     | l
--         |       grains        |      fill
--         |                     |
--         +--floor--|  |--floor-+
--                   2 W
--
-- Units. A unit of length is 30 grain diameters; gravity and the density of the
-- grains are 1. So times are in sqrt(30 d/g), rates (area per time) in
-- sqrt(g (30 d)^3).
--
-- Numbers. d = 1/30; mu(I) = mu_s + delta_mu/(I0/I + 1) with 0.32, 0.28, 0.4;
-- W = 0.157, 0.235125, ..., 0.547625: 4, 6, ..., 14 whole cells of L/128 lie
-- within W of the axis. Gas 10^4 times lighter than the grains.
--
-- Source. L. Staron, P.-Y. Lagree & S. Popinet, The granular silo as a
-- continuum plastic flow: the hour-glass vs the clepsydra, Phys. Fluids 24
-- (2012) 103301; the numbers are those of granular_sandglass.c, which
-- P.-Y. Lagree published with Basilisk, no slip on all walls too. Its rates
-- follow C sqrt(g) (2 W)^(3/2), C = 1.50.
--
-- Cost. Level 7, half of the silo: 7,200 to 7,900 cells, two seconds on one
-- core; level 8: a quarter of a minute.
--
-- Expect. Once they have set off, at about t = 2, grains leave at a constant
-- rate, 0.714 from the whole silo for W = 0.31325 (level 8: 0.731), whatever
-- the height above: Q = 1.49 sqrt(g) (2 W + b)^(3/2), where b, half a cell, is
-- an error at the edge of the outlet. The pressure is low above the outlet, and
-- the corners beside it do not move.
--
-- Try. inside=false: the same rate to 1 % with a fifth of the cells, as the
-- grid is fine at the outlet in any case; fill=3: the same rate; mu_s=0.05
-- delta_mu=0: nearly a clepsydra; half=false; W=0.547625 level=6 stop=25: the
-- silo empties, and slopes remain.

local W = param("W", 0.31325, "half-width of the outlet, in 30 d")
local fill = param("fill", 4.5, "height of the grains, in 30 d")
local half = param("half", true, "only the right half, up to the axis")
local level = param("level", 7, "finest grid: L/2^level")
local inside = param("inside", true, "fine cells in all of the grains, not "
                     .. "only at their surface and outlet")
local stop = param("stop", 4, "time of the end, in sqrt(30 d/g)")
local mu_s = param("mu_s", 0.32, "friction coefficient at rest")
local delta_mu = param("delta_mu", 0.28, "rise of friction at large I")
local I0 = param("I0", 0.4, "inertial number at half that rise")
local regularisation = param("regularisation", "exact", "of the yield stress")
local eta_max = param("eta_max", 100, "cap on viscosity; of clip only")
local tolerance = param("tolerance", 1e-4, "of the linear solvers")
param("length_unit", "$30\\,d$", "name of the unit, for pictures")
param("time_unit", "$\\sqrt{30\\,d/g}$", "name of the unit, for pictures")

local L, d, rho, g = 5, 1 / 30, 1, 1

return {
  title = "Discharge of a silo, half-width of the outlet " .. W,
  dimension = 2,
  domain = half and { size = L / 2, trees = { 1, 2 }, level = level - 1,
                      level_min = 3 }
           or { size = L, origin = { -L / 2, 0 }, level = level,
                level_min = 4 },
  gravity = { 0, -g },

  grains = {
    density = rho,
    rheology = { "mu_i", mu_s = mu_s, delta_mu = delta_mu, I0 = I0, d = d,
                 eta_min = rho * math.sqrt(g * d^3),
                 regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
    shape = function(x, y) return fill - y end,
  },
  gas = { density = 1e-4, rheology = { "newtonian", eta = 1e-5 } },

  boundary = {
    left = half and "symmetry" or "no_slip",
    right = "no_slip",
    -- whole faces: those with their centre within W of the axis; they and
    -- the cells around them are of the finest level
    bottom = function(x, y)
      return math.abs(x) < W and "outlet" or "no_slip"
    end,
    top = { "outflow", pressure = 0 },
    patches = { outlet = { "outflow", pressure = 0 } },
  },

  adapt = inside and { { "interface", width = 3 }, { "inside" } }
          or { { "interface", width = 3 } },
  solver = { tolerance = tolerance },
  output = { stop = stop, profile_times = { 0, 1, 2, 3 },
             snapshot_every = 0.5 },

  expect = {
    run = "level=6",
    volume = { 10.01, 10.05 },
    height = { 4.09, 4.15 },
  },
}
