#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times a fixed set of runs and parts of Talus, and Gerris beside it.

    tools/bench.py BUILD [NAME ...]

Every job runs once to warm up, then REPEATS times, the jobs in turn so that a
busy machine slows all alike. Prints medians; BUILD/bench.csv has one row per
job: name, leaves, steps, median, least and most seconds, nanoseconds and steps
per cell, iterations, bytes per cell, and what part of the run each stage took.
A name is a job of JOBS or a word that begins some. Where gerris2D can compile
its functions, the collapse runs with it too, and the ratio is printed.
"""
import csv
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
REPEATS = 5

# Whole runs: name -> (program, case and what the command line gets).
RUNS = {
    "column 9": ("talus2d", "examples/column.lua level=9"),
    "column 10": ("talus2d", "examples/column.lua level=10"),
    "column 11": ("talus2d", "examples/column.lua level=11"),
    "cavity 8": ("talus2d", "tests/bench/cavity.lua --max-steps 100"),
    "box3d 7": ("talus3d", "examples/box3d.lua level=7 regularisation=clip "
                "--max-steps 60"),
    "bed 7": ("talus2d", "tests/bench/bed.lua level=7 --max-steps 100"),
    "bed 10": ("talus2d", "tests/bench/bed.lua level=10 --max-steps 5"),
    "bed3d 7": ("talus3d",
                "tests/bench/bed.lua dimension=3 level=7 --max-steps 3"),
}
# Parts alone (tests/bench/main.c): name -> (dimension, arguments).
PARTS = {
    "vof 9": (2, "vof 9 20"),
    "poisson 10": (2, "poisson 10 4"),
    "viscous 10": (2, "viscous 10 2"),
    "adaptation 11": (2, "adaptation 11 20"),
    "vof3d 6": (3, "vof 6 10"),
    "poisson3d 7": (3, "poisson 7 2"),
    "viscous3d 7": (3, "viscous 7 1"),
    "adaptation3d 7": (3, "adaptation 7 3"),
}
GERRIS = {"gerris column 9": 9, "gerris column 10": 10}
SLOW = {"column 11": 2, "gerris column 10": 2}  # repeats of long ones

STAGES = ["start", "volume fraction", "density, gravity", "rheology",
          "advection", "viscous solve", "pressure", "adaptation", "other",
          "tables", "snapshots", "checkpoints"]
COLUMNS = ["name", "leaves", "steps", "seconds", "least", "most",
           "ns_per_cell", "cell_steps_per_second", "iterations",
           "bytes_per_cell"] + STAGES


def environment():
    """Open MPI refuses root, and containers, unless told otherwise."""
    return dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1",
                OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                OMPI_MCA_btl_vader_single_copy_mechanism="none")


def time_run(build, name):
    """One whole run: {column: value}."""
    program, arguments = RUNS[name]
    directory = build / "bench" / name.replace(" ", "-")
    begin = time.monotonic()
    result = subprocess.run(
        [build / program, "run", *arguments.split(), "--timing", "-o",
         directory], capture_output=True, text=True, cwd=ROOT,
        env=environment())
    expected = 5 if "--max-steps" in arguments else 0  # stopped, finished
    if result.returncode != expected:
        sys.exit(f"{name}: exit status {result.returncode}\n{result.stderr}")
    row = {"seconds": time.monotonic() - begin}
    row["leaves"] = int(re.search(r": (\d+) cells on", result.stdout)[1])
    row["steps"] = int(re.search(r"(\d+) steps in", result.stdout)[1])
    row["ns_per_cell"] = float(
        re.search(r"per cell and step +(\d+)", result.stdout)[1])
    row["cell_steps_per_second"] = 1e9 / row["ns_per_cell"]
    row["bytes_per_cell"] = int(
        re.search(r"memory per cell +(\d+)", result.stdout)[1])
    for stage in STAGES:
        row[stage] = float(re.search(
            rf"^ +{stage}[^%]* s +([\d.]+) %", result.stdout, re.M)[1])
    return row


def time_part(build, name):
    dimension, arguments = PARTS[name]
    program = build / f"{dimension}d" / "bench"
    output = subprocess.run([program, *arguments.split()], check=True,
                            capture_output=True, text=True, cwd=ROOT,
                            env=environment()).stdout
    leaves, iterations, seconds = output.split(",")
    row = {"leaves": int(leaves), "iterations": int(iterations),
           "seconds": float(seconds)}
    row["ns_per_cell"] = 1e9 * row["seconds"] / row["leaves"]
    row["cell_steps_per_second"] = row["leaves"] / row["seconds"]
    return row


def time_gerris(build, name):
    directory = build / "bench" / "gerris"
    directory.mkdir(parents=True, exist_ok=True)
    begin = time.monotonic()
    subprocess.run(["gerris2D", "-m", f"-DLEVEL={GERRIS[name]}", "-DEND=5.8",
                    ROOT / "tests/bench/column.gfs"], check=True,
                   cwd=directory, capture_output=True)
    return {"seconds": time.monotonic() - begin}


def gerris_works(build):
    """Gerris compiles the functions of a case with its development files."""
    if shutil.which("gerris2D") is None:
        return False
    directory = build / "bench" / "gerris"
    directory.mkdir(parents=True, exist_ok=True)
    test = subprocess.run(
        ["gerris2D", "-m", "-DLEVEL=5", "-DEND=0.01",
         ROOT / "tests/bench/column.gfs"], cwd=directory, capture_output=True)
    return test.returncode == 0


def measure(build, names):
    """{name: [row of each repeat]}."""
    rows = {name: [] for name in names}
    for turn in range(REPEATS + 1):
        for name in names:
            if turn > SLOW.get(name, REPEATS):
                continue
            call = (time_run if name in RUNS else
                    time_part if name in PARTS else time_gerris)
            row = call(build, name)
            if turn > 0:  # the first one warms up
                rows[name].append(row)
        print(f"round {turn} of {REPEATS} done", file=sys.stderr)
    return rows


def summarise(name, repeats):
    """Medians of the columns of one job."""
    row = {key: statistics.median(r[key] for r in repeats)
           for key in repeats[0]}
    seconds = [r["seconds"] for r in repeats]
    row.update(name=name, least=min(seconds), most=max(seconds))
    return row


def show(rows):
    print(f"{'':16}{'leaves':>9}{'steps':>6}{'seconds':>10}{'ns/cell':>9}"
          f"{'1e6 cells/s':>12}{'iterations':>11}{'bytes/cell':>11}")
    for row in rows:
        cells = row.get("cell_steps_per_second")
        print(f"{row['name']:16}{row.get('leaves', ''):>9}"
              f"{row.get('steps', ''):>6}{row['seconds']:10.4g}"
              + (f"{row['ns_per_cell']:9.0f}{cells / 1e6:12.2f}"
                 if cells else f"{'':21}")
              + f"{row.get('iterations', ''):>11}"
              f"{row.get('bytes_per_cell', ''):>11}")
    staged = [row for row in rows if STAGES[0] in row]
    if staged:
        print("\nparts of a run, %")
        print(f"{'':16}" + "".join(f"{s.split()[0].strip(',')[:10]:>11}"
                                   for s in STAGES))
    for row in staged:
        print(f"{row['name']:16}"
              + "".join(f"{row[s]:11.1f}" for s in STAGES))
    times = {row["name"]: row["seconds"] for row in rows}
    for name in GERRIS:
        ours = name.removeprefix("gerris ")
        if name in times and ours in times:
            print(f"\n{ours}: Gerris takes {times[name] / times[ours]:.1f} "
                  "times as long")


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    known = [*RUNS, *PARTS]
    if gerris_works(build):
        known += GERRIS
    else:
        print("without Gerris: install gerris and libgfs-dev to compare",
              file=sys.stderr)
    names = [name for name in known if len(sys.argv) == 2
             or any(name.startswith(word) for word in sys.argv[2:])]
    if not names:
        sys.exit("no such job; known: " + ", ".join(known))
    rows = [summarise(name, repeats)
            for name, repeats in measure(build, names).items()]
    show(rows)
    with open(build / "bench.csv", "w", newline="", encoding="utf-8") as f:
        writer = csv.DictWriter(f, COLUMNS, restval="")
        writer.writeheader()
        writer.writerows(rows)
    print(f"\n{build.name}/bench.csv has the rest")


if __name__ == "__main__":
    main()
