#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Grains poured through an opening onto a floor make a heap near their angle of
# repose; when the opening is shut they come to rest, and the heap stays as it
# is.
# Usage: pour.sh BUILD
. "$(dirname "$0")/common.bash"

cat > pour.lua <<'EOF'
local pour, stop = param("pour", true, "the opening"), param("stop", 6, "time")
return {
  dimension = 2, gravity = { 0, -1 },
  domain = { size = 0.5, trees = { 4, 1 }, level = 4, level_min = 2 },
  grains = { density = 1, shape = function(x, y) return -1 end,
    rheology = { "mu_i", mu_s = 0.38, delta_mu = 0.26, I0 = 0.3, d = 0.02 } },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-4 } },
  boundary = { left = "symmetry", right = "no_slip", bottom = "no_slip",
    top = function(x, y) return pour and x < 0.125 and "jet" or "lid" end,
    patches = { lid = { "outflow", pressure = 0 },
      jet = { "inflow", velocity = { 0, -0.2 }, fraction = 1 } } },
  adapt = { { "interface", width = 3 }, { "inside" } },
  solver = { tolerance = 1e-6, dt_max = 1 / 64 },
  output = { stop = stop },
}
EOF

run() {
  timeout "$limit" "$build/talus2d" run pour.lua --quiet -o heap "$@" \
    > output 2>&1 || { cat output; exit 1; }
}
run
run pour=false stop=16 --restart
grep -q "the grains have come to rest" heap/run.log ||
  complain "no word of rest in run.log"
# mu_s = 0.38; from t = 14 on the fastest grains have 1e-7, at level=6 too
awk -F, 'NR > 1 { t = $2; front = $5; height = $6; u = $11 }
  t > 14 { if (u > most) most = u
           if (!first) first = front; moved = front - first }
  END { print "slope", height / front, "fastest", most, "front moved", moved
        exit !(height / front > 0.3 && height / front < 0.38 && most < 1e-5 &&
               moved^2 < 1e-12) }' heap/series.csv > output ||
  complain "the heap is not at rest"

[ "$failures" -eq 0 ]
