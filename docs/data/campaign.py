"""What the tables of all papers have in common: one row is one number of a campaign."""

import csv
import json
from collections import defaultdict
from pathlib import Path

COLUMNS = ["preset", "cell", "quantity", "value", "low", "high", "runs", "seed"]


class Campaign:
    """A preset and its seed; with what it left in a folder, its cells, the ratios of times, and the numbers of each run."""

    def __init__(self, preset, seed, report=None, folder=None):
        self.preset, self.seed, self.folder = preset, seed, folder
        self.cells = report["result"]["cells"] if report else []
        self.times = report["timing"]["cells"] if report else []

    @staticmethod
    def of(folder, preset):
        folder = Path(folder) / preset
        report = json.loads((folder / "report.json").read_text())
        return Campaign(preset, report["seed"], report, folder)

    def row(self, cell, quantity, value, interval, runs):
        """`interval` is (low, high), or `None` of a number without one."""
        low, high = interval or (None, None)
        numbers = [written(number) for number in (value, low, high)]
        return dict(zip(COLUMNS, [self.preset, cell, quantity, *numbers, runs, self.seed]))

    def outcomes(self, cell, kept):
        """Means of a cell, and where `kept` says so the difference to the cell that it is compared with."""
        for outcome, is_compared in kept.items():
            found = cell["outcomes"][outcome]
            if found["mean"] is not None:
                yield self.row(cell["name"], outcome, found["mean"], ends(found["interval"]), found["count"])
            difference = cell.get("differences", {}).get(outcome)
            if is_compared and difference and difference["mean"] is not None:
                quantity = f"{outcome}, less {cell['compared_with']}"
                yield self.row(cell["name"], quantity, difference["mean"], ends(difference["interval"]), difference["pairs"])

    def time_ratios(self):
        for time in self.times:
            yield self.row(time["cell"], "time, of what it is compared with", time["ratio"], None, time["timed_runs"])

    def runs(self):
        """The numbers of each run, by cell."""
        cells = defaultdict(list)
        with open(self.folder / "runs.csv", newline="", encoding="utf-8") as file:
            for run in csv.DictReader(file):
                cells[run["cell"]].append({name: float(text) for name, text in run.items() if name != "cell" and text})
        return cells


def written(number):
    """Seven digits; what rounding leaves of nothing is 0."""
    if number is None:
        return ""
    return "0" if abs(number) < 1e-9 else f"{number:.7g}"


def ends(interval):
    return interval and (interval["low"], interval["high"])
