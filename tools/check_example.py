#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs an example at low resolution and compares it with its `expect` table.

    tools/check_example.py BUILD examples/NAME.lua

The table stands at the end of the case. `run` is what the command line gets in
addition; every other key is a column of series.csv with the lowest and the
highest value its last row may have:

    expect = {
      run = "level=6 stop=2",
      front = { 4.1, 4.5 },
    }

Ends with status 1 and one line per value outside its range.
"""
import csv
import pathlib
import re
import subprocess
import sys

NUMBER = r"([-+.\deE]+)"


def read_expect(text):
    """Returns (arguments of the run, {column: (low, high)}) of a case."""
    text = re.sub(r"--[^\n]*", "", text)
    match = re.search(r"\bexpect\s*=\s*\{((?:[^{}]|\{[^{}]*\})*)\}", text)
    if match is None:
        sys.exit("the case has no expect table")
    body = match.group(1)
    run = re.search(r"""\brun\s*=\s*["']([^"']*)["']""", body)
    ranges = re.findall(
        rf"(\w+)\s*=\s*\{{\s*{NUMBER}\s*,\s*{NUMBER}\s*\}}", body)
    if not ranges:
        sys.exit("the expect table names no column of series.csv")
    return (run.group(1).split() if run else [],
            {name: (float(low), float(high)) for name, low, high in ranges})


def last_row(directory):
    with open(directory / "series.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))[-1]


def main():
    build, case = map(pathlib.Path, sys.argv[1:3])
    arguments, ranges = read_expect(case.read_text(encoding="utf-8"))
    directory = build / "examples" / case.stem
    directory.parent.mkdir(exist_ok=True)
    subprocess.run([build / "talus", "run", case, *arguments, "--quiet", "-o",
                    directory], check=True)
    row = last_row(directory)
    wrong = 0
    for name, (low, high) in ranges.items():
        if name not in row:
            sys.exit(f"series.csv has no column {name}")
        if not low <= float(row[name]) <= high:
            print(f"{name} is {row[name]}, expected {low:g} to {high:g}")
            wrong = 1
    return wrong


if __name__ == "__main__":
    sys.exit(main())
