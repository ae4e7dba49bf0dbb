#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# --restart refuses a checkpoint that is not what was written, says what is
# wrong with it, and touches nothing. Usage: checkpoint.sh BUILD
. "$(dirname "$0")/common.bash"
column="$root/examples/column.lua level=6 stop=2"

if ! command -v python3 > /dev/null; then
  echo "there is no python3"
  exit 77
fi

# listing DIR: names, sizes, times of last change and sums of all files
listing() {
  (cd "$1" && ls -l --time-style=full-iso && cat ./*.* 2> /dev/null | cksum)
}

# refused NAME RANKS PATTERN: a restart of work/ ends with status 2, one message
# that matches PATTERN, and nothing changed
refused() {
  local status
  listing work > before
  if [ "$2" -eq 1 ]; then
    timeout "$limit" "$build/talus" run $column -o work --restart > output 2>&1
  else
    timeout "$limit" mpirun --oversubscribe -n "$2" "$build/talus2d" run $column \
      -o work --restart > output 2>&1
  fi
  status=$?
  [ "$status" -eq 2 ] || complain "$1: exit status $status, not 2"
  grep -qE "^talus: error: 'work/checkpoint.h5' .*$3" output ||
    complain "$1: the message does not match $3"
  listing work > after
  cmp -s before after || complain "$1: a file was touched"
}

# change NAME ARGUMENTS...: a sound checkpoint, changed
change() {
  cp whole/checkpoint.h5 work/checkpoint.h5
  python3 change.py work/checkpoint.h5 "$@" || complain "cannot change $*"
}

cat > change.py << 'END'
"""change.py FILE damage SEED | set NAME WAS IS | fill VALUE LENGTH WAS IS:
a random damage; a scalar, or one number of a run of LENGTH equal ones, with
the seal made anew."""
import random
import struct
import sys
import zlib

path, what, words = sys.argv[1], sys.argv[2], sys.argv[3:]
data = bytearray(open(path, "rb").read())


def number(text):
    return struct.pack("<d", float(text)) if "." in text or "n" in text \
        else struct.pack("<q", int(text))


def reseal():
    lines = bytes(data[:512]).split(b"\n")[:5]
    lines[4] = b"crc32 %08x" % zlib.crc32(data[512:])
    text = b"\n".join(lines) + b"\n"
    text += b"seal %08x\n" % zlib.crc32(text)
    data[:512] = text.ljust(512, b"\0")


if what == "damage":
    random.seed(int(words[0]))
    was, kind = bytes(data), int(words[0]) % 4
    while bytes(data) == was:
        place = random.randrange(len(data))
        if kind == 0:
            data[place] ^= 1 << random.randrange(8)
        elif kind == 1:
            page = place // 4096 * 4096
            n = len(data[page:page + 4096])
            data[page:page + n] = bytes(n)
        elif kind == 2:
            del data[place:]
        else:
            data[place:place + 8] = random.randbytes(len(data[place:place + 8]))
elif what == "set":
    name, was, now = words
    place = data.index(name.encode() + b"\0", data.index(b"state\0"))
    place = data.index(number(was), place)
    assert place - data.index(name.encode() + b"\0") < 1 << 16
    data[place:place + 8] = number(now)
    reseal()
else:
    was, length, now = number(words[0]), int(words[1]), number(words[2])
    place = data.index(was * length)
    data[place + 8:place + 16] = now
    reseal()
open(path, "wb").write(data)
END

# Three steps at the least, so that numbers of steps are not those of others.
"$build/talus" run $column -o whole --quiet --max-steps 7 > output 2>&1
[ -e whole/checkpoint.h5 ] || complain "no checkpoint"
cp -r whole work
time=$(tail -n 1 whole/series.csv | cut -d, -f2)

for seed in $(seq 20); do
  change damage "$seed"
  refused "damage $seed" 1 "is missing or damaged"
done
for seed in 4 5; do
  change damage "$seed"
  refused "damage $seed" 2 "is missing or damaged"
done

# Well sealed, but no run wrote it
change set step 7 -5
refused "negative step" 1 'step = -5, a number from 0'
change set step 7 -5
refused "negative step" 2 'step = -5, a number from 0'
change set snapshots "$(ls whole/snapshot-*.h5 | wc -l)" 1000000000
refused "snapshots" 1 'snapshots = 1000000000, after step 7 a number from 0 to 8'
change set time "$time" -1.0
refused "negative time" 1 'time = -1, a finite number of at least 0'
change set time "$time" nan
refused "no time" 1 'time = -?nan, a finite number'
change fill 1.0 2 -3.0
refused "fraction" 1 'fraction \(.*\) = -3 in the leaf at .*from 0 to 1'
change fill 1.0 2 nan
refused "fraction" 2 'fraction \(.*\) = -?nan in the leaf at'
# sound again
change fill 1.0 2 1.0
"$build/talus" run $column -o work --restart --quiet > output 2>&1 ||
  complain "a sound checkpoint is refused"

# What older versions wrote is a bare HDF5 file.
rm -r work
cp -r whole work
tail -c +513 whole/checkpoint.h5 > work/checkpoint.h5
refused "older version" 1 'written by an older version of talus'
rm work/checkpoint.h5
mkdir work/checkpoint.h5
refused "a directory" 1 'no regular file'

[ "$failures" -eq 0 ]
