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
