# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs cases for the tools that compare runs, each once only."""
import pathlib
import re
import subprocess
import sys

# Exit status of a run that ended before its time, and of one that failed
STOPPED, FAILED = 5, 3
ROOT = pathlib.Path(__file__).resolve().parent.parent
TALUS = ROOT / "build" / "talus"  # unless the command line names another


def fail(text, status=2):
    print(f"{pathlib.Path(sys.argv[0]).stem}: error: {text}", file=sys.stderr)
    sys.exit(status)


def split_word(word):
    name, sign, value = word.partition("=")
    if not (name and sign and value):
        fail(f"'{word}' is not of the form name=value")
    return name, value


def text_of(value):
    """A number that reads back the same, whole ones as whole ones."""
    whole = value == round(value) and abs(value) < 1e15
    return str(round(value)) if whole else repr(value)


def check_program(talus):
    """The whole path of the program, which must be there."""
    if not talus.is_file():
        fail(f"there is no program '{talus}'; `make` builds it, or "
             "--talus names another")
    return talus.resolve()


def ask_case(talus, case, words):
    """{name: value} of all parameters of the case, as `talus check` prints
    them."""
    answer = subprocess.run([talus, "check", case, *words],
                            capture_output=True, text=True)
    if answer.returncode != 0:
        sys.stderr.write(answer.stderr)
        sys.exit(answer.returncode)
    declared = re.split(r"^title +=", answer.stdout, flags=re.MULTILINE)[0]
    return dict(re.findall(r"^(?:param\.)?(\w+) += (\S+) ", declared,
                           re.MULTILINE))  # before the first key of the case


def start(command):
    """Exit status of a command. Ctrl-C reaches the run as well, which then
    writes a checkpoint: wait for it."""
    process = subprocess.Popen(command)
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:
            continue


def without_comments(text):
    return re.sub(r"\s*--[^\n]*", "", text)


def run(talus, case, words, directory):
    """Run, or go on, unless just that run is there, complete; comments of the
    case may have changed. Returns the exit status."""
    stamp, stopped = directory / "sweep.txt", directory / "sweep-stopped.txt"
    text = "\n".join([without_comments(case.read_text(encoding="utf-8")),
                      *words])

    def holds(path):
        return path.exists() and path.read_text(encoding="utf-8") == text

    if holds(stamp) and (directory / "series.csv").exists():
        return 0
    go_on = holds(stopped) and (directory / "checkpoint.h5").exists()
    stamp.unlink(missing_ok=True)
    stopped.unlink(missing_ok=True)
    status = start([talus, "run", case, *words, "--quiet", "-o", directory,
                    *(["--restart"] if go_on else [])])
    if status in (0, STOPPED):
        (stamp if status == 0 else stopped).write_text(text, encoding="utf-8")
    return status


def run_to_end(talus, case, words, directory, name, may_fail=False):
    """As run, but end the tool unless the run, which messages call `name`, has
    come to its end; or has failed numerically and may."""
    status = run(talus, case, words, directory)
    if may_fail and status == FAILED:
        print(f"{name} ended with status {status}")
        return status
    if status == STOPPED:
        fail(f"{name} was stopped before its end; the same command goes on "
             "from there", STOPPED)
    if status != 0:
        fail(f"{name} ended with status {status}", max(status, 1))
    return status
