"""What docs/papers.md says of Liang, Liu: numbers of the campaigns, and what the program itself is measured at."""

import csv
import json
import math
import os
import statistics
import subprocess
import tempfile
from collections import defaultdict
from pathlib import Path

from campaign import Campaign, mean, t_quantile

CAMPAIGNS = ["liang2009-table1", "liang2009-clutter", "liang2009-beginnings"]
# Seconds of the paper's Table 1: targets, NN, PDA, JPDA.
TABLE_1 = [(10, 0.52, 0.60, 0.67), (30, 1.62, 1.84, 2.05), (50, 2.56, 2.83, 3.14),
           (80, 4.12, 4.23, 4.40), (100, 5.25, 5.36, 5.52)]
SEEDS = 20


def campaign_rows(folder):
    """Of the campaigns that `trackloom run --preset papers` leaves in a folder."""
    for preset in CAMPAIGNS:
        of = Campaign.of(folder, preset)
        for cell in of.cells:
            yield from of.outcomes(cell, dict.fromkeys(cell["outcomes"], True))
    yield from jpda_beside_pda(Campaign.of(folder, CAMPAIGNS[0]))


def jpda_beside_pda(of):
    """What the differences to NN do not say."""
    runs = of.runs()
    for targets, *_ in TABLE_1:
        cell, other = f"{targets}, JPDA", f"{targets}, PDA"
        differences = [one["P correct"] - two["P correct"] for one, two in zip(runs[cell], runs[other])]
        yield of.row(cell, f"P correct, less {other}", *mean(differences))
        yield of.row(cell, f"runs that differ from {other}", sum(map(bool, differences)), None, len(differences))


def of_jobs(trackloom):
    """The paper's own times and how they grow, memory, and errors around a switch."""
    with tempfile.TemporaryDirectory() as folder:
        program = Program(trackloom, Path(folder))
        for found in (published(), memory(program), around_switches(program)):
            for table, cell, quantity, value, low, high, runs in found:
                interval = None if low is None else (low, high)
                yield Campaign(f"liang2009-{table}", 1).row(cell, quantity, value, interval, runs)


class Program:
    """Runs jobs in Liang's scene."""

    def __init__(self, trackloom, folder):
        self.trackloom = trackloom
        self.folder = folder
        body = self.call("presets", "liang2009-table1")
        self.base = json.loads(body)["base"]

    def call(self, *arguments):
        return subprocess.run([self.trackloom, *arguments], check=True, capture_output=True, text=True).stdout

    def run(self, targets, seed=1, density=1):
        """The folder of files and the peak of memory (MB)."""
        body = json.loads(json.dumps(self.base)) | {"seed": seed, "associator": {"method": "nearest_neighbour"}}
        scenario, scale = body["input"]["scenario"], max(1.0, targets / 100 / density)
        scenario["targets"]["count"] = targets
        scenario["targets"]["area_side_m"] *= math.sqrt(scale)
        scenario["sensors"][0]["max_range_m"] *= math.sqrt(scale)
        scenario["sensors"][0]["clutter_per_scan"] *= scale * density
        path, out = self.folder / "job.json", self.folder / "out"
        path.write_text(json.dumps(body))
        child = subprocess.Popen([self.trackloom, "run", str(path), "--out", str(out)],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        assert status == 0, status
        return out, usage.ru_maxrss / 1e3


def published():
    """Seconds of the paper's Table 1, and what they are to those of NN."""
    for targets, *times in TABLE_1:
        for method, time in zip(("NN", "PDA", "JPDA"), times):
            yield "published", f"{targets}, {method}", "s", time, None, None, 1
            yield "published", f"{targets}, {method}", "to NN", time / times[0], None, None, 1
    for place, method in enumerate(("NN", "PDA", "JPDA")):
        found = slope([line[0] for line in TABLE_1], [line[1 + place] for line in TABLE_1])
        yield "published", f"10 to 100, {method}", "slope", *found, len(TABLE_1)


def memory(program):
    counts = [100, 1000, 10000, 30000]
    peaks = [program.run(targets)[1] for targets in counts]
    for targets, peak in zip(counts, peaks):
        yield "space", f"{targets} targets", "peak MB", peak, None, None, 1
    found, *_ = slope(counts[1:], peaks[1:])
    yield "space", "1000 to 30000 targets", "slope", found, None, None, 1
    kilobytes = (peaks[-1] - peaks[1]) / (counts[-1] - counts[1]) * 1e3
    yield "space", "1000 to 30000 targets", "kB a further target", kilobytes, None, None, 1


def around_switches(program):
    """Position error (m) of tracks before and after their first detection of another target or of clutter, at ten times the
    paper's density; at the paper's how many tracks there are with one."""
    errors = defaultdict(list)
    for seed in range(1, SEEDS + 1):
        out, _ = program.run(1000, seed, density=10)
        for offset, error in switches(out):
            errors[offset].append(error)
    wrong = sum(offset == 0 for seed in range(1, SEEDS + 1) for offset, _ in switches(program.run(100, seed)[0]))
    yield "switches", "density of the paper", "tracks with a wrong detection", wrong, None, None, SEEDS
    for offset in sorted(errors):
        yield "switches", f"{offset:+d} scans", "median error m", *middle(errors[offset])


def switches(out):
    origin = {row["detection_id"]: row["truth_id"] for row in table(out / "detections.csv")}
    truth = {(row["truth_id"], row["time_s"]): place(row) for row in table(out / "truth.csv")}
    tracks = defaultdict(list)
    for row in table(out / "tracks.csv"):
        tracks[row["track_id"]].append(row)
    for points in tracks.values():
        points = [row for row in points if float(row["probability"] or 1) > 0.5]
        owners = [origin.get(row["detection_id"]) if row["detection_id"] else None for row in points]
        target = next((owner for owner in owners if owner), None)
        wrong = next((k for k, row in enumerate(points) if row["detection_id"] and owners[k] != target), None)
        if wrong is None or wrong < 3:
            continue
        for k in range(wrong - 2, min(wrong + 4, len(points))):
            at = truth.get((target, points[k]["time_s"]))
            if at:
                yield k - wrong, math.dist(at, place(points[k]))


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def place(row):
    return float(row["x_m"]), float(row["y_m"])


def slope(xs, ys):
    """Of log over log, with its 95 % interval."""
    xs, ys = [math.log(x) for x in xs], [math.log(y) for y in ys]
    found, offset = statistics.linear_regression(xs, ys)
    left = sum((y - offset - found * x) ** 2 for x, y in zip(xs, ys))
    degrees, spread = len(xs) - 2, statistics.pvariance(xs) * len(xs)
    half = t_quantile(degrees) * math.sqrt(left / degrees / spread)
    return found, found - half, found + half


def middle(values):
    """Median with the order statistics that hold it with 95 %."""
    ordered, half = sorted(values), 0.98 * math.sqrt(len(values))
    low, high = (round(len(values) / 2 + side * half) for side in (-1, 1))
    return statistics.median(ordered), ordered[max(low, 0)], ordered[min(high, len(ordered) - 1)], len(values)
