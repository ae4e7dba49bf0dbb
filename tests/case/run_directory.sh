#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A run takes its directory for itself, leaves alone what is not its own, and
# says so when the directory is taken away. Usage: run_directory.sh BUILD
. "$(dirname "$0")/common.bash"
column="$root/examples/column.lua level=5 stop=0.5 times=0.5"
# without snapshots, so that a directory is missed at the end of a step
sed 's/snapshot_every *=.*//' "$root/examples/column.lua" > endless.lua
endless="endless.lua level=5 stop=1e8 times=0.5"

# ends NAME STATUS PATTERN RANKS ARGUMENTS...: talus run ends with this status,
# and what it says matches the pattern
ends() {
  local name=$1 wanted=$2 pattern=$3 ranks=$4 status
  shift 4
  if [ "$ranks" -eq 1 ]; then
    timeout "$limit" "$build/talus" run "$@" > output 2>&1
  else
    timeout "$limit" mpirun --oversubscribe -n "$ranks" "$build/talus2d" run "$@" \
      > output 2>&1
  fi
  status=$?
  [ "$status" -eq "$wanted" ] ||
    complain "$name: exit status $status, not $wanted"
  grep -qE -e "$pattern" output || complain "$name: nothing matches $pattern"
}

# wait_for COMMAND...: until it succeeds, half a minute at most
wait_for() {
  for _ in $(seq 600); do
    "$@" 2> /dev/null && return
    sleep 0.05
  done
  complain "waited in vain for $*"
}

# has_rows DIR: some steps were made
has_rows() {
  [ -e "$1/series.csv" ] && [ "$(wc -l < "$1/series.csv")" -gt 3 ]
}

# What is somebody else's stays as it is.
for name in series.csv profile.csv parameters.csv run.log snapshots.xdmf \
  checkpoint.h5 snapshot-000003.h5; do
  rm -rf mine
  mkdir mine
  echo "my own" > "mine/$name"
  ends "my $name" 2 "error: 'mine/$name' would be written over" 1 \
    $column -o mine
  [ "$(ls mine)" = "$name" ] && [ "$(cat mine/*)" = "my own" ] ||
    complain "my $name was touched"
done
ends "my snapshot on two ranks" 2 "error: 'mine/$name' would be" 2 \
  $column -o mine
rm -rf mine
mkdir mine
pictures="outlines.png fields-final.png history.png film.gif film.mp4 plan.png heap.png"
for name in $pictures notes.txt; do echo "my own" > "mine/$name"; done
ends "my pictures" 0 "'mine/film.gif' stays" 1 $column -o mine
# signed, they are of talus plot and go with the run that they show
echo "talus plot" > mine/film.gif
ends "a picture of ours" 0 'mine held a run to time 0.5; it is replaced' 1 \
  $column -o mine
[ -e mine/film.gif ] && complain "the picture of the old run is still there"
for name in ${pictures/film.gif/} notes.txt; do
  [ "$(cat "mine/$name")" = "my own" ] || complain "my $name was touched"
done

# Of two runs in one directory the second is refused, fresh or with --restart,
# and so as long as the first one lives.
"$build/talus2d" run $endless -o one --quiet --max-walltime 60 > first 2>&1 &
pid=$!
wait_for grep -q "process $pid on " one/run.lock
wait_for test -s one/series.csv
ends "second run" 4 "error: 'one' is in use by process $pid on $(hostname)" 1 \
  $column -o one
ends "second run on two ranks" 4 "'one' is in use by process $pid" 2 \
  $column -o one
ends "second run with --restart" 4 "'one' is in use by process $pid" 1 \
  $column -o one --restart
kill -0 $pid || complain "the first run is gone"
kill -KILL $pid
wait $pid 2> /dev/null
[ -e one/run.lock ] || complain "run.lock is gone"
ends "after a run that was killed" 0 'one held a run' 1 $column -o one
[ -e one/run.lock ] && complain "run.lock is still there"
mkdir two
mpirun --oversubscribe -n 2 "$build/talus2d" run $endless -o two --quiet \
  --max-walltime 60 > first 2>&1 &
pid=$!
wait_for has_rows two
ends "beside a run on two ranks" 4 "'two' is in use by process " 1 $column -o two

# loses NAME DIR: the run $pid in DIR, which is no longer there, ends
loses() {
  wait_for eval '! kill -0 $pid'
  wait $pid
  local status=$?
  cp first output
  [ "$status" -eq 4 ] || complain "$1: exit status $status, not 4"
  grep -q "fatal: .*$2.* was removed, renamed or replaced while the run" first ||
    complain "$1: the message names another cause"
}

# The directory goes while the run goes on, or another one takes its place.
mv two moved
loses "directory renamed" two
[ -e two ] && complain "directory renamed: two is there again"
mkdir three
"$build/talus2d" run $endless -o three --quiet --max-walltime 60 > first 2>&1 &
pid=$!
wait_for has_rows three
mv three moved.too
mkdir three
loses "directory replaced" three
[ -z "$(ls three)" ] || complain "directory replaced: $(ls three) was written"

[ "$failures" -eq 0 ]
