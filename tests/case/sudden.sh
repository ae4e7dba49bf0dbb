#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A restart with other conditions is a new start: a silo at rest is opened, a
# jet is let in, gravity turns; dt, loss, inflow and the energy are right.
# Usage: sudden.sh BUILD
. "$(dirname "$0")/common.bash"

cat > bin.lua <<'EOF'
local open, jet = param("open", false, "outlet"), param("jet", 0, "its speed")
local tilt, fill = param("tilt", 0, "gravity"), param("fill", 3, "height")
local stop = param("stop", 1, "time")
return {
  dimension = 2, gravity = { math.sin(tilt), -math.cos(tilt) },
  domain = { size = 2.5, trees = { 1, 2 }, level = 5, level_min = 3 },
  grains = { density = 1, shape = function(x, y) return fill - y end,
    rheology = { "mu_i", mu_s = 0.32, delta_mu = 0.28, I0 = 0.4, d = 1 / 30,
                 eta_min = 0.006, regularisation = "clip", eta_max = 100 } },
  gas = { density = 1e-4, rheology = { "newtonian", eta = 1e-5 } },
  boundary = { left = "symmetry", right = "no_slip",
    bottom = function(x, y) return open and x < 0.32 and "outlet" or "no_slip"
    end,
    top = function(x, y) return jet > 0 and x < 0.625 and "jet" or "lid" end,
    patches = { outlet = { "outflow", pressure = 0 },
      lid = { "outflow", pressure = 0 },
      jet = { "inflow", velocity = { 0, -jet }, fraction = 1 } } },
  adapt = { { "interface", width = 3 }, { "inside" } },
  output = { stop = stop },
}
EOF

# verdict NAME DIR AWK: complain unless the awk program, which sees rows and t,
# dt, v, u (time, step, volume, speed) of each, exits with 0
verdict() {
  awk -F, "NR > 1 { t = \$2; dt = \$3; v = \$7; u = \$11 } $3" \
    "$2/series.csv" > output && return
  echo "$1"
  sed 's/^/  /' output
  failures=$((failures + 1))
}

# go RUN WORDS...: on from the state at rest
go() {
  local name=$1
  shift
  cp -r still "$name"
  timeout "$limit" "$build/talus2d" run bin.lua "$@" --restart --quiet -o "$name" \
    > output 2>&1 || { cat output; failures=$((failures + 1)); }
}

timeout "$limit" "$build/talus2d" run bin.lua --quiet -o still || exit 1
go opened open=true stop=4
go poured jet=1 stop=1.5
go tilted tilt=0.5 stop=1.1

# with dt_max = 0.005 the loss is 0.833, the speed 1.257
verdict "an outlet that is opened" opened \
  't > 1 { if (u > most) most = u; if (v > last) grows = v - last; last = v }
   NR == 2 { last = v }
   END { loss = 7.5 - v; print loss, most, grows
         exit !(loss > 0.825 && loss < 0.842 && most < 1.3 && grows < 1e-12) }'
# of width 0.625, for 0.5 of time; grains from the first moment
verdict "a jet that is let in" poured \
  'END { width = (v - 7.5) / 0.5; print width
         exit !(width - 0.625 < 1e-6 && 0.625 - width < 1e-6) }'
verdict "gravity that turns" tilted \
  'NR == 2 { before = $8 + $9 }
   END { print before, $17, $23, dt
         exit !($23 < -0.1 * before && $17^2 < (1e-3 * before)^2 && dt < 0.1) }'

[ "$failures" -eq 0 ]
