#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds circles: files of src/ and tree/ that need one another to be linked.

    tools/check_circles.py BUILD

reads the symbols of the objects in BUILD/2d. Prints each circle, file by file
with the functions it calls, and ends with status 1 if there is one.
"""
import pathlib
import subprocess
import sys


def read_symbols(path):
    """Symbols that an object defines, and those that it needs."""
    defined, needed = set(), set()
    lines = subprocess.run(["nm", "-P", str(path)], check=True,
                           capture_output=True, text=True).stdout.split("\n")
    for line in lines:
        name, kind = (line.split() + ["", ""])[:2]
        if kind == "U":
            needed.add(name)
        elif kind in set("TDRBC"):
            defined.add(name)
    return defined, needed


def reachable(calls, start):
    """Files that `start` needs, directly or not."""
    seen, todo = set(), [start]
    while todo:
        for other in calls[todo.pop()]:
            if other not in seen:
                seen.add(other)
                todo.append(other)
    return seen


def main():
    root = pathlib.Path(sys.argv[1]) / "2d"
    symbols = {str(p.relative_to(root))[:-2]: read_symbols(p)
               for folder in ("src", "tree")
               for p in sorted((root / folder).rglob("*.o"))
               if pathlib.Path(str(p.relative_to(root))[:-1] + "c").exists()}
    owner = {s: name for name, (defined, _) in symbols.items() for s in defined}
    calls = {name: {owner[s] for s in needed if s in owner} - {name}
             for name, (_, needed) in symbols.items()}
    needs = {name: reachable(calls, name) for name in calls}
    circles = {frozenset(other for other in needs[name]
                         if name in needs[other])
               for name in calls if name in needs[name]}
    for circle in circles:
        print("files that need one another:")
        for name in sorted(circle):
            functions = sorted(s for s in symbols[name][1]
                               if owner.get(s, name) in circle - {name})
            print(f"  {name}.c calls {', '.join(functions)}")
    return 1 if circles else 0


if __name__ == "__main__":
    sys.exit(main())
