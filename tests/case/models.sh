#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A model that no file of src knows, tests/model/given_flow.c, is built into the
# program, starts, adapts its grid, is stopped and goes on to the last bit, and
# is drawn; keys and checkpoints of one model are refused by the other.
# Usage: models.sh BUILD
. "$(dirname "$0")/common.bash"
case=$root/tests/model/given_flow.lua

# says WORDS: the last command did
says() {
  own_words < output | tr '\n' ' ' | grep -qF -- "$1" ||
    complain "it does not say: $1"
}

# The objects are those of BUILD, but for the list of models.
mkdir build && cp -a "$build/2d" "$build/flags" build
ends 0 make -C "$root" BUILD="$directory/build" MODE="${MODE:-release}" \
  MODELS=tests/model/given_flow.c "$directory/build/talus2d"
talus=$directory/build/talus2d
[ -x "$talus" ] || exit 1

for ranks in 1 2; do
  run="mpirun --oversubscribe -n $ranks $talus run $case --quiet"
  ends 0 $run -o "whole$ranks"
  ends 5 $run -o "parts$ranks" --max-steps 17
  ends 0 $run -o "parts$ranks" --restart
  for file in series.csv profile.csv; do
    cmp "whole$ranks/$file" "parts$ranks/$file" > output 2>&1 ||
      complain "$file differs after a restart on $ranks"
  done
done
# the grains keep their volume, and the grid has followed them
python3 - whole1 > output 2>&1 << 'END' || complain "the run is wrong"
import csv, sys
rows = list(csv.DictReader(open(sys.argv[1] + "/series.csv")))
volume = [float(row["volume"]) for row in rows]
assert max(volume) - min(volume) < 1e-14, volume
assert abs(volume[0] - 0.0225 * 3.14159265) < 1e-4, volume[0]
profile = list(csv.DictReader(open(sys.argv[1] + "/profile.csv")))
def centre(time):
    at = [(float(r["x"]), float(r["height"])) for r in profile
          if float(r["time"]) == time]
    return sum(x * h for x, h in at) / sum(h for x, h in at)
moved = centre(1) - centre(0)
assert abs(moved - 0.25) < 1e-3, moved  # shear_rate * y * t of the disc
END
ends 0 "$talus" check "$case"
says "shear_rate"
ends 0 "$talus" help case
says 'Keys of model = "given_flow"'
ends 0 "$talus" help output
says 'That of model = "given_flow" has the columns'
ends 0 "$talus" run "$case" -o timed --timing level=5
says "volume fraction"
if "${PYTHON:-python3}" -c 'import h5py, matplotlib' 2> output; then
  ends 0 env TALUS_TOOLS="$root/tools" "$talus" plot whole1
  [ -s whole1/history.png ] || complain "history.png is not there"
fi

# keys and checkpoints of the other model
sed 's/shear_rate = 0.5/shear_rate = 0.5, gas = { density = 1 }/' "$case" > a.lua
ends 2 "$talus" check a.lua
says 'gas = a table is a key of model = "two_phase"'
sed 's/model = "given_flow"/model = "given_flaw"/' "$case" > a.lua
ends 2 "$talus" check a.lua
says '"two_phase", "four_state", "two_fluid" or "given_flow"'
sed 's/shear_rate = 0.5/tracers = { a = function(x, y) return x end }/' "$case" > a.lua
ends 2 "$talus" check a.lua
says 'tracers = a table is a key of model = "two_phase"'
sed 's/stop = 1,/stop = 1, stop_at_rest = { speed = 1, time = 1 },/' "$case" > a.lua
ends 2 "$talus" check a.lua
says 'output.stop_at_rest = a table is a key of model = "two_phase"'
sed 's/shape = .*/-- none/' "$case" > a.lua
ends 2 "$talus" run a.lua
says 'grains.shape is missing'
echo 'return { dimension = 2, shear_rate = 1 }' > a.lua
ends 2 "$talus" check a.lua
says 'shear_rate = 1 is a key of model = "given_flow"'
column="$root/examples/column.lua level=5 stop=0.1"
ends 0 "$talus" run $column -o column --quiet
cp column/checkpoint.h5 whole1/checkpoint.h5
ends 2 "$talus" run "$case" -o whole1 --restart
says 'belongs to a run of model = "two_phase"'

[ "$failures" -eq 0 ]
