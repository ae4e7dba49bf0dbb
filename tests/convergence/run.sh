#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs convergence cases, as many at once as there are cores, and puts their
# rows together.
#
#   tests/convergence/run.sh BUILD [all|short|NAME...]
#
# Leaves BUILD/convergence/report.csv and one picture per case there. Ends with
# the rows that failed and a line that counts; status 0 if every case that was
# asked for ran to its end and missed no bar, 1 if not, 2 if it is not known
# what to run. A case that ends early, runs out of time (CASE_TIMEOUT, 1200 s)
# or measures nothing against a bar is a failed row.
set -u
cd "$(dirname "$0")/../.." || exit 2

build=$1
shift
directory=$build/convergence
jobs=${JOBS:-$(nproc)}
python=${PYTHON:-python3}
limit=${CASE_TIMEOUT:-1200}
started=$(date +%s)

# "NAME DIMENSION" of all cases, or of the short ones
list_cases() {
  local d
  for d in 2d 3d; do
    "$build/$d/convergence" list "$@" | sed "s/\$/ $d/" || return
  done
}

refuse() {
  echo "convergence: $*" >&2
  exit 2
}

set -o pipefail
all=$(list_cases) || refuse "$build/2d/convergence, 3d: not built"
case ${1:-all} in
  all) cases=$all ;;
  short) cases=$(list_cases short) || refuse "cannot list the short cases" ;;
  *)
    cases=
    for name in "$@"; do
      found=$(grep "^$name " <<< "$all") ||
        refuse "there is no case $name; there are" $(cut -d ' ' -f 1 <<< "$all")
      cases+=$found$'\n'
    done
    ;;
esac
[ -n "$cases" ] || refuse "no cases"
mkdir -p "$directory" || exit 2

# run_case NAME DIMENSION: its own csv, and what it says if it dies. Cases that
# start together must not tidy up each other's directories of Open MPI.
run_case() {
  local name=$1 rows=$directory/$1.csv begin=$SECONDS status why= scratch
  scratch=$(mktemp -d)
  rm -f "$rows"
  OMPI_MCA_orte_tmpdir_base=$scratch timeout "$limit" \
    "$build/$2/convergence" "$name" "$rows" > "$directory/$name.log" 2>&1
  status=$?
  rm -rf "$scratch"
  case $status in
    0) grep -q ',[<>of][^,]*,pass$' "$rows" || why="measured nothing" ;;
    1) grep -q ',fail$' "$rows" || why="ended early: status 1" ;;
    124) why="timed out after $limit s" ;;
    *) why="ended early: status $status" ;;
  esac
  if [ -n "$why" ]; then
    echo "$name,,$why,,nan,,,fail" >> "$rows"
    sed 's/^/  /' "$directory/$name.log" | tail -n 20
  fi
  echo "$name: $((SECONDS - begin)) s" >&2
}
export -f run_case
export build directory limit
xargs -P "$jobs" -L 1 bash -c 'run_case "$@"' run_case <<< "${cases%$'\n'}"

report=$directory/report.csv
heading="case,grid,norm,level,value,order,bar,verdict"
{
  echo "$heading"
  while read -r name _; do
    # one that left no file never began
    grep -v "^$heading\$" "$directory/$name.csv" ||
      echo "$name,,left no rows,,nan,,,fail"
  done <<< "${cases%$'\n'}"
} > "$report"
"$python" tools/plot_convergence.py "$report"
shown=$?

# by what is not a pass: a row cut short is no success
rows=$(($(wc -l < "$report") - 1))
barred=$(grep -c '^[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]\+,pass$' "$report")
bad=$(tail -n +2 "$report" | grep -cv ',pass$')
count=$(grep -c . <<< "$cases")
echo "$report and pictures beside it"
if [ "$shown" -ne 0 ]; then
  echo "tools/plot_convergence.py ended with status $shown; rows that failed:"
  tail -n +2 "$report" | grep -v ',pass$'
fi
echo "convergence: $count cases, $rows rows, $barred within their bars," \
  "$bad failed, $(($(date +%s) - started)) s"
[ "$bad" -eq 0 ] && [ "$barred" -gt 0 ] && [ "$shown" -eq 0 ]
