#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/check_includes.py finds one violation of each rule, and nothing in the
# clean file beside them; tools/check_prose.py as well; tools/check_circles.py
# finds two files that call each other, and not a third that calls both. Usage:
# layering.sh BUILD
. "$(dirname "$0")/common.bash"
set -eo pipefail
tree=$directory
mkdir -p "$tree"/tree "$tree"/src/{base,geometry,flow,io,two_phase,command} \
  "$tree"/include/talus/two_phase
spdx='/* SPDX-License-Identifier: GPL-3.0-or-later */'

# file NAME LINE...: a file of these lines under the licence
file() {
  local name=$1
  shift
  printf '%s\n' "$spdx" "$@" > "$tree/$name"
}

for header in error plane mesh advection two_phase/step; do
  file "include/talus/$header.h"
done
file src/base/error.c '#include "talus/error.h"' 'int f(void) { exit(1); }'
file src/geometry/plane.c '#include "talus/plane.h"' '#include "talus/mesh.h"' \
  '#include <mpi.h>'
file tree/mesh.c '#include "talus/mesh.h"' '#include <p4est.h>' \
  '#if DIM == 2' '#endif'
file src/flow/advection.c '#include "talus/advection.h"' \
  '#include "talus/two_phase/step.h"'
file src/two_phase/step.c '#include <math.h>' '#include "talus/two_phase/step.h"' \
  '#include <hdf5.h>' '#if DIM == 3' '#endif' \
  '/* malloc(1) */ char *s = "free(s)"; int xfree(void);' \
  'int g(void) { free(s); }'
file src/io/series.c '#include "talus/advection.h"' '#include "talus/error.h"'
file include/talus/orphan.h
file src/models.c '#include "talus/two_phase/step.h"'
echo 'int x;' > "$tree/src/command/main.c"

expected='include/talus/orphan.h:1: belongs to no folder
src/command/main.c:1: first line must be
src/flow/advection.c:3: flow may not see talus/two_phase/step.h
src/geometry/plane.c:3: geometry may not see talus/mesh.h
src/geometry/plane.c:4: geometry may not see MPI
src/io/series.c:2: io may not see talus/advection.h
src/two_phase/step.c:2: include "talus/two_phase/step.h" first
src/two_phase/step.c:4: <hdf5.h> may be included by io only
src/two_phase/step.c:5: #if DIM is for geometry and tree only
src/two_phase/step.c:8: free() is for base only'

found=$(python3 "$root/tools/check_includes.py" "$tree" | sort) && exit 1
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

mkdir -p "$tree"/tools "$tree"/tests
echo '@article{known_2010,' > "$tree/references.bib"
file src/base/prose.c '/* The sum of both, as in error.h and prose.h. */' \
  'int sum(int a, int b) {' '}' \
  '/* Add as NAME.c does [known_2010; unknown_2011, eq. 2]. */' 'int add(int a);'
found=$(python3 "$root/tools/check_prose.py" "$tree") && exit 1
expected='src/base/prose.c:2: there is no prose.h
src/base/prose.c:5: unknown_2011 is not in references.bib
src/base/prose.c:2: begin with a verb, not with The'
[ "$found" = "$expected" ] || { echo "$found"; exit 1; }

circles=$root/tools/check_circles.py
mkdir -p build/2d/src/flow
echo 'int b(void); int a(void) { return b(); }' > src/flow/a.c
echo 'int a(void); int b(void) { return a(); }' > src/flow/b.c
echo 'int a(void); int c(void) { return a(); }' > src/flow/c.c
for name in a b c; do gcc -c "src/flow/$name.c" -o "build/2d/src/flow/$name.o"; done
found=$(python3 "$circles" build) && exit 1
expected='files that need one another:
  src/flow/a.c calls b
  src/flow/b.c calls a'
[ "$found" = "$expected" ] || { echo "$found"; exit 1; }
rm src/flow/b.c
python3 "$circles" build
