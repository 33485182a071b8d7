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
from scipy.stats import t as student
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


def mean_gospa(truth, tracks, range_m=math.inf):
    """Stone Soup's own metric is the judge of both, mean over the scans; only what is within `range_m` of the radar counts."""

    def at(stamp, positions):
        near = [(x, y) for x, y in positions.get(stamp, []) if math.hypot(x, y) <= range_m]
        return [State(np.array([[x], [y]]), timestamp=stamp) for x, y in near]

    return statistics.fmean(JUDGE.compute_gospa_metric(at(stamp, tracks), at(stamp, truth))[0].value["distance"] for stamp in truth)


def both_gospas(truth, tracks, settings):
    """Of everything, and of what the radar can see: there a track that coasts on behind a target that has left is not false."""
    return mean_gospa(truth, tracks), mean_gospa(truth, tracks, settings["max_range_m"])


def compare(binary, targets, seed, is_every_way):
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
            for variant in stone_soup.VARIANTS[method] if is_every_way else stone_soup.VARIANTS[method][:1]:
                stone_soup.run(method, variant, settings, scans[:3])
                their_seconds, their_tracks = stone_soup.run(method, variant, settings, scans)
                theirs.append((variant[0].__name__, their_seconds, both_gospas(truth, their_tracks, settings)))
            found[method] = (seconds, both_gospas(truth, tracks, settings), theirs)
    return found


def print_times(results):
    print(f"\n{'method':<26}{'trackloom s':>13}  {'Stone Soup':<22}{'s':>9}{'ratio':>9}")
    for method in results[0]:
        ours = statistics.median(result[method][0] for result in results)
        for way, (name, _, _) in enumerate(results[0][method][2]):
            theirs = statistics.median(result[method][2][way][1] for result in results)
            print(f"{method:<26}{ours:>13.6f}  {name:<22}{theirs:>9.3f}{theirs / ours:>9.0f}")


def print_quality(results, kind, title):
    print(f"\nGOSPA {title}, {len(results)} seeds")
    print(f"{'method':<26}{'Stone Soup':<22}{'ours':>9}{'theirs':>9}{'difference':>12}  95 % interval of the mean difference")
    for method in results[0]:
        for way, (name, _, _) in enumerate(results[0][method][2]):
            ours = [result[method][1][kind] for result in results]
            theirs = [result[method][2][way][2][kind] for result in results]
            differences = [our - their for our, their in zip(ours, theirs)]
            mean, half = statistics.fmean(differences), math.nan
            if len(results) > 1:
                half = student.ppf(0.975, len(results) - 1) * statistics.stdev(differences) / math.sqrt(len(results))
            print(
                f"{method:<26}{name:<22}{statistics.fmean(ours):>9.1f}{statistics.fmean(theirs):>9.1f}{mean:>12.2f}"
                f"  [{mean - half:.2f}, {mean + half:.2f}]"
            )


def main():
    binary, targets, first, last = sys.argv[1], *map(int, sys.argv[2:5])
    is_every_way = "every-way" in sys.argv[5:]
    print(f"Liang's scene, {targets} targets, seeds {first} to {last}; GOSPA with c = {CUTOFF_M:.0f} m, p = 2, mean over the scans")
    results = []
    for seed in range(first, last + 1):
        results.append(compare(binary, targets, seed, is_every_way))
        line = ", ".join(f"{method} {ours[1]:.1f} / {theirs[0][2][1]:.1f}" for method, (_, ours, theirs) in results[-1].items())
        print(f"seed {seed}, GOSPA within the radar's range, ours / theirs: {line}", flush=True)
    print_times(results)
    print_quality(results, 0, "of everything")
    print_quality(results, 1, "within the radar's range")


if __name__ == "__main__":
    main()
