#!/usr/bin/env python3
"""Two builds of the benchmark `association` in turns: what every associator and the oracle cost, in u.

Usage: own_u.py OLD NEW. A cost is the least of all turns, u the least of both programs: other programs only ever add.
Exit code 1: something costs more than 5 % more.
"""

import os
import re
import subprocess
import sys

# A run of a larger scene is longer than a machine with other work leaves a program alone.
SIZES = ["100", "1000"]
TURNS = 10
ALLOWED_RATIO = 1.05


def main(programs):
    leasts = [{}, {}]
    yardsticks = []
    for _ in range(TURNS):
        for program, least in zip(programs, leasts):
            text = subprocess.run([program, *SIZES], check=True, capture_output=True, text=True,
                                  preexec_fn=go_first).stdout
            yardsticks.append(float(re.search(r"yardstick u = ([0-9.]+) ns", text)[1]))
            for place, cost_ns in costs(text):
                least[place] = min(cost_ns, least.get(place, cost_ns))
    return tell(min(yardsticks), *leasts)


def go_first():
    """Before other programs, where that is allowed."""
    try:
        os.nice(-20)
    except PermissionError:
        pass


def costs(text):
    """(targets, associator) with the nanoseconds for each track and scan."""
    for targets, name, cost_ns in re.findall(r"^ *(\d+)  (\w+) +\d+ +([0-9.]+) ", text, re.MULTILINE):
        yield (int(targets), name), float(cost_ns)


def tell(u_ns, old, new):
    print(f"u = {u_ns:.1f} ns; least of {TURNS} turns")
    print(f"{'targets':>8}  {'associator':<24} {'old u':>7} {'new u':>7} {'ratio':>6}")
    slower = 0
    for place, old_ns in old.items():
        if place not in new:
            print(f"{place[0]:>8}  {place[1]:<24} {old_ns / u_ns:>7.2f}       –      –")
            continue
        ratio = new[place] / old_ns
        slower += ratio > ALLOWED_RATIO
        mark = "  slower" if ratio > ALLOWED_RATIO else ""
        print(f"{place[0]:>8}  {place[1]:<24} {old_ns / u_ns:>7.2f} {new[place] / u_ns:>7.2f} {ratio:>6.3f}{mark}")
    return 1 if slower else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
