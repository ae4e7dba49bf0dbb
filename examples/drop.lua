-- Grains that fall on a bare floor
--
-- Question: does a block of grains that lands run out as far as one that starts
-- on the floor with the same speed? It must: the gas between grains and floor
-- leaves through the grains. A code whose gas cannot do so lets the block slide
-- on a film of it, here to a front of 3.73 instead of 2.18 at level 7 (say
-- permeable=no to see it).
--
-- Geometry: the right half of a block, 0.4 wide and 0.8 high, above a rough
-- floor; mirror at x = 0.
-- Units: L0 = g = rho = 1; mu(I) with mu_s = 0.32, delta_mu = 0.28, I0 = 0.4,
-- d = 0.02 L0.
-- Source: none; the two starts are each other's reference.
-- Cost: level 7, 8, 9: 800, 2,000, 4,000 cells, 0.5, 2, 8 s on one core.
-- Things to try: gap=0 fall=0.5, the other start; gap=2.2; permeable=no.

local gap = param("gap", 0.5, "height of the fall, in L0; 0: starts on the floor")
local fall = param("fall", gap, "height that gives the speed of the start on the floor")
local level = param("level", 8, "finest grid: 8 L0/2^level")
local stop = param("stop", 8, "time of the end, in sqrt(L0/g)")
local regularisation = param("regularisation", "exact", "of the yield stress")
local eta_max = param("eta_max", 2000,
                      "cap on viscosity, in rho sqrt(g L0^3); of clip only")
local permeable = param("permeable", "auto", "does gas leave through grains?")

local width, height = 0.4, 0.8

return {
  title = gap > 0 and "A block of grains falls by " .. gap .. " on a rough floor"
          or "A block of grains sets off on a rough floor",
  dimension = 2,
  domain = { size = 8, level = level, level_min = 3 },
  gravity = { 0, -1 },

  grains = {
    density = 1,
    rheology = { "mu_i", mu_s = 0.32, delta_mu = 0.28, I0 = 0.4, d = 0.02,
                 eta_min = 3e-3, regularisation = regularisation,
                 eta_max = regularisation ~= "exact" and eta_max or nil },
    permeable = permeable,
    shape = function(x, y)
      return math.min(width - x, y - gap, gap + height - y)
    end,
  },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-5 } },
  velocity = function(x, y)
    local inside = gap == 0 and x < width and y < height
    return 0, inside and -math.sqrt(2 * fall) or 0
  end,

  boundary = {
    left = "symmetry", right = "no_slip", bottom = "no_slip",
    top = { "outflow", pressure = 0 },
  },
  adapt = { { "interface", width = 3 }, { "inside" } },
  output = { stop = stop, snapshot_every = 0.5,
             profile_times = { 0, 1, 1.5, 2, 3, 4, 8 } },

  expect = {
    run = "level=7",
    front = { 2.1, 2.4 },
    height = { 0.29, 0.34 },
    volume = { 0.3199, 0.3201 },
  },
}
