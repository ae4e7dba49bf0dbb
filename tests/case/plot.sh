#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Snapshots are what their XDMF index says, pictures and film are made, and
# outlines are compared as documented. Usage: plot.sh BUILD
. "$(dirname "$0")/common.bash"
export TALUS_TOOLS=$root/tools
find_python

set -e
timeout "$limit" "$build/talus2d" run "$root/examples/column.lua" level=7 stop=3 \
  every=0.5 times=0.66,0.95 -o column --quiet
timeout "$limit" mpirun --oversubscribe -n 2 "$build/talus3d" run \
  "$root/examples/box3d.lua" level=4 stop=0.5 -o box --quiet

# Index and files agree; every cell is there; the cells fill the box.
cat > check.py << 'PYTHON'
import sys
import xml.etree.ElementTree as xml
import h5py
import numpy as np

directory, dimension, volume = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
grids = xml.parse(f"{directory}/snapshots.xdmf").getroot().findall(
    "Domain/Grid/Grid")
times = [float(g.find("Time").get("Value")) for g in grids]
assert len(times) > 1 and times == sorted(set(times)), times
for grid in grids:
    for item in grid.iter("DataItem"):
        name, path = item.text.split(":")
        with h5py.File(f"{directory}/{name}") as f:
            size = [int(n) for n in item.get("Dimensions").split()]
            assert list(f[path].shape) == size, (name, path)
            assert f[path].dtype.itemsize == int(item.get("Precision")), path
            assert f[path].attrs["unit"] and f[path].attrs["title"], path
with h5py.File(f"{directory}/{name}") as f:
    assert f.attrs["version"] and f.attrs["time"] == times[-1]
    assert f["parameters"].attrs["gravity"]
    x, cells = f["vertices"][:], f["cells"][:]
    assert cells.max() == len(x) - 1
    edge = x[cells].max(axis=1) - x[cells].min(axis=1)
    assert abs(np.prod(edge, axis=1).sum() / volume - 1) < 1e-12
    assert np.allclose(edge, edge[:, :1])
    # corners of a quadrilateral or hexahedron in the order of XDMF and VTK
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corner += [(a, b, 1) for a, b, _ in corner]
    low = x[cells].min(axis=1)[:, None]
    exact = low + edge[:, None] * np.array(corner)[:2**dimension, :dimension]
    assert np.allclose(x[cells], exact)
    assert f["velocity"].shape == (len(cells), 3)
    assert 0 < (f["fraction"] * np.prod(edge, axis=1)).sum() < volume
PYTHON
"$python" check.py column 2 1024
edge=$(sed -n 's/^domain.size,\([^,]*\),.*/\1/p' box/parameters.csv)
"$python" check.py box 3 "$(awk -v e="$edge" 'BEGIN { print e^3 }')"

# made DIRECTORY NAME...: pictures that the last `talus plot` has named and signed
made() {
  local where=$1 name
  shift
  for name in "$@"; do
    grep -q "^$where/$name$" output || { echo "$where: no $name"; exit 1; }
    [ "$(wc -c < "$where/$name")" -gt 5000 ] || { echo "$where/$name is small"; exit 1; }
    grep -qa "talus plot" "$where/$name" || { echo "$where/$name is not signed"; exit 1; }
  done
}
for run in column box; do
  timeout "$limit" "$build/talus" plot $run > output
  made $run outlines.png fields-final.png history.png film.gif
done
# In 3D the heap too, by VTK where it is installed and has a display, else by
# matplotlib, which everybody may ask for.
made box plan.png heap.png
if { "$python" -c 'import vtk
w = vtk.vtkRenderWindow()
w.SetOffScreenRendering(True)
w.Render()'; } 2> /dev/null; then
  timeout "$limit" "$build/talus" plot box --renderer matplotlib -o asked > output
  made asked plan.png heap.png film.gif
fi
cat > heaps.py << 'PYTHON'
import pathlib
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
import heap
import run_data
import surface
from sheet import RunWords

# the part z < 0.3 of a ball about a corner: a quarter of the whole one
n = 40
x = (np.arange(n) + 0.5) / n
r = np.sqrt(x[:, None, None]**2 + x[:, None]**2 + x**2)
c = np.clip(0.5 + n * (0.8 - r), 0, 1)[:, :, :12]
raster = surface.Raster(np.zeros(3), 1 / n, c, r[:, :, :12])
for axis in range(2):
    raster = surface.mirror(raster, axis)
found = surface.surface_of(raster)
p = found.triangles
exact = np.pi * (0.3 * 0.8**2 - 0.3**3 / 3)
volume = np.einsum("ij,ij->i", p[:, 0], surface.normals(p)).sum() / 6
assert abs(volume / exact - 1) < 0.02, volume / exact
# closed: every edge is passed both ways
_, corner = np.unique(np.rint(1e7 * p.reshape(-1, 3)), axis=0,
                      return_inverse=True)
corner = corner.reshape(-1, 3)
edges = np.concatenate([corner[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
there, back = (np.unique(e, axis=0, return_counts=True)
               for e in (edges, edges[:, ::-1]))
assert all(np.array_equal(a, b) for a, b in zip(there, back))
side = np.abs(p[..., 2].mean(axis=1) - 0.15) < 0.1
assert abs(found.speed[side].mean() - 0.8) < 0.05, found.speed[side].mean()
# what is seen of it: all in the picture
view = heap.View([-1, 1, -1, 1], 0, 0.3)
seen = view.project(p.reshape(-1, 3))
assert (seen > view.low).all() and (seen < view.high).all()
# a run: the plan holds the volume, the surface stands on the floor
directory = pathlib.Path("box")
plan = heap.read_plans(directory)[-1]
volume = run_data.read_series(directory)["volume"][-1]
spacing = plan.x[1] - plan.x[0]
assert abs(plan.height.sum() * spacing**2 / volume - 1) < 1e-6
snapshot = run_data.Snapshot(run_data.find_snapshots(directory)[-1])
parts = surface.raster_of(snapshot, [False, False], 99)
assert abs(parts.fraction.sum() * parts.spacing**3 / volume - 1) < 1e-3
coarse = surface.raster_of(snapshot, [True, True], 4)
assert coarse.spacing > parts.spacing
assert abs(coarse.fraction.sum() * coarse.spacing**3 / volume / 4 - 1) < 1e-3
run = RunWords(run_data.read_parameters(directory), directory)
assert heap.Scene(run, [snapshot], "matplotlib").mirrors == [True, True]
PYTHON
"$python" heaps.py "$root/tools"
# The pictures of a run that is replaced go with it.
cp -r column replaced
"$build/talus2d" run "$root/examples/column.lua" level=5 stop=0.1 -o replaced \
  --quiet > output 2>&1
if ls replaced/*.png replaced/*.gif 2> /dev/null; then exit 1; fi
# A strip of a layer is too narrow for a title, and its surface is level.
timeout "$limit" "$build/talus" run "$root/examples/bagnold.lua" stop=1 trees=4 \
  -o layer --quiet
timeout "$limit" "$build/talus" plot layer > output 2>&1
if grep -q "^layer/outlines" output; then
  echo "a level surface was drawn as a heap"
  exit 1
fi
# Without grains there is little to draw, and two layers have their legend.
sed 's/return math.min(width - x, height - y)/return -1/
  s/  tracers = {/&\n    floor = function(x, y) return 1 - y end,/' \
  "$root/examples/column.lua" > empty.lua
timeout "$limit" "$build/talus" run empty.lua level=5 stop=0.1 -o empty --quiet \
  2> output
timeout "$limit" "$build/talus" plot empty > output 2>&1
grep -q "no history.png, as there are no grains" output || {
  echo "an empty box:"
  cat output
  exit 1
}
grep -q "^empty/fields-final.png$" output || { echo "no picture"; exit 1; }
head -n 1 empty/profile.csv | grep -qx "time,x,height,core,floor" || {
  echo "the tracers are not in profile.csv"
  exit 1
}
"$python" -c '
import matplotlib.image
assert matplotlib.image.imread("layer/fields-final.png").shape[1] > 700'
if "$build/talus" plot nowhere 2> output; then
  echo "a run that is not there was drawn"
  exit 1
fi

# Closures: a picture, and beside it the curves as they were printed.
"$python" "$root/tools/plot_closure.py" mu_i "lee_huang p=1000" -o curves.png \
  --talus "$build/talus" > output
[ "$(wc -c < curves.png)" -gt 5000 ] || { echo "curves.png is small"; exit 1; }
for curve in "0 mu_i" "1 lee_huang p=1000"; do
  number=${curve%% *}
  # shellcheck disable=SC2086
  rows=$("$build/talus" rheology ${curve#* } --csv | tail -n +2 | wc -l)
  [ "$(grep -c "^$number," curves.csv)" -eq "$rows" ] || {
    echo "curves.csv: curve $number has not $rows rows"
    exit 1
  }
done

# Outlines: known areas, then the run itself.
cat > compare.py << 'PYTHON'
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
import run_data

x = np.linspace(0.05, 9.95, 100)
h = np.maximum(0, 4 - x)
# the same outline, and one that is only higher by a factor
assert run_data.compare(x, h, x, h)[0] < 1e-12
difference, scale = run_data.compare(x, h, x, 2 * h)
assert difference < 1e-12 and abs(scale - 0.5) < 1e-12
# two boxes of equal area, moved by a quarter of their width
a = ((x > 1) & (x < 5)).astype(float)
b = ((x > 2) & (x < 6)).astype(float)
assert abs(run_data.compare(x, a, x, b)[0] - 0.5) < 1e-3
# what the axes say
units = run_data.Units({"gravity": "0.6,-0.8", "length_unit": "$30\\,d$"})
assert units.field("m/s") == r"$\sqrt{g\,30\,d}$", units.field("m/s")
assert units.field("Pa s") == r"$\rho\sqrt{g\,(30\,d)^3}$"
assert run_data.Units({"gravity": "0,-9.81"}).field("m/s") == "m/s"
assert run_data.symbol("mu_s") == r"$\mu_{s}$"
assert run_data.symbol("delta_mu") == r"$\Delta\mu$"
assert run_data.symbol("I0") == "$I_{0}$"
assert run_data.symbol("level") == "level"
lines = run_data.title_lines({"title": "one two  $a = 3$ four"}, ".", 9)
assert lines == ["one two", "$a = 3$", "four"], lines
assert run_data.title_lines({"title": r"5 $ or $\no$"}, ".", 99) == [
    r"5 \$ or \$\no\$"]
assert run_data.title_lines({}, "/some/run.out", 99) == ["run.out"]
column = run_data.read_profiles("column")
assert [p.time for p in column] == sorted(p.time for p in column)
core = column[0].layers["core"]
assert list(column[0].layers) == ["core"] and 0 < core.max() < 6, core
assert (core <= column[0].height).all()
profiles = [(t, x, h) for t in (1, 5.7, 5.8)]
assert len(run_data.without_repeat(profiles)) == 2
assert len(run_data.without_repeat(profiles[:2])) == 2
assert abs(run_data.parse_scale("sqrt(6.25)", {}) - 2.5) < 1e-12
assert abs(run_data.parse_scale(None, {"a": "4"}) - 2) < 1e-12
assert run_data.parse_scale(None, {"a": "4", "reference_time": "3"}) == 3
# a reference with a row per point; the second time has one point less
with open("points.csv", "w") as f:
    f.write("t_over_tau,x,height\n0,1,4\n0,2,3\n0.5,1,2\n")
points = run_data.Reference("points.csv")
assert list(points.at(0.5)) == [2, 0] and points.at(1) is None
PYTHON
"$python" compare.py "$root/tools"
# Without its libraries (-S: none but Python's own) a tool says what it needs.
for tool in plot plot_closure plot_state sweep compare_outline; do
  if "$python" -S "$root/tools/$tool.py" 2> output ||
      [ "$(wc -l < output)" -ne 1 ] || ! grep -q "needs numpy" output; then
    echo "$tool without numpy:"
    cat output
    exit 1
  fi
done
# A snapshot that a full disk has cut short is named.
cp -r column torn
head -c 3000 column/snapshot-000001.h5 > torn/snapshot-000001.h5
if "$python" "$root/tools/plot.py" torn > output 2>&1 ||
    ! grep -q '^plot: torn/snapshot-000001.h5 cannot be read' output; then
  echo "a torn snapshot:"
  cat output
  exit 1
fi
"$python" "$root/tools/compare_outline.py" column --reference \
  "$root/examples/reference/contact_dynamics_a6.26.csv" > output
# level 7 is coarse; only far off if something is wrong
awk '$1 == "mean" { found = $2 < 0.25 } END { exit !found }' output || {
  cat output
  exit 1
}
