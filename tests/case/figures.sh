#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/figure.py: a figure is drawn from runs that are made once, its table says
# which bars are kept, what does not exist is refused. Usage: figures.sh BUILD
. "$(dirname "$0")/common.bash"
find_python

draw() {
  timeout "$limit" "$python" "$root/tools/figure.py" --talus "$build/talus" \
    "$@" > output 2>&1
}

# Three runs of a second in all, on a coarse grid.
coarse="--cells 4 -o out"
draw valette_2019 13 $coarse || complain "figure 13 is not drawn"
for name in fig13.png fig13.csv runs/sensitivity-a1.42-I04-cells4/series.csv; do
  [ -s "out/$name" ] || complain "there is no $name"
done
grep -q '^exponent, a = 1.42  *0.1[0-9]*  0.11$' output ||
  complain "the table has no exponent beside the paper's"
grep -q '^"exponent, a = 1.42",0.1[0-9]*,0.11,,,$' out/fig13.csv ||
  complain "fig13.csv has no exponent"

# A figure that needs the same runs makes none.
find out/runs -name series.csv | sort | xargs sha256sum > before
touch before
draw valette_2019 12 $coarse || complain "figure 12 is not drawn"
[ -z "$(find out/runs -newer before)" ] || complain "runs are made twice"

# Words for all runs reach them.
draw lagree_staron_popinet_2011 14e $coarse regularisation=exact cfl=0.6 ||
  complain "figure 14e is not drawn"
grep -q '^solver.advection,off,' \
  out/runs/column-a6.26-advectionoff-cells4/parameters.csv ||
  complain "advection is not switched off"
[ "$(grep -l '^solver.cfl,0.6,' out/runs/column-*/parameters.csv | wc -l)" -eq 2 ] ||
  complain "cfl does not reach the runs"

# A paper of another model.
draw lee_huang_chiew_2015 8 --cells 4 -o lee ||
  grep -q 'MISSED' output || complain "figure 8 is not drawn"
[ -s lee/fig8.png ] || complain "there is no lee/fig8.png"

# A matrix of cases, of which words choose some; a run may fail.
draw busch_johansen_2020 4 6 x_0=0.1 d=1e-3 a=1 stop=0.1 --cells 4 -o busch ||
  grep -q 'MISSED' output || complain "figures 4 and 6 are not drawn"
grep -q '^St of 1 mm in air  *556.3 .*kept$' output ||
  complain "figure 4 has no Stokes number"
grep -q '^runs that failed  *0 .*kept$' output || complain "runs failed"
[ "$(wc -l < busch/fig6-runs.csv)" -eq 2 ] ||
  complain "words do not choose one of the cases"
[ -s busch/fig4.png ] && [ -s busch/fig6.png ] || complain "there is no picture"
draw busch_johansen_2020 A.5 x_0=0.1 d=1e-3 stop=0.1 --cells 4 -o busch ||
  complain "figure A.5 is not drawn"
[ "$(ls busch/runs | wc -l)" -eq 1 ] || complain "figures share no run"
draw busch_johansen_2020 6 x_0=0.3 --cells 4 -o busch &&
  complain "a length that is not in the matrix is taken"

draw valette_2019 99 && complain "figure 99 is drawn"
grep -q "there is no figure '99'; those of the paper are 5, 6, " output ||
  complain "figure 99 is not refused"
draw nobody_2000 1 && complain "a paper that is not there is taken"
draw valette_2019 13 --cells 3 && complain "3 cells are taken"
draw valette_2019 || complain "figures are not listed"
grep -q '^  14  run-out against' output || complain "figure 14 is not listed"

# Bars, and what a missed one means.
cat > check.py << 'PYTHON'
import math
import pathlib
import sys

sys.path.insert(0, sys.argv[1])
import figure
from papers import study
import matplotlib.pyplot as plt

rows = [study.Row("x", 1.05, "1", study.within(1, 0.05)),
        study.Row("y", 1.06, "1", study.within(1, 0.05)),
        study.Row("z", math.nan, "1", (0, math.inf)), study.Row("w", 3)]
assert [row.verdict() for row in rows] == ["kept", "MISSED", "MISSED", ""]
assert study.around(2, 0.1) == (1.8, 2.2)
lines = study.table_text(rows)
assert lines[0].split() == ["quantity", "ours", "paper", "lowest", "highest",
                            "bar"], lines
assert len({line.index("1  ") for line in lines[1:3]}) == 1, lines
s = study.Study(None, pathlib.Path("."), None, [])
s.begin("0", "a figure")
s.finish(study.make_panels(2, 2)[0], rows)
assert s.missed == 2 and pathlib.Path("fig0.png").stat().st_size > 1000
PYTHON
timeout "$limit" "$python" check.py "$root/tools" > output 2>&1 ||
  complain "tables of bars are wrong"
exit $((failures > 0))
