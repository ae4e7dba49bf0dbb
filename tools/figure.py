#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws figures of a paper from runs of our own, its numbers beside ours.

  tools/figure.py PAPER [FIGURE ...] [name=value ...] [-o DIR] [--cells N]
                  [--talus build/talus]

PAPER is a module of tools/papers (busch_johansen_2020,
lagree_staron_popinet_2011, lee_huang_chiew_2015, valette_2019); without a FIGURE
its figures are listed, `all` draws all. The case is run as often as the figure needs, N cells to the
half-width of the column (default: as the figure says); name=value holds for all
runs, as in strip=0. DIR (default: PAPER.out) gets one directory per run, in
`runs`, and for each figure
  figNAME.png  the figure
  figNAME.csv  its table: quantity, ours, the paper's, lowest and highest
               value allowed where there is a bar, and whether it is kept
The table is printed too. A run that is there with the same parameters is not
repeated, one that was stopped before its end (Ctrl-C) is continued; figures
share runs. Ends with status 1 if a bar is missed.
"""
import argparse
import importlib
import pathlib
import sys

import run_data  # noqa: F401, first: it says so if matplotlib is missing
import run_cases
from papers.study import Study

PAPERS = sorted(path.stem for path in
                (pathlib.Path(__file__).parent / "papers").glob("*_[0-9]*.py"))


def parse_options():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("paper", metavar="PAPER", choices=PAPERS)
    parser.add_argument("words", metavar="FIGURE", nargs="*",
                        help="its number, `all`, or name=value for all runs")
    parser.add_argument("-o", "--output", metavar="DIR", type=pathlib.Path,
                        help="where to run and draw, default PAPER.out")
    parser.add_argument("--cells", metavar="N", type=int,
                        help="to the half-width of a column, a power of two")
    parser.add_argument("--talus", type=pathlib.Path, default=run_cases.TALUS,
                        help="the program, default that of build/")
    return parser.parse_intermixed_args()


def check_cells(cells):
    if cells is not None and (cells < 1 or cells & (cells - 1)):
        run_cases.fail(f"--cells {cells}: a power of two is needed")


def chosen(paper, words):
    """The figures among the words."""
    names = [w for w in words if "=" not in w]
    if "all" in names:
        return list(paper.FIGURES)
    for name in names:
        if name not in paper.FIGURES:
            run_cases.fail(f"there is no figure '{name}'; those of the paper "
                           f"are {', '.join(paper.FIGURES)}")
    return names


def main():
    options = parse_options()
    check_cells(options.cells)
    paper = importlib.import_module(f"papers.{options.paper}")
    names = chosen(paper, options.words)
    if not names:
        for name, (title, _) in paper.FIGURES.items():
            print(f"{name:>4}  {title}")
        return 0
    study = Study(run_cases.check_program(options.talus),
                  options.output or pathlib.Path(f"{options.paper}.out"),
                  options.cells, [w for w in options.words if "=" in w])
    for name in names:
        title, draw = paper.FIGURES[name]
        study.begin(name, title)
        draw(study)
    return 1 if study.missed else 0


if __name__ == "__main__":
    sys.exit(main())
