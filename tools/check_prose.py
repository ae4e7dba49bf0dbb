#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Verifies the rules of prose that a script can see.

1. What stands over a function says what the function does, so it begins with a
   verb, not with one of NOT_FIRST; no comment begins as NEVER_FIRST.
2. Papers that are cited by key, [weymouth_yue_2010], are in references.bib.
3. Files that comments and pages name exist: the path from the root, that below
   include/ or include/talus/, or a name alone. NAME in capitals, as in NAME.c,
   stands for any.

Prints each violation as file:line: message and ends with status 1 if there are
any.
"""
import pathlib
import re
import sys

import checker

NOT_FIRST = {"Of", "What", "Whether", "Which", "The", "A", "An", "How", "So",
             "Else", "It", "Its", "This", "That", "Those", "These", "Where"}
# Files of other programs.
FOREIGN = {"lstrlib.c", "granular_sandglass.c"}

# Words that no comment begins with, over a function or not, and none of its
# paragraphs but those that go on with "Else" or "So".
NEVER_FIRST = re.compile(r"/\*\s+\*?\s*(Of|What|Whether|Else|So|The same)\b"
                         r"|\*[ ]*\n[ ]*\*[ ]*(Of|What|Whether|The same)\b")
COMMENT = re.compile(r"/\*.*?\*/", re.S)
# A comment at the begin of a line, then the head of a function.
OVER_FUNCTION = re.compile(r"^/\*(?P<text>(?:(?!\*/).)*)\*/ *\n"
                           r"(?!START_TEST)[A-Za-z][^;{=#]*?\([^;{]*[;{]",
                           re.S | re.M)
FILE = re.compile(r"(?<![\w.*/-])((?:[\w-]+/)*[\w-]+\.(?:c|h|py|sh|md))"
                  r"(?!\w|\.\w)")
KEY = re.compile(r"\b[a-z]+(?:_[a-z]+)*_\d{4}[a-z]?\b")
CITED = re.compile(r"\[(" + KEY.pattern + r")[^]]*\]")
ANY = re.compile(r"(?<![A-Za-z])[A-Z]{3,}(?=[./])")


class Checker(checker.Checker):
    """Finds violations in the tree below `root`."""

    def __init__(self, root):
        super().__init__(root)
        self.sources = [path for pattern in
                        ("include/**/*.h", "src/**/*.[ch]", "tree/*.[ch]",
                         "tests/**/*.[ch]") for path in root.glob(pattern)]
        self.pages = [*root.glob("*.md"), *root.glob("docs/**/*.md")]
        self.names = {path.name for path in self.sources + self.pages}
        self.names.update(path.name for folder in ("tools", "tests")
                          for path in (root / folder).rglob("*.*"))
        papers = root / "references.bib"
        self.papers = (set(KEY.findall(papers.read_text(encoding="utf-8")))
                       if papers.exists() else set())

    def complain_at(self, path, text, place, message):
        self.complain(path, text.count("\n", 0, place) + 1, message)

    def exists(self, name):
        if ANY.search(name):
            return True
        if "/" not in name:
            return name in self.names | FOREIGN
        return any((self.root / folder / name).exists()
                   for folder in ("", "include", "include/talus"))

    def check_names(self, path, text, begin, end):
        for match in FILE.finditer(text, begin, end):
            if not self.exists(match.group(1)):
                self.complain_at(path, text, match.start(),
                              f"there is no {match.group(1)}")

    def check_papers(self, path, text, begin, end):
        for match in CITED.finditer(text, begin, end):
            for key in KEY.findall(match.group()):
                if key not in self.papers:
                    self.complain_at(path, text, match.start(),
                                  f"{key} is not in references.bib")

    def check_source(self, path):
        text = path.read_text(encoding="utf-8")
        for comment in COMMENT.finditer(text):
            self.check_names(path, text, *comment.span())
            self.check_papers(path, text, *comment.span())
            for first in NEVER_FIRST.finditer(comment.group()):
                self.complain_at(
                    path, text, comment.start() + first.start(),
                    f"begin otherwise than with {first.group(1) or first.group(2)}")
        for match in OVER_FUNCTION.finditer(text):
            word = match.group("text").lstrip("\n *").split(None, 1)[:1]
            if word and word[0].strip(",:;") in NOT_FIRST:
                self.complain_at(path, text, match.start(),
                              f"begin with a verb, not with {word[0]}")

    def check_all(self):
        for path in sorted(self.sources):
            self.check_source(path)
        for path in sorted(self.pages):
            text = path.read_text(encoding="utf-8")
            self.check_names(path, text, 0, len(text))


if __name__ == "__main__":
    sys.exit(checker.run(Checker))
