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
