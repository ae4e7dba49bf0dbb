#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/check_includes.py finds one violation of each rule, and nothing in the
# clean file beside them.
set -euo pipefail
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/src/{base,geometry,tree,flow,io} "$tree"/include/talus
spdx='/* SPDX-License-Identifier: GPL-3.0-or-later */'

# file NAME LINE...: a file of these lines under the licence
file() {
  local name=$1
  shift
  printf '%s\n' "$spdx" "$@" > "$tree/$name"
}

for header in error plane mesh step; do file "include/talus/$header.h"; done
file src/base/error.c '#include "talus/error.h"' 'int f(void) { exit(1); }'
file src/geometry/plane.c '#include "talus/plane.h"' '#include "talus/mesh.h"' \
  '#include <mpi.h>'
file src/tree/mesh.c '#include "talus/mesh.h"' '#include <p4est.h>' \
  '#if DIM == 2' '#endif'
file src/flow/step.c '#include <math.h>' '#include "talus/step.h"' \
  '#include <hdf5.h>' '#if DIM == 3' '#endif' \
  '/* malloc(1) */ char *s = "free(s)"; int xfree(void);' \
  'int g(void) { free(s); }'
file src/io/series.c '#include "talus/step.h"' '#include "talus/error.h"'
file include/talus/orphan.h
echo 'int x;' > "$tree/src/main.c"

expected='include/talus/orphan.h:1: belongs to no folder
src/flow/step.c:2: include "talus/step.h" first
src/flow/step.c:4: <hdf5.h> may be included by io only
src/flow/step.c:5: #if DIM is for geometry and tree only
src/flow/step.c:8: free() is for base only
src/geometry/plane.c:3: geometry may not see talus/mesh.h
src/geometry/plane.c:4: geometry may not see MPI
src/io/series.c:2: io may not see talus/step.h
src/main.c:1: first line must be'

found=$(python3 tools/check_includes.py "$tree" | sort) && exit 1
while IFS= read -r line <&3 && IFS= read -r want <&4; do
  case $line in
    "$want"*) ;;
    *) echo "found '$line' instead of '$want'"; exit 1 ;;
  esac
done 3<<< "$found" 4<<< "$expected"
if [ "$(wc -l <<< "$found")" -ne "$(wc -l <<< "$expected")" ]; then
  echo "found: $found"
  exit 1
fi
