#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the outlines of a run are from a reference.

  tools/compare_outline.py DIR --reference FILE [--time-scale SCALE] [--json]

For each outline of DIR/profile.csv at a time of the reference it prints the
symmetric difference  int |h - s r| dx / int h dx,  where the heights r of the
reference are scaled by the factor s = int h dx / int r dx (x is left alone),
and then the mean over the times after the start. SCALE is one unit of the
reference's time in units of the run's: a number or sqrt(number); without it
the parameter `reference_time`, or else sqrt(a), where a is the parameter of
that name.
"""
import argparse
import json
import sys

import run_data


def front(x, height):
    """Where the outline comes down to half a column, as in series.csv."""
    threshold = 0.5 * (x[1] - x[0])
    above = [k for k in range(len(x)) if height[k] > threshold]
    if not above or above[-1] + 1 == len(x):
        return float(x[-1])
    k = above[-1]
    step = (height[k] - threshold) / (height[k] - height[k + 1])
    return float(x[k] + step * (x[k + 1] - x[k]))


def compare_run(directory, reference, scale):
    """A row of results for each outline at a time of the reference."""
    rows = []
    for time, x, height, _ in run_data.read_profiles(directory):
        other = reference.at(time / scale)
        if other is None or len(x) < 2:
            continue
        difference, factor = run_data.compare(x, height, reference.x, other)
        rows.append({
            "time": time,
            "reference_time": time / scale,
            "difference": difference,
            "height_scale": factor,
            "front": front(x, height),
            "reference_front": front(reference.x, other)
        })
    return rows


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("directory", metavar="DIR")
    parser.add_argument("--reference", metavar="FILE",
                        help="default: what the parameter `reference` names")
    parser.add_argument("--time-scale", metavar="SCALE")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()

    parameters = run_data.read_parameters(options.directory)
    path = options.reference or run_data.find_reference(options.directory,
                                                        parameters)
    if path is None:
        sys.exit("compare_outline: give a file to compare with: --reference")
    try:
        reference = run_data.Reference(path)
        scale = run_data.parse_scale(options.time_scale, parameters)
        rows = compare_run(options.directory, reference, scale)
    except (OSError, ValueError, KeyError, IndexError) as error:
        sys.exit(f"compare_outline: {error}")
    if not rows:
        sys.exit("compare_outline: no outline at a time of the reference; "
                 "is --time-scale right?")
    late = [r["difference"] for r in rows if r["reference_time"] > 0] or [0]
    mean = sum(late) / len(late)
    if options.json:
        print(json.dumps({"reference": str(path), "time_scale": scale,
                          "outlines": rows, "mean": mean}, indent=2))
        return
    print(f"reference {path}, time unit {scale:.4g} of the run's")
    print("    time  time_ref  difference  height_scale   front  front_ref")
    for r in rows:
        print(f"{r['time']:8.4f}  {r['reference_time']:8.3f}  "
              f"{r['difference']:10.4f}  {r['height_scale']:12.4f}  "
              f"{r['front']:6.2f}  {r['reference_front']:9.2f}")
    print(f"mean                {mean:10.4f}")


if __name__ == "__main__":
    main()
