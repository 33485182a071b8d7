"""Time and quality of trackloom and of Stone Soup on the same simulated detections, side by side."""

import csv
import datetime
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import stone_soup
from stonesoup.metricgenerator.ospametric import GOSPAMetric
from stonesoup.types.state import State

CUTOFF_M = 1000.0
JUDGE = GOSPAMetric(p=2, c=CUTOFF_M)


def positions_of(path, wanted=lambda row: True):
    """Positions at each time, one a row that is wanted; several candidates of a track point are one point."""
    seen, positions = set(), {}
    with open(path, newline="") as file:
        for row in filter(wanted, csv.DictReader(file)):
            key = (row["time_s"], row.get("track_id", row.get("truth_id")))
            if key not in seen:
                seen.add(key)
                stamp = stone_soup.EPOCH + datetime.timedelta(seconds=float(row["time_s"]))
                positions.setdefault(stamp, []).append((float(row["x_m"]), float(row["y_m"])))
    return positions


def mean_gospa(truth, tracks):
    """Stone Soup's own metric is the judge of both, mean over the scans."""

    def at(stamp, positions):
        return [State(np.array([[x], [y]]), timestamp=stamp) for x, y in positions.get(stamp, [])]

    return statistics.fmean(JUDGE.compute_gospa_metric(at(stamp, tracks), at(stamp, truth))[0].value["distance"] for stamp in truth)


def compare(binary, targets, seed, is_timed):
    """For each method our seconds and GOSPA, and for each way of Stone Soup's its name, seconds and GOSPA."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([binary, str(targets), str(seed), folder], check=True)
        ours = json.loads((folder / "ours.json").read_text())
        settings = stone_soup.settings_of(ours)
        truth = positions_of(folder / "truth.csv")
        scans = stone_soup.scans_of(folder / "detections.csv", settings)
        found = {}
        for method, seconds in ours["seconds"].items():
            tracks = positions_of(folder / f"{method}.csv", lambda row: row["status"] != "tentative")
            theirs = []
            for variant in stone_soup.VARIANTS[method] if is_timed else stone_soup.VARIANTS[method][:1]:
                stone_soup.run(method, variant, settings, scans[:3])
                their_seconds, their_tracks = stone_soup.run(method, variant, settings, scans)
                theirs.append((variant[0].__name__, their_seconds, mean_gospa(truth, their_tracks)))
            found[method] = (seconds, mean_gospa(truth, tracks), theirs)
    return found


def print_times(results):
    print(f"\n{'method':<26}{'trackloom s':>13}  {'Stone Soup':<22}{'s':>9}{'ratio':>9}{'GOSPA':>9}")
    for method in results[0]:
        ours = statistics.median(result[method][0] for result in results)
        for way in range(len(results[0][method][2])):
            name = results[0][method][2][way][0]
            theirs = statistics.median(result[method][2][way][1] for result in results)
            gospa = statistics.fmean(result[method][2][way][2] for result in results)
            print(f"{method:<26}{ours:>13.6f}  {name:<22}{theirs:>9.3f}{theirs / ours:>9.0f}{gospa:>9.1f}")


def print_quality(results):
    print(f"\n{'method':<26}{'GOSPA ours':>12}{'theirs':>10}{'difference':>13}  95 % interval of the mean difference, {len(results)} seeds")
    for method in results[0]:
        ours, theirs = ([get(result[method]) for result in results] for get in (lambda r: r[1], lambda r: r[2][0][2]))
        differences = [our - their for our, their in zip(ours, theirs)]
        mean, half = statistics.fmean(differences), math.nan
        if len(results) > 1:
            half = student_quantile(len(results) - 1) * statistics.stdev(differences) / math.sqrt(len(results))
        print(
            f"{method:<26}{statistics.fmean(ours):>12.1f}{statistics.fmean(theirs):>10.1f}{mean:>13.2f}"
            f"  [{mean - half:.2f}, {mean + half:.2f}]"
        )


def student_quantile(freedom):
    from scipy.stats import t

    return t.ppf(0.975, freedom)


def main():
    binary, targets, first, last = sys.argv[1], *map(int, sys.argv[2:5])
    is_timed = "times" in sys.argv[5:]
    print(f"Liang's scene, {targets} targets, seeds {first} to {last}; GOSPA with c = {CUTOFF_M:.0f} m, p = 2, mean over the scans", flush=True)
    results = []
    for seed in range(first, last + 1):
        results.append(compare(binary, targets, seed, is_timed))
        line = "  ".join(f"{method} {ours:.1f} / {theirs[0][2]:.1f}" for method, (_, ours, theirs) in results[-1].items())
        print(f"seed {seed}: GOSPA ours / theirs: {line}", flush=True)
    print_times(results)
    print_quality(results)


if __name__ == "__main__":
    main()
