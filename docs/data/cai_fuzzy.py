"""The numbers of Cai et al. and of the genetic c-means page in docs/papers.md, one a row.

`rows(folder)` reads what `trackloom run --preset papers --out papers` leaves, and what two examples leave beside it:

    cargo run --release -p trackloom-domain --example cai_tables -- --genetic > papers/cai-fuzzy-errors.csv
    cargo run --release -p trackloom-domain --example cai_tables -- 10 --times > papers/cai-fuzzy-times.csv
"""

import csv
import json
from pathlib import Path

COLUMNS = ["preset", "cell", "quantity", "value", "low", "high", "runs", "seed"]

# Outcomes that the page uses, of each preset: with the difference to what the cell is compared with, where that is used.
KEPT = {
    "cai-fuzzy-tables": {"accuracy": True, "iterations": False},
    "cai-fuzzy-duplicates": {"accuracy": True, "iterations": False},
    "cai-fuzzy-starts": {"accuracy": True, "iterations": False, "J": True, "unconverged": False},
    "cai-fuzzy-noise": {"accuracy": True},
    "cai-fuzzy-strongest": {"IDF1": True},
    "cai-fuzzy-attributes": {"accuracy": True},
    "cai-fuzzy-genetic": {"accuracy": True, "iterations": False, "J": True},
}

EXAMPLES = ["cai-fuzzy-errors.csv", "cai-fuzzy-times.csv"]

CLUSTERS = 25


def rows(folder):
    """Dictionaries with COLUMNS as keys."""
    folder = Path(folder)
    for preset, kept in KEPT.items():
        report = json.loads((folder / preset / "report.json").read_text())
        for cell in report["result"]["cells"]:
            for outcome, is_compared in kept.items():
                yield from of_outcome(preset, report, cell, outcome, is_compared)
        if preset == "cai-fuzzy-duplicates":
            for cell in report["result"]["cells"]:
                yield from distances(preset, report, cell)
    for name in EXAMPLES:
        if (folder / name).exists():
            with open(folder / name, newline="") as file:
                yield from csv.DictReader(file)


def of_outcome(preset, report, cell, outcome, is_compared):
    """The mean of a cell, and how it differs from the cell that it is compared with."""
    found = cell["outcomes"][outcome]
    if found["mean"] is not None:
        yield row(preset, report, cell, outcome, found["mean"], found["interval"], found["count"])
    difference = cell.get("differences", {}).get(outcome)
    if is_compared and difference and difference["mean"] is not None:
        quantity = f"{outcome} less {cell['compared_with']}'s"
        yield row(preset, report, cell, quantity, difference["mean"], difference["interval"], difference["pairs"])


def distances(preset, report, cell):
    """Distances computed at one instant: of all reports to all clusters, once, and again in every iteration."""
    of = cell["outcomes"]
    pairs = CLUSTERS * of["reports"]["mean"] / of["instants"]["mean"]
    iterations = of["iterations"]
    quantity = "distances an instant"
    if iterations["mean"] is None:
        yield row(preset, report, cell, quantity, pairs, None, cell["runs"])
        return
    interval = {end: pairs * (1 + iterations["interval"][end]) for end in ("low", "high")}
    yield row(preset, report, cell, quantity, pairs * (1 + iterations["mean"]), interval, cell["runs"])


def row(preset, report, cell, quantity, value, interval, runs):
    interval = interval or {"low": "", "high": ""}
    name = " | ".join(str(value) for value in cell["parameters"].values())
    number = lambda found: "" if found == "" else f"{found:.6g}"
    values = [preset, name, quantity, number(value), number(interval["low"]), number(interval["high"]), runs, report["seed"]]
    return dict(zip(COLUMNS, values))
