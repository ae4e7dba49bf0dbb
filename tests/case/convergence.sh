#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tests/convergence/run.sh: its status and last line say what the cases did.
# Programs made here stand in for them. Usage: convergence.sh BUILD
. "$(dirname "$0")/common.bash"
mkdir "$directory/2d" "$directory/3d"

cat > "$directory/2d/convergence" << 'PROGRAM'
#!/bin/bash
names="good bad bare dies slow cut quiet early"
[ "$1" = list ] && { printf '%s\n' $names; exit; }
[ "$1" = quiet ] && exit 0
[ "$1" = slow ] && sleep 10
exec > "$2"
echo "case,grid,norm,level,value,order,bar,verdict"
case $1 in
  good | dies | early) echo "$1,grid,norm,3,1,,<= 2,pass" ;;
  bad) echo "bad,grid,norm,3,3,,<= 2,fail"; exit 1 ;;
  bare) echo "bare,grid,norm,3,3,,,pass" ;;
  cut) echo "cut,grid,norm,3,1,,<= 2,pass"; printf 'cut,grid,nor' ;;
esac
[ "$1" = dies ] && kill -9 $$
[ "$1" != early ]
PROGRAM
cat > "$directory/3d/convergence" << 'PROGRAM'
#!/bin/bash
[ "$1" = list ] && { echo cube; exit; }
echo "case,grid,norm,level,value,order,bar,verdict
cube,grid,norm,3,1,1.9,<= 2; order >= 1.8,pass" > "$2"
PROGRAM
chmod +x "$directory"/?d/convergence

# expect STATUS TEXT ARGUMENT...: of a run, TEXT being in its last line
expect() {
  local status text=$2 wanted=$1
  shift 2
  CASE_TIMEOUT=1 "$root/tests/convergence/run.sh" "$@" > output 2>&1
  status=$?
  [ "$status" -eq "$wanted" ] &&
    tail -n 1 output | grep -q -- "$text" && return
  complain "run.sh $*: status $status, not $wanted, or not '$text'"
}

expect 0 "2 cases, 2 rows, 2 within their bars, 0 failed" "$directory" good cube
expect 1 "9 cases, 13 rows, 5 within their bars, 7 failed" "$directory"
for name in bad bare dies slow cut quiet early; do
  expect 1 ", 1 failed" "$directory" "$name"
done
expect 2 "there is no case nothing" "$directory" good nothing
rm "$directory/3d/convergence"
expect 2 "not built" "$directory" good

[ "$failures" -eq 0 ]
