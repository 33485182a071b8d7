"""Writes the tables of docs/papers.md from what its campaigns leave.

    trackloom run --preset papers --out papers
    python3 docs/data/make.py papers
    python3 docs/data/make.py --measure trackloom      times, memory and switches of Liang's scene, of this program

One row is one number that the page uses, one file a preset.
"""

import csv
import sys
from pathlib import Path

import cai_fuzzy
import huo2008
import liang2009
import wang_bat
from campaign import COLUMNS

PAPERS = [liang2009, cai_fuzzy, huo2008, wang_bat]


def main(rows, out):
    tables = {}
    for row in rows:
        tables.setdefault(row["preset"], []).append(row)
    for preset, rows in tables.items():
        with open(out / f"{preset}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    if sys.argv[1] == "--measure":
        found = liang2009.measured(sys.argv[2])
    else:
        found = (row for paper in PAPERS for row in paper.rows(Path(sys.argv[1])))
    main(found, Path(__file__).parent)
