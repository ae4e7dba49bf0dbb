#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs groups of tests and adds them up. The last line is `N passed, N failed`.
#
#   tests/run.sh BUILD GROUP...
#
# A group may be cut down to a part of it: mesh:3d/2, case:ends. What of unit,
# mesh and case needs one core only is run beside others, as many at once as there
# are cores; what needs more is run alone, after these.
#
#   format    clang-format 14 has nothing to change
#   includes  tools/check_includes.py, check_prose.py, check_circles.py
#   unit      BUILD/{2d,3d}/unit
#   mesh      BUILD/{2d,3d}/mesh on 1, 2 and 3 ranks
#   case      tests/case/*.sh BUILD; silent if all is well, 77 means skipped
#   examples  every examples/*.lua at low resolution against its `expect`
#   small     a few steps of examples/column.lua on 1 and 2 ranks
#
# Environment: RANKS="1 2 3" for mesh; TEST_TIMEOUT, seconds for one program;
# CK_RUN_SUITE=vof runs one suite only.
#
# A program that runs out of time, as on a busy machine, or one of whose tests
# does, says "timed out" and is run once more with RETRY times as long; if that
# does not do either it has failed.
set -u
cd "$(dirname "$0")/.." || exit 1

build=$1
shift
passed=0
failed=0
limit=${TEST_TIMEOUT:-300}
RETRY=3
output=$(mktemp)
trap 'rm -f "$output"' EXIT

# The cores may be busy with others, which is no failure.
export CK_DEFAULT_TIMEOUT=${CK_DEFAULT_TIMEOUT:-60}
# What libraries leak at the end of a process is not ours to mend; memory.c
# counts our own blocks.
export ASAN_OPTIONS=detect_leaks=0:${ASAN_OPTIONS:-}
export UBSAN_OPTIONS=print_stacktrace=1:${UBSAN_OPTIONS:-}

# has_timed_out STATUS: the program, a test of Check, or what a script started
has_timed_out() {
  [ "$1" -eq 124 ] && return
  [ "$1" -ne 0 ] &&
    grep -qE 'Test timeout expired|exit status 124' "$output"
}

# in_time NAME COMMAND...: runs it into $output, once more if it times out;
# returns its status
in_time() {
  local name=$1 status begin=$SECONDS
  shift
  "$@" > "$output" 2>&1
  status=$?
  has_timed_out $status || return $status
  printf '%-28s timed out after %d s; once more, with %d times as long\n' \
    "$name" $((SECONDS - begin)) "$RETRY"
  limit=$((RETRY * limit)) \
    CK_DEFAULT_TIMEOUT=$((RETRY * CK_DEFAULT_TIMEOUT)) \
    TIME_FACTOR=$RETRY "$@" > "$output" 2>&1
}

# limited COMMAND...: ended after $limit seconds
limited() {
  timeout "$limit" "$@"
}

# report NAME STATUS PASSED FAILED: one line, and the output if it failed
report() {
  local name=$1 status=$2 good=$3 bad=$4
  # A program that dies before its summary has failed once.
  [ "$status" -ne 0 ] && [ "$bad" -eq 0 ] && bad=1
  passed=$((passed + good))
  failed=$((failed + bad))
  printf '%-28s %4d passed, %d failed%s\n' "$name" "$good" "$bad" \
    "$(has_timed_out "$status" && echo ', timed out')"
  [ "$bad" -eq 0 ] && return
  sed 's/^/  /' "$output" | tail -n 60
}

# run_suite NAME COMMAND...: a program of Check suites
run_suite() {
  local name=$1 status counts
  shift
  in_time "$name" limited "$@"
  status=$?
  counts=$(sed -n \
    's/^[0-9]*%: Checks: \([0-9]*\), Failures: \([0-9]*\), Errors: \([0-9]*\)$/\1 \2 \3/p' \
    "$output" | tail -n 1)
  read -r checks failures errors <<< "${counts:-0 0 0}"
  report "$name" "$status" $((checks - failures - errors)) \
    $((failures + errors))
}

# run_one NAME COMMAND...: a program that is one test
run_one() {
  local name=$1 status
  shift
  [ "$(type -t "$1")" = function ] || set -- limited "$@"
  in_time "$name" "$@"
  status=$?
  if [ "$status" -eq 77 ]; then
    printf '%-28s skipped: %s\n' "$name" "$(tail -n 1 "$output")"
  elif [ "$status" -eq 0 ]; then
    report "$name" 0 1 0
  else
    report "$name" "$status" 0 1
  fi
}


# Names the files that `make format` would change, fails if there are any.
find_unformatted() {
  find include src tree tests -name '*.[ch]' -exec clang-format-14 --dry-run {} + \
    2>&1 | sed -n 's/^\([^:]*\):.*Wclang-format.*/make format: \1/p' | sort -u |
    grep . && return 1
  return 0
}

group_format() {
  if ! command -v clang-format-14 > /dev/null; then
    echo "format: skipped, clang-format-14 is not installed"
    return
  fi
  run_one format find_unformatted
}

group_includes() {
  run_one includes "${PYTHON:-python3}" tools/check_includes.py
  run_one prose "${PYTHON:-python3}" tools/check_prose.py
  run_one circles "${PYTHON:-python3}" tools/check_circles.py "$build"
}

# at_once GROUP...: each in a process of its own, their lines when it ends.
# They must not tidy up each other's directories of Open MPI nor be bound to
# one core, and ranks that wait leave it to others.
at_once() {
  local line scratch ended=0
  scratch=$(mktemp -d)
  while IFS= read -r line; do
    if [[ $line =~ ^([0-9]+)\ passed,\ ([0-9]+)\ failed$ ]]; then
      passed=$((passed + BASH_REMATCH[1]))
      failed=$((failed + BASH_REMATCH[2]))
      ended=$((ended + 1))
    else
      echo "$line"
    fi
  done < <(printf '%s\n' "$@" |
    OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_hwloc_base_binding_policy=none \
    xargs -P "$(nproc)" -I {} bash -c '
      export OMPI_MCA_orte_tmpdir_base=$(mktemp -d -p "$2")
      lines=$(tests/run.sh "$0" "$1" 2>&1)
      echo "$lines"' "$build" {} "$scratch")
  rm -rf "$scratch"
  [ $ended -eq $# ] && return
  echo "$ended of $# ended: $*"
  failed=$((failed + 1))
}

# group_unit DIMENSION
group_unit() {
  run_suite "unit $1" "$build/$1/unit"
}

# group_mesh DIMENSION/RANKS
group_mesh() {
  local d=${1%/*} n=${1#*/}
  run_suite "mesh $d on $n" mpirun --oversubscribe -n "$n" "$build/$d/mesh"
}

# group_case NAME
group_case() {
  run_one "case $1" bash "tests/case/$1.sh" "$build"
}

group_examples() {
  local f
  for f in examples/*.lua; do
    [ -e "$f" ] && run_one "example $(basename "$f" .lua)" \
      "${PYTHON:-python3}" tools/check_example.py "$build" "$f"
  done
}

# A few steps on N ranks, which is a run stopped before its end: status 5.
run_few_steps() {
  timeout "$limit" mpirun --oversubscribe -n "$1" "$build/talus2d" run \
    examples/column.lua level=6 --max-steps 20 --quiet -o "$build/column-$1"
  local status=$?
  [ "$status" -eq 5 ] && return 0
  [ "$status" -eq 0 ] && return 1
  return "$status"
}

group_small() {
  local n
  for n in 1 2; do run_one "column on $n" run_few_steps "$n"; done
}

pool=()
alone=()
for group in "$@"; do
  case $group in
    unit) pool+=(unit:2d unit:3d) ;;
    mesh)
      for n in ${RANKS:-1 2 3}; do
        if [ "$n" -eq 1 ]; then
          pool+=(mesh:3d/1 mesh:2d/1)
        else
          alone+=("2d/$n" "3d/$n")
        fi
      done ;;
    case) for f in tests/case/*.sh; do pool+=("case:$(basename "$f" .sh)"); done ;;
    *) "group_${group%%:*}" "${group#*:}" ;;
  esac
done
[ ${#pool[@]} -gt 0 ] && at_once "${pool[@]}"
for part in "${alone[@]}"; do group_mesh "$part"; done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
