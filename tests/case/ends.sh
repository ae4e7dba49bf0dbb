#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# How a run ends by itself: at rest, as its steps become too short, as there is
# no memory for it; and that it is heard of before. Usage: ends.sh BUILD
. "$(dirname "$0")/common.bash"

# ends STATUS PATTERN ARGUMENTS...: talus ends with it and says so
ends() {
  local expected=$1 pattern=$2 status
  shift 2
  timeout "$limit" "$build/talus" "$@" > output 2>&1
  status=$?
  [ $status -eq "$expected" ] || complain "$*: exit status $status"
  grep -qE "$pattern" output || complain "$*: nothing matches $pattern"
}

# A block that slumps and comes to rest
cat > heap.lua << 'LUA'
local speed = param("speed", 0.05, "at which it rests")
local wind = param("wind", 0, "velocity at the start")
local trees = param("trees", { 1, 1 }, "of the grid")
return {
  dimension = 2, domain = { size = 4, level = 5, trees = trees },
  gravity = { 0, -1 },
  grains = { density = 1,
    rheology = { "mu_i", mu_s = 0.5, d = 0.05, regularisation = "clip",
      eta_max = 10 },
    shape = function(x, y) return math.min(1 - x, 1 - y) end },
  gas = { density = 1e-3, rheology = { "newtonian", eta = 1e-4 } },
  velocity = { wind, 0 },
  boundary = { left = "symmetry", right = "no_slip", bottom = "no_slip",
    top = { "outflow", pressure = 0 } },
  output = { stop = 50, stop_at_rest = { speed = speed, time = 0.5 } },
}
LUA
ends 0 '^at rest at step' run heap.lua -o whole
ends 0 '^state: finished: at rest at step' info whole
grep -q '^the cap eta_max = 10 lets slopes .* creep at up to 0.0224' \
  whole/run.log || complain "the creep is not in run.log"
# the last row and the outline are those of the end
[ "$(tail -n 1 whole/series.csv | cut -d, -f2)" = \
  "$(tail -n 1 whole/profile.csv | cut -d, -f1)" ] ||
  complain "no outline of the end"
ends 5 '^stopped by --max-steps' run heap.lua -o parts --max-steps 79
ends 0 '^at rest at step' run heap.lua -o parts --restart
for name in whole parts; do
  cut -d, -f1-13,15- $name/series.csv > $name.csv
done
diff whole.csv parts.csv > output || complain "in pieces it rests otherwise"
ends 5 'warning: output.stop_at_rest.speed = 0.01 is below the creep' \
  run heap.lua speed=0.01 -o creep --max-steps 1

# Steps that could never reach the end
ends 3 'error: the run gave up after step 1.*dt = .*advection.*speed is .*at \(' \
  run heap.lua wind=1e25 -o wind --quiet
ends 0 '^state: failed: the run gave up' info wind
ends 5 '^stopped' run heap.lua wind=1e6 -o wind --max-steps 3

# What is printed into nowhere, or written beyond a quota, is said.
for words in "check heap.lua" "info whole" "rheology mu_i d=0.1 --csv" \
  "help case" "rheology --help"; do
  [ -c /dev/full ] || break
  # shellcheck disable=SC2086
  "$build/talus" $words > /dev/full 2> output
  status=$?
  [ $status -eq 4 ] || complain "$words, to a full disk: exit status $status"
  grep -q '^talus: error: cannot print all of it' output ||
    complain "$words, to a full disk: it is not said"
done
(
  ulimit -f 20
  ends 4 'fatal: quota/.*File too large' run heap.lua -o quota --quiet
  [ "$failures" -eq 0 ]
) || failures=$((failures + 1))

# Sizes: what is too much is refused at once
ends 2 'heap.lua:5: domain.trees: 40000 trees in all, 32767 are allowed' \
  check heap.lua trees=1000,40
ends 0 '^size: about 1.02e\+03 cells at the start, 1.1. MB' check heap.lua
ends 0 '^size: about 1\.1[0-9]?e\+05 cells' check "$root/examples/column.lua" \
  level=12
(
  ulimit -v 1500000
  ends 2 'error: the case is too large: about .* GB of the .* may use; lower' \
    run "$root/examples/column.lua" level=16 -o large
  ends 0 'warning: a run here would be refused: ' \
    check "$root/examples/column.lua" level=16
  [ "$failures" -eq 0 ]
) || failures=$((failures + 1))
[ -e large ] && complain "a run that was refused leaves files"

# What takes long is heard of: on a terminal, which Python makes.
cat > terminal.py << 'PYTHON'
import os
import pty
import sys

sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))
PYTHON
cat > slow.lua << 'LUA'
return {
  dimension = 2,
  domain = { size = 1, level = 7 },
  gravity = { 0, -1 },
  grains = {
    density = 1,
    rheology = { "newtonian", eta = 1 },
    shape = function(x, y) -- takes its time
      local sum = 0
      for i = 1, 1000 do sum = sum + math.sin(i) end
      return 0.5 - y + 1e-9 * math.sin(x) + 0 * sum
    end,
  },
  gas = { density = 0.1, rheology = { "newtonian", eta = 0.1 } },
  boundary = { left = "slip", right = "slip", bottom = "slip", top = "slip" },
  output = { stop = 1 },
}
LUA
if python3 -c 'import pty' 2> /dev/null; then
  timeout "$limit" python3 terminal.py "$build/talus" run slow.lua \
    --max-steps 1 -o loud > output < /dev/null
  grep -q 'start: [0-9]* cells, ' output || complain "a start without a word"
fi

[ "$failures" -eq 0 ]
