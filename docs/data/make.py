"""Writes the tables of docs/papers.md from what its campaigns leave.

    trackloom run --preset papers --out papers
    python3 docs/data/make.py papers

One row is one number that the page uses, one file a preset.
"""

import csv
import sys
from pathlib import Path

import huo2008

COLUMNS = ["preset", "cell", "quantity", "value", "low", "high", "runs", "seed"]
PAPERS = [huo2008]


def main(folder, out):
    tables = {}
    for paper in PAPERS:
        for row in paper.rows(folder):
            tables.setdefault(row["preset"], []).append(row)
    for preset, rows in tables.items():
        with open(out / f"{preset}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(__file__).parent)
