#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Under mpirun what is said is said once, and the exit status comes through.
# Usage: ranks.sh BUILD
. "$(dirname "$0")/common.bash"

# once STATUS PATTERN ARGUMENTS...: talus on three ranks ends with this status,
# and exactly one line of what it says matches
once() {
  local expected=$1 pattern=$2 status
  shift 2
  timeout "$limit" mpirun --oversubscribe -n 3 "$build/talus" "$@" > output 2>&1
  status=$?
  [ $status -eq "$expected" ] || echo "$*: exit status $status, not $expected"
  [ "$(grep -cE "$pattern" output)" -eq 1 ] ||
    echo "$*: not one line matches $pattern"
  [ $status -eq "$expected" ] && [ "$(grep -cE "$pattern" output)" -eq 1 ] &&
    return
  sed 's/^/  /' output
  failures=$((failures + 1))
}

once 2 '^talus: error: unknown command rnu; did you mean run' rnu
once 2 '^Talus simulates'
once 0 '^Talus simulates' help
once 0 '^talus run CASE.lua' run --help
once 0 '^talus [0-9]' --version
once 0 '^I,' rheology mu_i d=0.01 rho=1 --csv
once 2 '^talus: error: unknown option --restrat' run a.lua --restrat
once 2 '^talus: error: cannot read the case none.lua' run none.lua
once 5 '^stopped by --max-steps at step 2' run "$root/examples/column.lua" \
  level=6 --max-steps 2 -o run

[ "$failures" -eq 0 ]
