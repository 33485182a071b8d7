"""What the tables of all papers have in common: one row is one number of a campaign."""

import csv
import json
import math
import statistics
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


def mean(numbers):
    """Mean, t interval and count."""
    middle, count = statistics.fmean(numbers), len(numbers)
    half = t_quantile(count - 1) * statistics.stdev(numbers) / math.sqrt(count)
    return middle, (middle - half, middle + half), count


def t_quantile(degrees):
    """The 0.975 quantile of Student's t, by bisection of Simpson's rule."""
    scale = math.exp(math.lgamma((degrees + 1) / 2) - math.lgamma(degrees / 2)) / math.sqrt(degrees * math.pi)

    def density(x):
        return scale * (1 + x * x / degrees) ** (-(degrees + 1) / 2)

    def area(end, steps=400):
        width = end / steps
        inner = sum((4 if step % 2 else 2) * density(step * width) for step in range(1, steps))
        return width / 3 * (density(0) + inner + density(end))

    low, high = 0.0, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if area(middle) < 0.475 else (low, middle)
    return low
