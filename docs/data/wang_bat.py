"""The numbers of Wang, Li, Huang in docs/papers.md, one a row."""

import csv
import json
import math
import statistics
from collections import defaultdict
from pathlib import Path

# Outcomes that the page uses, of each preset: with the difference to what the cell is compared with, where that is used.
KEPT = {
    "wang-bat-tables": {"identity": True, "stay": False, "error_deg": True, "error_kept_deg": False, "optimum_reached": False},
    "wang-bat-clutter": {"identity": True, "error_deg": False},
    "wang-bat-targets": {"identity": True, "error_deg": False},
    "wang-bat-crossings": {"identity": True, "error_deg": False},
    "wang-bat-objective": {name: False for objective in ("sum", "ratio") for group in ("all", "detected", "shared")
                           for name in (f"{objective}, {group}", f"{objective}, {group}, lack")},
    "wang-bat-alpha-gamma": {"identity": True, "error_deg": True, "optimum_reached": True},
    "wang-bat-sea-trials": {"identity": False, "stay": False, "targets kept": False, "error_deg": False, "p_d": False},
}
# Contenders whose difference to the bats is taken run by run, and of what.
AGAINST_BATS = {"NN, shared": ["identity", "error_deg"], "PDA": ["identity", "error_deg"]}
BATS = "BADA, sum"
TIMED = "wang-bat-tables"
# Of the normal distribution: the fewest pairs are 100.
Z_97_5 = 1.96


def rows(folder):
    """Dictionaries with the keys preset, cell, quantity, value, low, high, runs, seed."""
    for preset, kept in KEPT.items():
        report = json.loads((Path(folder) / preset / "report.json").read_text())
        for cell in report["result"]["cells"]:
            for outcome, is_compared in kept.items():
                yield from of_outcome(preset, report["seed"], cell, outcome, is_compared)
        yield from against_bats(preset, report["seed"], runs_of(Path(folder) / preset / "runs.csv"))
        if preset == TIMED:
            for time in report["timing"]["cells"]:
                yield row(preset, report["seed"], time["cell"], "time to JPDA's", time["ratio"], None, time["timed_runs"])


def row(preset, seed, cell, quantity, value, interval, runs):
    low, high = (interval["low"], interval["high"]) if interval else (None, None)
    numbers = ["" if number is None else f"{number:.6g}" for number in (value, low, high)]
    return dict(zip(["preset", "cell", "quantity", "value", "low", "high", "runs", "seed"],
                    [preset, cell, quantity, *numbers, runs, seed]))


def of_outcome(preset, seed, cell, outcome, is_compared):
    found = cell["outcomes"][outcome]
    if found["mean"] is not None:
        yield row(preset, seed, cell["name"], outcome, found["mean"], found["interval"], found["count"])
    difference = cell.get("differences", {}).get(outcome)
    if is_compared and difference and difference["mean"] is not None:
        quantity = f"{outcome} less {cell['compared_with']}'s"
        yield row(preset, seed, cell["name"], quantity, difference["mean"], difference["interval"], difference["pairs"])


def runs_of(path):
    """The numbers of each run, by cell."""
    cells = defaultdict(list)
    with open(path, newline="", encoding="utf-8") as file:
        for run in csv.DictReader(file):
            cells[run["cell"]].append(run)
    return cells


def against_bats(preset, seed, runs):
    for cell, of_cell in runs.items():
        for name, outcomes in AGAINST_BATS.items():
            bats = runs.get(cell.removesuffix(name) + BATS, [])
            if not cell.endswith(name) or not bats:
                continue
            for outcome in outcomes:
                pairs = [float(one[outcome]) - float(other[outcome]) for one, other in zip(of_cell, bats)]
                mean, half = statistics.mean(pairs), Z_97_5 * statistics.stdev(pairs) / math.sqrt(len(pairs))
                interval = {"low": mean - half, "high": mean + half}
                yield row(preset, seed, cell, f"{outcome} less {BATS}'s", mean, interval, len(pairs))
