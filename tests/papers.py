#!/usr/bin/env python3
"""Whether the campaigns of docs/papers.md still give its numbers, and whether the page has those of its tables.

Usage: papers.py TRACKLOOM [SHARE]. Runs every campaign of the preset `papers` with this share of its runs (0.1 unless said; 1 for
all), makes the rows of docs/data of them, and holds each against the stored row: the two values are no further apart than one and a
half times what their 95 % intervals reach together. Times, which are ratios of one machine, are not compared.
Each number of the page that has an interval is that of some row, rounded.
Exit code 1: something differs, or a row is missing.
"""

import csv
import json
import math
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

DATA = Path(__file__).resolve().parent.parent / "docs" / "data"
sys.path.insert(0, str(DATA))
sys.dont_write_bytecode = True

import make  # noqa: E402

FEWEST_RUNS = 3
PAGE = DATA.parent / "papers.md"
# A number and its interval: "50.1 (49.1–51.0)", "+1.9 points (+1.4 to +2.3)".
INTERVAL = re.compile(r"([+−]?[\d.]+)(?: points| %| m)? \(([+−]?[\d.]+)(?:–| to )([+−]?[\d.]+)\)")
# Shares are percents in the page, or it tells the rest of one.
SHOWN = [lambda x: x, lambda x: 100 * x, lambda x: -x, lambda x: -100 * x, lambda x: 100 * (x - 1)]


def main(trackloom, share):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        presets = sorted(make.campaigns(trackloom))
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda preset: run(trackloom, preset, share, folder / preset), presets))
        stored = {preset: table(DATA / f"{preset}.csv") for preset in presets}
        told = [fault for paper in make.PAPERS for fault in compared(paper, folder, stored)]
    told += [f"{shown}: in the page and in no table" for shown in unfounded()]
    print(f"{len(presets)} campaigns, {sum(map(len, stored.values()))} numbers stored, {len(told)} differ")
    print("\n".join(told[:40]))
    return 1 if told or not presets else 0


def run(trackloom, preset, share, out):
    body = json.loads(subprocess.run([trackloom, "presets", preset], check=True, capture_output=True, text=True).stdout)
    runs = max(FEWEST_RUNS, math.ceil(body["runs"] * share))
    subprocess.run([trackloom, "run", "--preset", preset, "--runs", str(runs), "--out", str(out)],
                   check=True, capture_output=True)


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        if path.stem == "huo2008-problems":
            return {}
        return {(row["cell"], row["quantity"]): row for row in csv.DictReader(file)}


def compared(paper, folder, stored):
    for row in paper.campaign_rows(folder):
        old = stored.get(row["preset"], {}).get((row["cell"], row["quantity"]))
        where = f"{row['preset']}, {row['cell']}, {row['quantity']}"
        if "time" in row["quantity"]:
            continue
        if old is None:
            yield f"{where}: not stored"
        elif not are_near(old, row):
            yield f"{where}: {old['value']} ({old['low']} to {old['high']}) is stored, {row['value']} ({row['low']} to {row['high']}) found"


def are_near(old, new):
    """What fewer runs give has the interval of all of them, wider by the root of the share."""
    if not all((old["value"], old["low"], old["high"], new["value"])):
        return True
    value, low, high, other = (float(text) for text in (old["value"], old["low"], old["high"], new["value"]))
    share = int(new["runs"]) / int(old["runs"])
    reach = max(high - value, value - low) * (1 + 1 / math.sqrt(share))
    return abs(value - other) <= 1.5 * reach + 1e-6 * max(abs(value), abs(other))


def unfounded():
    """What the page shows with an interval and no table has."""
    rows = [row for path in DATA.glob("*.csv") for row in table(path).values() if row["value"] and row["low"]]
    known = [tuple(float(row[name]) for name in ("value", "low", "high")) for row in rows]
    for match in INTERVAL.finditer(PAGE.read_text(encoding="utf-8")):
        shown = [text.replace("−", "-") for text in match.groups()]
        if not any(is_shown(shown, [of(x) for x in numbers]) for numbers in known for of in SHOWN):
            yield match.group()


def is_shown(shown, numbers):
    """Whether rounding gives these texts, in either order of the interval's ends."""
    ends = sorted(shown[1:], key=float)
    pairs = zip([shown[0], *ends], [numbers[0], *sorted(numbers[1:])])
    return all(abs(float(text) - number) <= 0.501 * 10 ** -len(text.partition(".")[2]) for text, number in pairs)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 0.1))
