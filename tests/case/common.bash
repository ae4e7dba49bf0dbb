# SPDX-License-Identifier: GPL-3.0-or-later
# Opening of the scripts of tests/case, which start in the root of the checkout
# with the build directory as argument: leaves both in $root and $build, the
# script in an empty $directory that goes away with it.
set -u
# Containers run as root and forbid CMA.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_btl_vader_single_copy_mechanism=none
root=$(pwd)
build=$(cd "$1" && pwd) || exit 1
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory" || exit 1
limit=$((120 * ${TIME_FACTOR:-1})) # seconds for one run
failures=0

# complain WORDS: a failure, and what `output` holds of it
complain() {
  echo "$1"
  [ -e "$directory/output" ] && sed 's/^/  /' "$directory/output"
  failures=$((failures + 1))
}

# ends STATUS COMMAND...: the command ends with this status
ends() {
  local expected=$1 status
  shift
  timeout "$limit" "$@" > output 2>&1
  status=$?
  [ $status -eq "$expected" ] || complain "$*: exit status $status"
}

# says PATTERN: so does the last command
says() {
  grep -q "$1" output || complain "nothing matches $1"
}

# series DIR: series.csv without the clock
series() {
  awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "wall_seconds") clock = k }
    { for (k = 1; k <= NF; k++) if (k != clock) printf "%s,", $k; print "" }' \
    "$1/series.csv"
}

# last DIR COLUMN: value in the last row of series.csv
last() {
  awk -F, -v name="$2" '
    NR == 1 { for (k = 1; k <= NF; k++) if ($k == name) column = k }
    END { print column ? $column : "no column " name }' "$1/series.csv"
}

# restarts DIR STEPS CASE...: a run in two pieces, the first of STEPS, writes what
# it writes in one
restarts() {
  local whole=$1 steps=$2
  shift 2
  ends 0 "$build/talus" run "$@" -o "$whole" --quiet
  ends 5 "$build/talus" run "$@" -o "${whole}_parts" --quiet --max-steps "$steps"
  ends 0 "$build/talus" run "$@" -o "${whole}_parts" --quiet --restart
  diff <(series "$whole") <(series "${whole}_parts") > output ||
    complain "$whole: a restart changes series.csv"
  diff "$whole/profile.csv" "${whole}_parts/profile.csv" > output ||
    complain "$whole: a restart changes profile.csv"
}

# books DIR TURNED COLUMN: TURNED is DIR, a step later and with twice the
# gravity; the energy of this is no loss, which stands in COLUMN
books() {
  awk -v potential="$(last "$1" potential)" -v lost="$(last "$1" "$3")" \
    -v changed="$(last "$2" work_of_changes)" -v now="$(last "$2" "$3")" 'BEGIN {
      d = changed / potential - 1; e = (now - lost) / potential
      exit !(d < 1e-6 && -d < 1e-6 && e < 0.01 && -e < 0.01) }' ||
    complain "$2: another gravity is booked as $3"
}

# find_python: $python has what pictures need; without one the test is skipped
find_python() {
  for python in "${PYTHON:-python3}" python3 /usr/bin/python3; do
    "$python" -c 'import h5py, matplotlib' 2> /dev/null && return
  done
  echo "no Python with h5py and matplotlib"
  exit 77
}

# own_words < FILE: what is left without what MPI and the libraries below it
# print by themselves: boxes between dashes, lines of [host:process], words on
# displays and devices that are not there
own_words() {
  awk '/^--------------------+$/ { box = !box; next }
    box || /^ *$/ || /^\[[^]]*[:,][0-9]+\]/ { next }
    /^(No protocol specified|Authorization required|Invalid MIT-MAGIC)/ { next }
    /^(libibverbs|librdmacm|libfabric|hwloc|PMIX|PSM|UCX|mlx[0-9]*)[:/ ]/ { next }
    { print }'
}
