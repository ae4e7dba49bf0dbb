#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs convergence cases, as many at once as there are cores, and puts their
# rows together. Status 1 if a bar is missed.
#
#   tests/convergence/run.sh BUILD [all|short|NAME...]
#
# Leaves BUILD/convergence/report.csv and one picture per case there.
set -u
cd "$(dirname "$0")/../.." || exit 1

build=$1
shift
directory=$build/convergence
jobs=${JOBS:-$(nproc)}
python=${PYTHON:-python3}
started=$(date +%s)
mkdir -p "$directory"

case ${1:-all} in
  all) names=$(for d in 2d 3d; do "$build/$d/convergence" list; done) ;;
  short) names=$(for d in 2d 3d; do "$build/$d/convergence" list short; done) ;;
  *) names=$* ;;
esac

# One case: its own csv, and whatever it says if it dies.
run_case() {
  local d rows=$directory/$1.csv
  rm -f "$rows"
  for d in 2d 3d; do
    "$build/$d/convergence" list | grep -qx "$1" && break
    [ "$d" = 3d ] && echo "there is no case $1" >&2 && return
  done
  local begin=$SECONDS
  timeout "${CASE_TIMEOUT:-1200}" "$build/$d/convergence" "$1" "$rows" \
    > "$directory/$1.log" 2>&1
  if [ $? -gt 1 ]; then
    echo "$1,,ended early,,nan,,,fail" >> "$rows"
    sed 's/^/  /' "$directory/$1.log" | tail -n 20
  fi
  echo "$1: $((SECONDS - begin)) s" >&2
}
export -f run_case
export build directory
printf '%s\n' $names | xargs -P "$jobs" -I{} bash -c 'run_case {}'

report=$directory/report.csv
echo "case,grid,norm,level,value,order,bar,verdict" > "$report"
for name in $names; do
  [ -e "$directory/$name.csv" ] && grep "^$name," "$directory/$name.csv"
done >> "$report"
"$python" tools/plot_convergence.py "$report"
echo "$(($(date +%s) - started)) s; $report and pictures beside it"
# nothing measured is no success
grep -q ',pass$' "$report" && ! grep -q ',fail$' "$report"
