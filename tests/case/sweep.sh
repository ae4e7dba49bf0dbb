#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# tools/sweep.py: parameters that are expressions, power laws over one range
# and two, runs that end badly or before their time. Usage: sweep.sh BUILD
. "$(dirname "$0")/common.bash"
find_python

# A program that plays talus: run-out 3 a up to a = 2, 3 2^(1/3) a^(2/3)
# beyond, height a^0.4. It notes its runs in `calls` and ends with the status
# that the file status-$a holds, once.
cat > talus << 'PYTHON'
import pathlib
import sys

command, _, *words = sys.argv[1:]
values = dict(w.split("=", 1) for w in words if "=" in w)
values = {"a": "1", "stop": "4", "size": "8", "law": "mu_i"} | values
if command == "check":
    for name, value in values.items():
        print(f"{name:26} = {value:21} -       help [default]")
    print(f"{'title':26} = {'a title':21} -       one line")
    print(f"{'dimension':26} = {'2':21} -       2 or 3")
    sys.exit()
with open("calls", "a") as f:
    print(*words, file=f)
directory = pathlib.Path(words[words.index("-o") + 1])
directory.mkdir(parents=True, exist_ok=True)
(directory / "checkpoint.h5").touch()
a = float(values["a"])
runout = 3 * a if a <= 2 else 3 * 2 ** (1 / 3) * a ** (2 / 3)
(directory / "parameters.csv").write_text("key,value\ngravity,\"0,-1\"\n")
(directory / "profile.csv").write_text(
    f"time,x,height\n1,0.5,{a}\n1,1.5,{a / 2}\n1,2.5,0\n")
(directory / "series.csv").write_text(
    "time,front,height,mean_shear_rate,max_speed\n"
    f"0,1,{a},1,1\n1,{1 + runout!r},{a ** 0.4!r},0,0\n")
status = pathlib.Path(f"status-{values['a']}")
if status.exists():
    code = int(status.read_text())
    status.unlink()
    sys.exit(code)
PYTHON
sed -i "1i#!/usr/bin/env $python" talus
chmod +x talus
echo "return {}" > case.lua

cat > check.py << 'PYTHON'
import contextlib
import csv
import io
import pathlib
import re
import sys
import numpy as np

tools, talus = sys.argv[1:]
sys.path.insert(0, tools)
import expression
import power_law
import sweep


def sweeps(status, *words, program="./talus"):
    """What a sweep says, which must end with that status."""
    said = io.StringIO()
    sys.argv = ["sweep.py", *words, "--talus", program]
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            sweep.main()
            code = 0
        except SystemExit as end:
            code = end.code
    assert code == status, (words, code, said.getvalue())
    return said.getvalue()


def says(text, *patterns):
    for pattern in patterns:
        assert re.search(f"^{pattern}$", text, re.MULTILINE), (pattern, text)


def calls():
    """The runs since the last call."""
    path = pathlib.Path("calls")
    lines = path.read_text().splitlines() if path.exists() else []
    path.unlink(missing_ok=True)
    return lines


def end_with(status, a):
    pathlib.Path(f"status-{a}").write_text(str(status))


# Two ranges, given and found.
said = sweeps(0, "case.lua", "a=0.5,1,2,4,8,16", "--break", "2", "-o", "given")
says(said, r"run-out = 3 a\^1.000 \+- \S+  \(3 values, a = 0.5 to 2\)",
     r"run-out = 3.78 a\^0.667 \+- \S+  \(4 values, a = 2 to 16\)",
     r"height = 1 a\^0.400 .*a = 2 to 16\)")
said = sweeps(0, "case.lua", "a=0.4,0.7,1.2,3,6,11", "--break", "find", "-o",
              "found")
says(said, "break at a = 2", r"run-out = 3 a\^1.000 .*\(3 values, .* to 1.2\)",
     r"run-out = 3.78 a\^0.667 .*\(3 values, a = 3 to 11\)", "found/sweep.csv",
     "found/fits.csv", "found/sweep.png", "found/panels.png")
rows = list(csv.reader(open("found/fits.csv")))
assert len(rows) == 5 and all(len(row) == 7 for row in rows), rows
assert pathlib.Path("found/sweep.png").stat().st_size > 5000
assert len(calls()) == 12

# Expressions, one of them of another; text is no expression.
sweeps(0, "case.lua", "a=4,9", "stop=5*math.sqrt(a)", "law=bingham",
       "size=stop^2 - -a/2", "--base", "a/2", "-o", "words")
rows = open("words/sweep.csv").read().splitlines()
assert rows[0] == "a,front,height,runout,arrest_time,last_speed,stop,size"
assert rows[1].startswith("4,") and rows[1].endswith(",0,0,10,102"), rows
assert rows[2].startswith("9,") and rows[2].endswith(",0,0,15,229.5"), rows
assert calls()[0].startswith("a=4 law=bingham stop=10 size=102 --quiet")
for message, *words in (
        (r"stop=2\*b: there is no number b; known: a, pi, size", "a=1",
         "stop=2*b"),
        (r"each .* another: stop=2\*size, size=2\*stop", "a=1", "stop=2*size",
         "size=2*stop"),
        ("'a' is not of the form name=value", "a"),
        ("a=1,,2: a value is empty", "a=1,,2"),
        ("--log-log: all values of a must be .* > 0", "a=0,1", "--log-log"),
        ("--break: all values of law must be .*", "law=x,y", "--break", "2"),
        ("--break x: a number > 0 or .*", "a=1,2", "--break", "x"),
        ("--base 0: a length > 0 .*", "a=1,2", "--base", "0"),
        ("--break find: 5 values .*, 2 given", "a=1,2", "--break", "find")):
    says(sweeps(2, "case.lua", *words), "sweep: error: " + message)
says(sweeps(2, "nothing.lua", "a=1"), ".*no case 'nothing.lua'")
says(sweeps(2, "case.lua", "a=1", program="nothing"), ".*no program.*")
assert not calls()

# A run stopped before its end is continued, others are not repeated; one that
# fails ends the sweep.
end_with(5, 2)
said = sweeps(5, "case.lua", "a=1,2,3", "-o", "stopped")
says(said, ".*a=2 was stopped before its end.*")
assert not pathlib.Path("stopped/sweep.csv").exists()
sweeps(0, "case.lua", "a=1,2,3", "-o", "stopped")
made = calls()
assert [line.split()[0] for line in made] == ["a=1", "a=2", "a=2", "a=3"], made
assert ["--restart" in line for line in made] == [0, 0, 1, 0], made
end_with(3, 4)
says(sweeps(3, "case.lua", "a=4", "-o", "stopped"), ".*a=4 .* status 3")
# A run that another has replaced is not there any more.
end_with(5, 3)
sweeps(5, "case.lua", "a=3", "size=9", "-o", "stopped")
calls()
end_with(3, 3)
sweeps(3, "case.lua", "a=3", "-o", "stopped")
made = calls()
assert len(made) == 1 and "--restart" not in made[0], made

# Arithmetic and nothing else; standard errors, against those of numpy.


def value(text, **known):
    tree, = expression.parse(text)
    return expression.evaluate(tree, known)

assert value("-2^2*3 + max(a, 7)/2", a=1) == -8.5
assert value("2^3^2") == 512 and value("2^-1") == 0.5
assert abs(value("math.exp(1) - exp(1) + sqrt(pi)^2") - np.pi) < 1e-15
assert value("pi", pi=3) == 3
for text, message in (
        ("__import__('os')", "no function __import__"),
        ("__import__('os').getpid()", "only numbers"), ("a.real", "only num"),
        ("[a for a in a]", "only"), ("sqrt(x=a)", "only"), ("{}", "only"),
        ("a if a else 0", "only"), ("lambda: 0", "only"), ("'text'", "only"),
        ("1j", "only"), ("a < 2", "only"), ("True", "only"),
        ("f'{a}'", "only"), ("(a := 1)", "only"),
        ("2*", "no expression"), ("", "no expression"), ("(" * 500, "no expres"),
        ("\0", "no expression"), ("9^9^9^9", "no value"), ("1/0", "zero"),
        ("sqrt(-1)", "no value"), ("sqrt()", "no value"), ("1e308*10", "finite"),
        ("1" + "+1" * 9000, ""), ("b", "no number b; known: a, pi")):
    try:
        value(text, a=1.0)
        assert False, text
    except expression.ExpressionError as error:
        assert message in str(error), (text, error)

x = np.array([0.5, 0.9, 2.0, 3.1, 7.0])
y = 1.3 * x ** 0.8 * np.array([1.02, 0.97, 1.05, 0.99, 1.01])
law = power_law.fit_one(x, y)
(slope, _), cov = np.polyfit(np.log(x), np.log(y), 1, cov=True)
assert abs(law.exponent - slope) < 1e-12
assert abs(law.error - np.sqrt(cov[0, 0])) < 1e-12
assert power_law.fit_one(x[:2], y[:2]).error is None
assert power_law.fit_one(x[:1], y[:1]) is None

# The program itself.
sweeps(0, f"{tools}/../examples/column.lua", "a=1,2", "level=5",
       "stop=0.02*sqrt(a)", "-o", "column", program=talus)
assert ",0.0282842712474619" in open("column/sweep.csv").read()
PYTHON
timeout 300 "$python" check.py "$root/tools" "$build/talus"
