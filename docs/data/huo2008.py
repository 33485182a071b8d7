"""The numbers of Huo et al. in docs/papers.md, one a row: means and intervals of the campaigns, and what is counted run by run."""

import csv
import json
import math
import statistics
from collections import defaultdict

import huo2008_plain

# Outcomes that the page uses, and whether their difference to the cell that a cell is compared with is used, too.
KEPT = {
    "huo2008-study": {"tuples right": True, "gap": False},
    "huo2008-statistic": {"tuples right": False, "precision": False, "recall": False},
    "huo2008-printed": {"tuples right": True},
    "huo2008-confirmation": {"true tuples": True},
    "huo2008-integer-programming": {"tuples right": False},
    "huo2008-nodes": {"tuples right": True, "gap": False},
    "huo2008-relaxation": {"tuples right": True, "J": True},
    "huo2008-alpha": {},
}
# Of the many correlators of the study those that the page speaks of.
STUDIED = ("nearest", "weighted", "genetic", "exact", "the paper's coding")
TIMED = ["huo2008-printed", "huo2008-integer-programming", "huo2008-relaxation"]


def rows(folder):
    yield from campaign_rows(folder)
    plain = Campaign("huo2008-printed", 1, {})
    yield from shares_and_gaps(plain, "3 × 10, plain program", huo2008_plain.gaps())


def campaign_rows(folder):
    """Without the plain program, which takes minutes."""
    for preset, kept in KEPT.items():
        report = json.loads((folder / preset / "report.json").read_text())
        of = Campaign(preset, report["seed"], runs_of(folder / preset / "runs.csv"))
        for cell in report["result"]["cells"]:
            if preset == "huo2008-study" and not cell["name"].endswith(STUDIED):
                continue
            for outcome, is_compared in kept.items():
                yield from of_outcome(of, cell, outcome, is_compared)
            yield from counted(of, cell)
        if preset in TIMED:
            for time in report["timing"]["cells"]:
                yield of.row(time["cell"], "time, of what it is compared with", time["ratio"], None, time["timed_runs"])


class Campaign:
    """A preset, its seed, and the outcomes of each run of each cell."""

    def __init__(self, preset, seed, runs):
        self.preset, self.seed, self.runs = preset, seed, runs

    def row(self, cell, quantity, value, interval, runs):
        low, high = interval if interval else (None, None)
        numbers = [written(number) for number in (value, low, high)]
        return dict(zip(["preset", "cell", "quantity", "value", "low", "high", "runs", "seed"],
                        [self.preset, cell, quantity, *numbers, runs, self.seed]))


def written(number):
    """Seven digits; what rounding leaves of nothing is 0."""
    if number is None:
        return ""
    return "0" if abs(number) < 1e-9 else f"{number:.7g}"


def runs_of(path):
    cells = defaultdict(list)
    with open(path, newline="") as file:
        for run in csv.DictReader(file):
            cells[run["cell"]].append({name: float(text) for name, text in run.items() if name != "cell" and text})
    return cells


def of_outcome(of, cell, outcome, is_compared):
    found = cell["outcomes"][outcome]
    if found["mean"] is not None:
        yield of.row(cell["name"], outcome, found["mean"], ends(found["interval"]), found["count"])
    difference = cell.get("differences", {}).get(outcome)
    if is_compared and difference and difference["mean"] is not None:
        yield of.row(cell["name"], f"{outcome}, less {cell['compared_with']}", difference["mean"],
                     ends(difference["interval"]), difference["pairs"])


def ends(interval):
    return interval and (interval["low"], interval["high"])


def counted(of, cell):
    """What no outcome of a campaign is: counted, or reckoned run by run."""
    name, runs = cell["name"], of.runs[cell["name"]]
    if of.preset == "huo2008-printed":
        yield from shares_and_gaps(of, name, [run["gap"] for run in runs])
    elif of.preset == "huo2008-integer-programming":
        yield of.row(name, "share proven", *share(sum(run.get("gap") == 0 for run in runs), len(runs)))
    elif of.preset == "huo2008-confirmation":
        yield of.row(name, "false tuples", *mean(false_tuples(runs)))
        other = cell.get("compared_with")
        if other and other != name:
            pairs = zip(false_tuples(runs), false_tuples(of.runs[other]))
            yield of.row(name, f"false tuples, less {other}", *mean([one - two for one, two in pairs]))
    elif of.preset == "huo2008-alpha":
        found = cell["outcomes"]["recall"]
        low, high = ends(found["interval"])
        yield of.row(name, "true pairs rejected", 1 - found["mean"], (1 - high, 1 - low), found["count"])


def shares_and_gaps(of, name, gaps):
    yield of.row(name, "share at the optimum", *share(sum(gap == 0 for gap in gaps), len(gaps)))
    yield of.row(name, "J above the optimum", *mean(gaps))


def false_tuples(runs):
    return [run["tuples"] - run["true tuples"] for run in runs]


def mean(numbers):
    """Mean, t interval and count."""
    middle, count = statistics.fmean(numbers), len(numbers)
    half = t_quantile(count - 1) * statistics.stdev(numbers) / math.sqrt(count)
    return middle, (middle - half, middle + half), count


def share(successes, count):
    """Share, Wilson's interval and count."""
    z = statistics.NormalDist().inv_cdf(0.975)
    p, grown = successes / count, 1 + z * z / count
    half = z * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count)) / grown
    centre = (p + z * z / (2 * count)) / grown
    return p, (max(0.0, centre - half), min(1.0, centre + half)), count


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
