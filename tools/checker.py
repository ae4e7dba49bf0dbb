# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that the checks of sources share."""
import pathlib
import sys


class Checker:
    """Collects violations in the tree below `root`; check_all finds them."""

    def __init__(self, root):
        self.root = root
        self.violations = []

    def complain(self, path, line, message):
        name = path.relative_to(self.root)
        self.violations.append(f"{name}:{line}: {message}")


def run(kind):
    """Checks the tree of the first argument, or that of this file; returns the
    exit status."""
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else
                        pathlib.Path(__file__).parent.parent).resolve()
    checker = kind(root)
    checker.check_all()
    print("\n".join(checker.violations),
          end="\n" if checker.violations else "")
    return 1 if checker.violations else 0
