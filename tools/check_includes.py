#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Verifies the rules of layering that C cannot express.

1. A folder, tree/ or one of src/, includes only what SEES allows; a model is
   included by its own folder and by src/models.c only.
2. A foreign library is included by one folder, or by files named here.
3. A .c file includes its own header first.
4. `#if DIM` stands only in tree/ and geometry/ and in their headers.
5. exit, abort, assert, malloc and relatives are called in base/ only.
6. A file of C begins with its licence in one SPDX line.

A public header belongs to the folder of the .c of the same stem, those of
include/talus/NAME/ to the folder NAME; headers without a .c are in HEADER_ONLY.
Private headers belong to their folder. Prints
each violation as file:line: message and ends with status 1 if there are any.
"""
import pathlib
import re
import sys

import checker

# What each folder may include besides itself and standard C, from the bottom
# up. `params` is the plain description of a case that `case` fills and others
# read.
SEES = {
    "base": set(),
    "geometry": {"base"},
    "rheology": {"base"},
    "params": {"base", "rheology"},
    "tree": {"base", "geometry", "rheology"},
    "solver": {"base", "geometry", "rheology", "tree"},
    "case": {"base", "geometry", "rheology", "params"},
    "io": {"base", "tree", "params"},
}
SEES["grid"] = SEES["solver"] | {"solver", "params"}
SEES["flow"] = SEES["grid"] | {"grid"}
SEES["measure"] = SEES["flow"] | {"flow"}
SEES["models"] = SEES["measure"] | {"measure"}
MODELS = {"two_phase", "four_state", "two_fluid"}
SEES.update({model: SEES["models"] | {"models"} for model in MODELS})
SEES["command"] = SEES["models"] | {"models", "case", "io"}
# src/models.c lists the models.
LIST = "src/models.c"

# Public headers without a .c of their stem: stem -> owner.
HEADER_ONLY = {"minmax": "base", "params": "params", "solve": "solver",
               "hash": "base", "morton": "tree", "columns": "base",
               "scalars": "base", "stopwatch": "base", "poison": "base",
               "key": "base", "model": "models"}

# Foreign headers: pattern -> folders or files that may include them.
FOREIGN = {
    r"(p4est|p8est|sc)(_\w+)?\.h": {"tree"},
    r"(hdf5|H5\w*)\.h": {"io"},
    r"(lua|lualib|lauxlib)\w*\.h": {"case"},
    r"gsl/.*": {"src/rheology/roots.c"},
    r"check\.h": set(),
}

# MPI is for those who talk to other ranks; these folders are pure.
NO_MPI = {"geometry", "rheology"}

DIM_FOLDERS = {"tree", "geometry"}

FORBIDDEN = ("exit", "_exit", "_Exit", "quick_exit", "abort", "assert",
             "malloc", "calloc", "realloc", "aligned_alloc", "posix_memalign",
             "free", "strdup", "strndup")
# Files outside base/ that may call some of them, with the reason.
ALLOWED_CALLS = {
    "src/io/output.c": {"free"},  # what open_memstream allocated
}

INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^>"]+)[>"]')
IF_DIM = re.compile(r"\s*#\s*(el)?if.*\bDIM\b")
CALL = re.compile(r"(?<![\w.>])(" + "|".join(FORBIDDEN) + r")\s*\(")
SPDX = "/* SPDX-License-Identifier: GPL-3.0-or-later */"


def strip_comments(text):
    """Blanks comments, strings and character constants, keeps the lines."""
    token = re.compile(r'/\*.*?\*/|//[^\n]*|"(\\.|[^"\\\n])*"|'
                       r"'(\\.|[^'\\\n])*'", re.S)
    return token.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)


class Checker(checker.Checker):
    """Finds violations in the tree below `root`."""

    def __init__(self, root):
        super().__init__(root)
        self.folder_of_stem = dict(HEADER_ONLY)
        for path in root.glob("src/*.c"):
            self.folder_of_stem[path.stem] = path.stem
        for path in sorted([*root.glob("tree/*.c"), *root.glob("src/*/*.c")]):
            if path.parent.name not in MODELS:
                self.folder_of_stem.setdefault(path.stem, path.parent.name)

    def folder_of(self, path):
        """Name of the folder a file counts as; "?" if nothing says."""
        if path.parent.name == "talus":
            return self.folder_of_stem.get(path.stem, "?")
        return path.stem if path.parent.name == "src" else path.parent.name

    def check_own(self, path, line, folder, header):
        """An include of ours."""
        if header.endswith(".inc"):
            return  # written by the build
        if header.startswith("talus/"):
            if not (self.root / "include" / header).exists():
                return  # the compiler says so
            owner = self.folder_of(self.root / "include" / header)
        else:
            owner = (path.parent / header).resolve().parent.name
        if owner in MODELS and str(path.relative_to(self.root)) == LIST:
            return
        if owner == "?":
            self.complain(path, line, f"{header} belongs to no folder; name it"
                          " in HEADER_ONLY of tools/check_includes.py")
        elif owner != folder and owner not in SEES.get(folder, set()):
            self.complain(path, line, f"{folder} may not see {header}, which "
                          f"belongs to {owner}")

    def check_foreign(self, path, line, folder, header):
        name = str(path.relative_to(self.root))
        for pattern, allowed in FOREIGN.items():
            if not re.fullmatch(pattern, header):
                continue
            if folder not in allowed and name not in allowed:
                who = ", ".join(sorted(allowed)) or "no file"
                self.complain(path, line, f"<{header}> may be included by "
                              f"{who} only")
        if header == "mpi.h" and folder in NO_MPI:
            self.complain(path, line, f"{folder} may not see MPI")

    def check_first(self, path, includes):
        """Rule 3, which proves that each header stands alone."""
        model = f"{path.parent.name}/" if path.parent.name in MODELS else ""
        own = f"talus/{model}{path.stem}.h"
        if (self.root / "include" / own).exists() and includes:
            line, header = includes[0]
            if header != own:
                self.complain(path, line, f"include \"{own}\" first")

    def check_file(self, path):
        text = path.read_text(encoding="utf-8")
        folder = self.folder_of(path)
        if folder == "?":
            self.complain(path, 1, "belongs to no folder: there is no .c of "
                          "its stem, and HEADER_ONLY does not name it")
        if not text.startswith(SPDX + "\n"):
            self.complain(path, 1, f"first line must be {SPDX}")
        includes = []
        code = strip_comments(text).split("\n")
        for number, line in enumerate(text.split("\n"), 1):
            match = INCLUDE.match(line)
            if match:
                includes.append((number, match.group(2)))
                check = (self.check_own if match.group(1) == '"'
                         else self.check_foreign)
                if folder != "?":
                    check(path, number, folder, match.group(2))
            if folder not in DIM_FOLDERS and IF_DIM.match(code[number - 1]):
                self.complain(path, number, "#if DIM is for "
                              + " and ".join(sorted(DIM_FOLDERS)) + " only")
            self.check_calls(path, number, folder, code[number - 1])
        if path.suffix == ".c":
            self.check_first(path, includes)

    def check_calls(self, path, number, folder, line):
        if folder == "base":
            return
        allowed = ALLOWED_CALLS.get(str(path.relative_to(self.root)), ())
        for match in CALL.finditer(line):
            if match.group(1) not in allowed:
                self.complain(path, number, f"{match.group(1)}() is for base "
                              "only; see error.h and memory.h")

    def check_all(self):
        for pattern in ("include/talus/*.h", "include/talus/*/*.h",
                        "src/*.[ch]", "src/*/*.[ch]", "tree/*.[ch]"):
            for path in sorted(self.root.glob(pattern)):
                self.check_file(path)


if __name__ == "__main__":
    sys.exit(checker.run(Checker))
