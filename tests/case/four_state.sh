#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs of model = "four_state": restart bit for bit, the same on three ranks,
# wrong cases refused, a start that bursts. Usage: four_state.sh BUILD
. "$(dirname "$0")/common.bash"
talus=$build/talus
column="$root/examples/four_state_column.lua level=6"

restarts whole 17 $column stop=0.6
ends 0 mpirun --oversubscribe -n 3 "$build/talus2d" run $column stop=0.6 \
  -o ranks --quiet
# fronts differ by less than the solvers' tolerance lets through, 1e-6 m; that of
# a contour leaps where a leaf passes it
awk -v a="$(last whole grain_front)" -v b="$(last ranks grain_front)" \
  'BEGIN { d = a - b; exit !(d < 1e-6 && d > -1e-6) }' ||
  complain "three ranks have another front"

# the stress of an exact yield is kept: restart, ranks, yield_state in snapshots
restarts exact 17 $column regularisation=exact stop=0.6
ends 0 mpirun --oversubscribe -n 3 "$build/talus2d" run $column \
  regularisation=exact stop=0.6 -o exact_ranks --quiet
grep -aq yield_state exact/snapshot-000001.h5 ||
  complain "snapshots do not carry yield_state"
ends 2 "$talus" check $column regularisation=exat
says '"exponential" or "exact"'

# rings: restart, ranks, and a quarter of the cylinder in three dimensions
cylinder="$root/examples/four_state_cylinder.lua"
restarts exact_rings 17 $cylinder cells=4 stop=0.6 regularisation=exact
restarts exact_3d 17 $cylinder cells=4 stop=0.3 regularisation=exact dimension=3
cylinder="$cylinder cells=8 stop=2"
restarts rings 17 $cylinder
ends 0 mpirun --oversubscribe -n 3 "$build/talus2d" run $cylinder \
  -o rings_ranks --quiet
ends 0 mpirun --oversubscribe -n 2 "$build/talus3d" run $cylinder dimension=3 \
  -o quarter --quiet
# close A B COLUMN BOUND: the last rows agree within this part
close() {
  awk -v a="$(last "$1" "$3")" -v b="$(last "$2" "$3")" -v most="$4" \
    'BEGIN { d = a / b - 1; exit !(d < most && -d < most) }' ||
    complain "$1 and $2 differ in $3"
}
close exact exact_ranks grain_front 1e-5
close rings rings_ranks grain_front 1e-5
close rings quarter grain_front 0.04
close rings quarter height 0.04

sed 's/top = "slip"/top = { "outflow", pressure = 0 }/' \
  "$root/examples/four_state_column.lua" > open.lua
ends 2 "$talus" run open.lua level=5 -o open
says 'has no inflow and no outflow'
ends 2 "$talus" check $column nu_min=0.61
says 'nu_min < nu_0 < nu_max is needed (nu_min = 0.61, nu_0 = 0.6'
ends 0 "$talus" check $column n=1e4
says 'creep' && says '2 ln(100)/n = 0.000921/s'
ends 2 "$talus" check $column n=1e4 regularisation=exact
says 'n = 10000 has no meaning with regularisation = "exact"'
ends 2 "$talus" check $column eta_S=-1
says 'eta_S'
sed 's/rho_d = param/density = 1, rho_d = param/' \
  "$root/examples/four_state_column.lua" > density.lua
ends 2 "$talus" check density.lua
says 'density'
# another gravity on restart is a change of energy, and no loss of the scheme
cp -r whole_parts turned
sed 's/gravity = .*/gravity = { 0, -2 * g },/' \
  "$root/examples/four_state_column.lua" > heavy.lua
ends 5 "$talus" run heavy.lua level=6 stop=0.8 reference= -o turned --quiet \
  --restart --max-steps 1
books whole_parts turned numerical

# a tolerance below round-off asks for no more than that
ends 5 "$talus" run $column tolerance=1e-16 -o exactly --quiet --max-steps 3

# starts that cannot be, and one that would never end
ends 2 "$talus" run $column K=1e5 stop=0.5 -o soft --quiet
says 'begin at a solid fraction of .*nu_0 = 0.6 .*larger grains.K'
ends 2 "$talus" run $column start=uniform nu_start=0.64 stop=0.5 -o soft --quiet
says 'begin at a solid fraction of 0.64, .*smaller grains.nu_start'
sed 's/  boundary =/  velocity = { 1e20, 0 },\n&/' \
  "$root/examples/four_state_column.lua" > wind.lua
ends 3 "$talus" run wind.lua level=5 reference= -o wind --quiet
says 'gave up after step .*, with which it would never end'
# no grains are told of; a box full of them is in balance, with gravity or none
sed 's/shape = .*/shape = function(x, y) return -1 end,/' \
  "$root/examples/four_state_column.lua" > none.lua
ends 0 "$talus" run none.lua level=5 stop=0.1 reference= -o none --quiet
says 'there are no grains'
grep -v 'shape = ' "$root/examples/four_state_column.lua" > full.lua
sed 's/gravity = .*/gravity = { 0, 0 },/' "$root/examples/four_state_column.lua" \
  > floats.lua
for name in full floats; do
  ends 0 "$talus" run $name.lua level=5 stop=1 reference= -o $name --quiet
  awk -F, 'END { exit !($16 < 1e-6) }' $name/series.csv ||
    complain "$name: grains at rest move"
done
# the foot of a loose column is packed towards nu_0 as it settles: steps in which
# it would burst are shortened, and energy is not made
ends 0 "$talus" run "$root/examples/four_state_column.lua" level=7 chi=4 \
  start=uniform stop=1 -o soft --quiet
grep -q 'grains burst' soft/run.log ||
  complain "run.log does not say that steps burst"
awk -F, 'NR > 1 { energy = $10 + $11 + $12 + $13 + $14
                  if (NR == 2) first = energy
                  if (energy > 1.1 * first) bad = 1 } END { exit bad }' \
  soft/series.csv || complain "a foot that is packed makes energy"
ends 0 "$talus" run $column K=1e10 start=uniform stop=0.01 -o pressed --quiet
says 'times their weight, and burst'
ends 0 "$talus" run $column start=uniform stop=0.01 -o plain --quiet
grep -q burst output && complain "a start that does not burst is warned of"

[ "$failures" -eq 0 ]
