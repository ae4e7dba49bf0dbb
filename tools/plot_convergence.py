#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints report.csv of tests/convergence as a table."""
import csv
import sys

with open(sys.argv[1], newline="", encoding="utf-8") as f:
    for row in csv.reader(f):
        print(("{:<18} {:<22} {:<24} {:>5} {:>12} {:>6} {:<24} {}"
               .format(*row)).rstrip())
