#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A run that is stopped and goes on writes what one in one piece writes; a
# checkpoint that does not fit is refused; a full disk costs no checkpoint.
# Usage: restart.sh BUILD
. "$(dirname "$0")/common.bash"
shape="$root/examples/column.lua level=7 times=0.1,0.66"
column="$shape stop=2"
endless="$shape stop=1e8"
box="$root/examples/box3d.lua level=4 stop=0.5"

# talus RANKS PROGRAM ARGUMENTS...
talus() {
  local ranks=$1 program=$2
  shift 2
  if [ "$ranks" -eq 1 ]; then
    timeout "$limit" "$build/$program" "$@" > output 2>&1
  else
    timeout "$limit" mpirun --oversubscribe -n "$ranks" "$build/$program" "$@" \
      > output 2>&1
  fi
}

# must WORDS...: a run that has to succeed
must() {
  talus "$@" || complain "$*: exit status $?"
}

# stops WORDS...: a run that has to stop before its end
stops() {
  talus "$@"
  local status=$?
  [ $status -eq 5 ] || complain "$*: exit status $status, not 5"
}

# state DIR WORDS: `talus info` says how the run ended
state() {
  "$build/talus2d" info "$1" > output 2>&1
  grep -q "^state: $2" output || complain "$1: the state is not '$2'"
}

# same NAME DIR DIR: both tables agree to the last bit
same() {
  series "$2" > a
  series "$3" > b
  diff a b > output || complain "$1: series.csv differs"
  diff "$2/profile.csv" "$3/profile.csv" > output ||
    complain "$1: profile.csv differs"
  diff "$2/snapshots.xdmf" "$3/snapshots.xdmf" > output ||
    complain "$1: snapshots.xdmf differs"
}

# refused PATTERN WORDS...: exit status 2 and a message
refused() {
  local pattern=$1
  shift
  talus "$@"
  local status=$?
  [ "$status" -eq 2 ] || complain "$*: exit status $status, not 2"
  grep -qE "^talus: error: .*$pattern" output ||
    complain "$*: the message does not match $pattern"
}

# In pieces, on as many ranks as before. A crash after the checkpoint leaves
# rows and a snapshot from later times, which a restart repeats.
for n in 1 2; do
  must $n talus2d run $column -o whole-$n --quiet
  stops $n talus2d run $column -o parts-$n --quiet --max-steps 7
  cp parts-$n/checkpoint.h5 saved
  stops $n talus2d run $column -o parts-$n --quiet --restart --max-steps 8
  cp saved parts-$n/checkpoint.h5
  must $n talus2d run $column -o parts-$n --quiet --restart
  same "column on $n" whole-$n parts-$n
done
for n in 1 3; do
  must $n talus3d run $box -o box-$n --quiet
  stops $n talus3d run $box -o pieces-$n --quiet --max-steps 3
  must $n talus3d run $box -o pieces-$n --quiet --restart
  same "box on $n" box-$n pieces-$n
done
# exact yield keeps a stress and its changes, also over an adaptation
rest="$root/examples/rest.lua level=5 tilt=15 stop=1"
must 2 talus2d run $rest -o yield --quiet
stops 2 talus2d run $rest -o yields --quiet --max-steps 31
must 2 talus2d run $rest -o yields --quiet --restart
same "rest on 2" yield yields
# which a run with a cap has not: there is no stress to go on from
stops 1 talus2d run $rest regularisation=clip -o capped --quiet --max-steps 3
refused 'no values of stress_0 .* needs the .*regularisation of the first run' \
  1 talus2d run $rest -o capped --restart
# another grid is made at once, a level in a step, though nothing moves
still="$root/examples/rest.lua stop=1"
cells() {
  last "$1" cells
}
stops 1 talus2d run $still level=7 -o fine --quiet --max-steps 1
stops 1 talus2d run $still level=5 -o finer --quiet --max-steps 2
stops 1 talus2d run $still level=7 -o finer --quiet --restart --max-steps 1
cp -r finer finest
stops 1 talus2d run $still level=7 -o finest --quiet --restart --max-steps 1
stops 1 talus2d run $still level=7 -o finest --quiet --restart --max-steps 3
stops 1 talus2d run $still level=7 -o finer --quiet --restart --max-steps 4
same "a finer grid" finer finest
[ "$(cells finer)" -ge "$(cells fine)" ] &&
  [ "$(cells finer)" -le $(($(cells fine) * 6 / 5)) ] ||
  complain "level 7 on restart has $(cells finer) leaves, not $(cells fine)"
grep -q "other criteria of adaptation" finer/run.log || complain "not said"
sed '/adapt =/d' "$root/examples/rest.lua" > uniform.lua
stops 1 talus2d run uniform.lua level=5 -o coarser --quiet --max-steps 2
stops 1 talus2d run $still level=5 -o coarser --quiet --restart --max-steps 5
stops 1 talus2d run uniform.lua level=5 -o coarser --quiet --restart --max-steps 5
[ "$(cells coarser)" -eq 1024 ] || complain "no uniform grid on restart"
# around an axis, where it has one row more, and on a floor that changes
cylinder="$root/examples/cylinder.lua cells=8 stop=1 strip=5 r_i=0.02"
for n in 1 2; do
  must $n talus2d run $cylinder -o cylinder-$n --quiet
  stops $n talus2d run $cylinder -o rings-$n --quiet --max-steps 13
  must $n talus2d run $cylinder -o rings-$n --quiet --restart
  same "cylinder on $n" cylinder-$n rings-$n
done
awk -v a="$(last cylinder-1 front)" -v b="$(last cylinder-2 front)" \
  'BEGIN { exit !(a - b < 0.01 && b - a < 0.01) }' ||
  complain "the front of a cylinder depends on ranks"
quarter="$root/examples/cylinder.lua dimension=3 cells=4 stop=1 strip=5 r_i=0.02"
must 2 talus3d run $quarter -o quarter --quiet
stops 2 talus3d run $quarter -o quarters --quiet --max-steps 9
must 2 talus3d run $quarter -o quarters --quiet --restart
same "quarter of a cylinder on 2" quarter quarters
sed 's/"axisymmetric" or/"cartesian" or/' "$root/examples/cylinder.lua" > plane.lua
refused "another kind of coordinates" 1 talus2d run plane.lua cells=8 stop=1 \
  -o rings-1 --restart
# and when grains came to rest, at 2.05, which is known sqrt(l/g) = 0.39 later
rest="$root/examples/rest.lua level=5 slope=2 tolerance=1e-6 stop=2.6"
must 1 talus2d run $rest -o still --quiet
stops 1 talus2d run $rest -o stills --quiet --max-steps 148
must 1 talus2d run $rest -o stills --quiet --restart
for run in still stills; do
  grep -oE '(have come|came) to rest at t = .*' $run/run.log > $run.rest
  [ "$(wc -l < $run.rest)" -eq 2 ] || complain "$run: no word of rest"
done
diff still.rest stills.rest > output || complain "in pieces it rests otherwise"
state stills "finished: done .*; the grains $(tail -n 1 still.rest)"
cp -r parts-1 again
must 1 talus2d run $shape stop=2.5 -o again --quiet --restart
[ "$(own_words < output)" = "talus: restart with stop = 2.5 (was 2)" ] ||
  complain "another stop"
rm -r again
cp -r parts-1 again
must 1 talus2d run $column -o again --quiet --restart
same "nothing left to do" whole-1 again

# On other ranks it goes on to the same front within a cell, which is 1/4.
for pair in "1 2" "2 1" "1 3"; do
  set -- $pair
  rm -rf other
  stops "$1" talus2d run $column -o other --quiet --max-steps 7
  must "$2" talus2d run $column -o other --quiet --restart
  [ "$(last other time)" = 2 ] || complain "$1 to $2 ranks: not at the end"
  awk -v a="$(last other front)" -v b="$(last whole-1 front)" \
    'BEGIN { exit !(a - b < 0.25 && b - a < 0.25) }' ||
    complain "$1 to $2 ranks: front $(last other front), not $(last whole-1 front)"
done

# A signal ends the step, and says how to go on.
stops 1 talus2d run $endless -o signal --max-walltime 0.2
grep -q -e --restart output || complain "no word of how to go on"
state signal 'stopped before its end.*by --max-walltime at step'
state whole-1 'finished: done at step .*, time 2:'
for signal in INT TERM HUP; do
  rm -rf signal
  "$build/talus2d" run $endless -o signal --max-walltime 30 \
    > output 2>&1 &
  pid=$!
  for _ in $(seq 200); do
    [ -e signal/series.csv ] && [ "$(wc -l < signal/series.csv)" -gt 3 ] && break
    sleep 0.02
  done
  kill -$signal $pid
  wait $pid
  status=$?
  [ $status -eq 5 ] || complain "SIG$signal: exit status $status, not 5"
  state signal "stopped before its end.*by SIG$signal at step"
  step=$(last signal step)
  stops 1 talus2d run $endless -o signal --quiet --restart --max-steps 2
  [ "$(last signal step)" -eq $((step + 2)) ] || complain "SIG$signal: went nowhere"
done

# While it starts there is nothing to save, and a signal ends it at once.
for signal in INT TERM HUP; do
  "$build/talus2d" run "$root/examples/column.lua" level=14 -o start \
    > output 2>&1 &
  pid=$!
  sleep 1.5
  kill -$signal $pid
  wait $pid
  status=$?
  [ $status -eq 5 ] || complain "SIG$signal at the start: exit status $status"
  grep -q "by SIG$signal before the first step" output ||
    complain "SIG$signal at the start: no word of it"
  [ -e start ] && complain "SIG$signal at the start: files are left"
done

# One that nohup has had ignored stays so.
(
  trap '' HUP
  exec "$build/talus2d" run $column -o nohup > output 2>&1
) &
pid=$!
while [ ! -e nohup/series.csv ] && kill -0 $pid 2> /dev/null; do sleep 0.02; done
kill -HUP $pid 2> /dev/null
wait $pid || complain "an ignored SIGHUP stops the run"

# What does not fit is refused, and nothing is touched.
cp -r parts-1 kept
refused "another size" 1 talus2d run $column size=16 -o kept --restart
refused "another size" 2 talus2d run $column size=16 -o kept --restart
refused "another dimension" 1 talus3d run $box -o kept --restart
refused "missing or damaged" 1 talus2d run $column -o nowhere --restart
[ -e nowhere ] && complain "nowhere was made"
head -c 3000 parts-1/checkpoint.h5 > kept/checkpoint.h5
refused "missing or damaged" 1 talus2d run $column -o kept --restart
echo text > kept/checkpoint.h5
refused "missing or damaged" 2 talus2d run $column -o kept --restart
cmp -s kept/series.csv parts-1/series.csv || complain "series.csv was touched"
cp parts-1/checkpoint.h5 kept/
sed -i '1s/.*/step,other/' kept/series.csv
refused "other columns" 1 talus2d run $column -o kept --restart

# Rows that are missing before the checkpoint, or are not as they were
# lacks PATTERN RANKS: of kept/, which is as it was after that
lacks() {
  cp -r kept before
  refused "$1" "$2" talus2d run $column -o kept --restart
  diff -r before kept > output || complain "$1: a file was touched"
  rm -r before kept
  cp -r parts-1 kept
}
rm -r kept
cp -r parts-1 kept
sed -i '5,7d;9d' kept/series.csv
lacks 'it lacks 4 of the .* rows up to step .*: steps 3 to 5, 7;' 1
sed -i '2d' kept/series.csv
lacks 'it lacks 1 of the .*: step 0;' 2
head -c 700 parts-1/series.csv > kept/series.csv
lacks 'it lacks .*: steps [0-9]* to [0-9]*;' 1
truncate -s -3 kept/series.csv
lacks 'it lacks 1 of .*: step [0-9]*;' 1
sed -i '4s/,0/,1/' kept/series.csv
lacks 'not as written' 1
sed -i '3d' kept/profile.csv
lacks 'profile.csv.*it lacks 1 of the .* rows up to time 2;' 1
rm kept/series.csv
lacks 'series.csv.*No such file' 1
# A checkpoint alone may be gone on from.
rm -rf kept/*
cp saved kept/checkpoint.h5
stops 1 talus2d run $column -o kept --restart --max-steps 2
grep -q "stands alone: series.csv" output || complain "no word of new tables"
sed -n '2,3s/,.*//p' kept/series.csv | tr '\n' ' ' > output
[ "$(cat output)" = "8 9 " ] || complain "other steps after a lone checkpoint"
must 1 talus2d run $column -o kept --quiet --restart

# A disk that takes no more: status 4, the words of the system, and the last
# checkpoint is whole. A limit on the size of files does for a full disk.
stops 1 talus2d run $column -o full --quiet --max-steps 3
cp full/checkpoint.h5 saved
(
  trap '' XFSZ
  ulimit -f 30
  talus 1 talus2d run $column -o full --restart --max-steps 1
)
status=$?
[ $status -eq 4 ] || complain "full disk: exit status $status, not 4"
grep -q 'fatal: .*File too large' output || complain "full disk: no message"
cmp -s saved full/checkpoint.h5 || complain "full disk: checkpoint is lost"
state full 'failed'
must 1 talus2d run $column -o full --quiet --restart
same "after a full disk" whole-1 full

[ "$failures" -eq 0 ]
