#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Openings narrower than the coarse grid: a jet brings in W V t, an outlet is
# there when a restart opens it, and one that no grid can show is refused.
# Usage: openings.sh BUILD
. "$(dirname "$0")/common.bash"

cat > jet.lua <<'END'
local W = param("W", 0.25, "width")
local level = param("level", 5, "faces of 4/2^level")
local cells = param("cells", 1e6, "the most")
return {
  dimension = 2, domain = { size = 4, level = level, level_min = 3 },
  gravity = { 0, -1 },
  grains = { density = 1, rheology = { "mu_i", d = 0.02, eta_min = 3e-3,
      regularisation = "clip", eta_max = 100 },
    shape = function(x, y) return -1 end }, -- the jet brings them
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-5 } },
  boundary = { left = "symmetry", right = "no_slip",
    bottom = "no_slip",
    top = function(x, y) return x < W and "jet" or "open" end,
    patches = { jet = { "inflow", velocity = { 0, -0.5 }, fraction = 1 },
      open = { "outflow", pressure = 0 }, unused = { "slip" } } },
  adapt = { { "interface", width = 2 }, max_cells = cells },
  output = { stop = 1 },
}
END

cat > outlet.lua <<'END'
local W = param("W", 0.32, "width")
local open = param("open", false, "the outlet")
return {
  dimension = 2,
  domain = { size = 2.5, trees = { 1, 2 }, level = 5, level_min = 2 },
  gravity = { 0, -1 },
  grains = { density = 1, rheology = { "mu_i", mu_s = 0.32, d = 1 / 30,
      eta_min = 6e-3, regularisation = "clip", eta_max = 100 },
    shape = function(x, y) return 3 - y end },
  gas = { density = 1e-4, rheology = { "newtonian", eta = 1e-5 } },
  boundary = { left = "symmetry", right = "no_slip",
    top = { "outflow", pressure = 0 },
    bottom = function(x, y) return open and x < W and "outlet" or "no_slip" end,
    patches = { outlet = { "outflow", pressure = 0 } } },
  adapt = { { "interface", width = 2 } },
  output = { stop = param("stop", 0.1, "time") },
}
END

# must ARGUMENTS...: talus has to succeed
must() {
  timeout "$limit" "$build/talus" "$@" > output 2>&1 ||
    complain "talus $*: exit status $?"
}

# refuses PATTERN ARGUMENTS...: status 2, one message that matches
refuses() {
  local pattern=$1 status
  shift
  timeout "$limit" "$build/talus" "$@" > output 2>&1
  status=$?
  [ "$status" -eq 2 ] || complain "talus $*: exit status $status, not 2"
  grep -qE "^talus: error: .*$pattern" output ||
    complain "talus $*: the message does not match $pattern"
}

# says NAME FILE PATTERN
says() {
  grep -qE "$3" "$2" || complain "$1: $2 does not say $3"
}

# within NAME VALUE EXPECTED TOLERANCE
within() {
  awk -v v="$2" -v e="$3" -v t="$4" \
    'BEGIN { exit !(v > e - t && v < e + t) }' ||
    complain "$1: $2, not $3 within $4"
}

# volume at t = 1: W / 2, for whole faces of 1/8 and others, and for less than a
# face
for w in 0.25 0.3137 0.09; do
  must run jet.lua "W=$w" --quiet -o jet.out
  [ -s output ] && complain "jet, W = $w: is not quiet"
  within "jet, W = $w" "$(last jet.out volume)" "$(awk "BEGIN { print $w / 2 }")" \
    "$(awk "BEGIN { print $w * 5e-4 }")"
done
says jet jet.out/run.log 'boundary.patches.jet covers 0.09 m of top, 1 faces'
says jet jet.out/run.log 'boundary.patches.unused covers nothing: no side'

must check jet.lua W=0.3137
says check output 'boundary.patches.jet covers 0.3137 m of top, 3 faces of 0.125'
says check output 'boundary.patches.open covers 3.6863 m of top, 29 faces'

# an outlet between the centres of faces; one that max_cells forbids
sed 's/width = 2 } }/width = 2 }, opening_level = 6 }/' outlet.lua > above.lua
refuses 'outlet.lua:[0-9]+: boundary.patches.outlet: boundary.bottom returns it on 0.03 .*0.078125 wide.*domain.level = 7' \
  run outlet.lua open=true W=0.03 -o none.out
refuses 'opening_level = 6 is above domain.level = 5' check above.lua
refuses 'domain.level = 7' check outlet.lua open=true W=0.03
[ -e none.out ] && complain "outlet: left a directory"
sed 's/width = 2 } }/width = 2 }, max_cells = 40 }/' outlet.lua > capped.lua
refuses 'boundary.patches.outlet covers .* has no face .*max_cells' \
  run capped.lua open=true W=0.1 -o none.out

# the pressure is set by an outflow on a part of a side, or by a level
sed 's/patches = {/pressure_level = 0, patches = {/' outlet.lua > twice.lua
refuses 'boundary.pressure_level = 0 .*boundary.(top|patches.outlet) is an' \
  check twice.lua open=true

# an outlet that a restart opens: on the coarse grid of the first part it would
# have no face
must run outlet.lua W=0.1 --quiet -o out
must run outlet.lua W=0.1 open=true stop=0.4 --restart --quiet -o out
says outlet out/run.log 'boundary.patches.outlet covers 0.1 m of bottom, 1 faces'
within "outlet" "$(last out volume)" 7.495 0.004

[ "$failures" -eq 0 ]
