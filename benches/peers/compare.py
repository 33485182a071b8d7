"""Time and quality of trackloom and of Stone Soup on the same simulated detections, side by side."""

import csv
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import stone_soup
from scipy.optimize import linear_sum_assignment

CUTOFF_M = 1000.0
METHODS = ["nearest_neighbour", "global_nearest_neighbour", "pda", "jpda"]


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def gospa(truth, tracks):
    """GOSPA with p = 2, alpha = 2 (Rahmathullah et al. 2017)."""
    unmatched = CUTOFF_M**2 / 2
    if not truth or not tracks:
        return math.sqrt(unmatched * (len(truth) + len(tracks)))
    squared = ((np.array(truth)[:, None, :] - np.array(tracks)[None, :, :]) ** 2).sum(axis=2)
    squared = np.minimum(squared, 2 * unmatched)
    rows, columns = linear_sum_assignment(squared)
    return math.sqrt(squared[rows, columns].sum() + unmatched * abs(len(truth) - len(tracks)))


def mean_gospa(truth, tracks):
    return statistics.fmean(gospa(truth.get(time_s, []), tracks.get(time_s, [])) for time_s in truth)


def by_time(rows, wanted=lambda row: True):
    """Positions at each time, one a row that is wanted; several candidates of a track point are one point."""
    seen, positions = set(), {}
    for row in filter(wanted, rows):
        key = (row["time_s"], row.get("track_id", row.get("truth_id")))
        if key not in seen:
            seen.add(key)
            positions.setdefault(float(row["time_s"]), []).append((float(row["x_m"]), float(row["y_m"])))
    return positions


def trackloom(binary, folder, job):
    """The report and the tables of one run."""
    path = pathlib.Path(folder) / "job.json"
    path.write_text(json.dumps(job))
    subprocess.run([binary, "run", path, "--out", folder, "--format", "json"], check=True, stdout=subprocess.DEVNULL)
    report = json.loads((pathlib.Path(folder) / "report.json").read_text())
    return report, *(rows_of(pathlib.Path(folder) / f"{name}.csv") for name in ("detections", "truth", "tracks"))


def settings_of(job, sensor):
    gate = job["tracker"]["gate_probability"]
    return {
        "sigma_x_m": sensor["sigma_x_m"],
        "sigma_y_m": sensor["sigma_y_m"],
        "p_d": sensor["p_d"],
        "clutter_per_m2": sensor["clutter_per_m2"],
        "q": job["filter"]["process_noise_m2ps3"],
        "gate_probability": gate,
        "gate_distance": math.sqrt(-2 * math.log(1 - gate)),
        **job["tracker"],
    }


def compare(binary, method, targets, seed):
    preset = subprocess.run([binary, "presets", f"liang2009-{targets}"], check=True, capture_output=True, text=True).stdout
    job = json.loads(preset) | {"seed": seed, "associator": {"method": method}}
    with tempfile.TemporaryDirectory() as folder:
        report, detections, truth_rows, track_rows = trackloom(binary, folder, job)
    truth = by_time(truth_rows)
    ours = by_time(track_rows, lambda row: row["status"] != "tentative")
    seconds, theirs = stone_soup.run(method, settings_of(job, report["result"]["association"]["sensors"][0]), detections)
    return report["timing"]["associate_s"], mean_gospa(truth, ours), seconds, mean_gospa(truth, theirs)


def main():
    binary, targets, seeds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    known = subprocess.run([binary, "methods"], check=True, capture_output=True, text=True).stdout
    names = {method["name"] for family in json.loads(known)["families"] for method in family["methods"]}
    print(f"Liang's scene, {targets} targets, {seeds} seeds; mean GOSPA with c = {CUTOFF_M:.0f} m, p = 2; medians of seconds")
    print(f"{'method':<26}{'trackloom s':>13}{'Stone Soup s':>14}{'ratio':>10}{'GOSPA ours':>12}{'theirs':>10}{'difference':>20}")
    for method in filter(names.__contains__, METHODS):
        ours_s, ours, theirs_s, theirs = zip(*(compare(binary, method, targets, seed) for seed in range(1, seeds + 1)))
        differences = [our - their for our, their in zip(ours, theirs)]
        spread = 1.96 * statistics.stdev(differences) / math.sqrt(seeds) if seeds > 1 else math.nan
        ratio = statistics.median(theirs_s) / statistics.median(ours_s)
        print(
            f"{method:<26}{statistics.median(ours_s):>13.6f}{statistics.median(theirs_s):>14.3f}{ratio:>10.0f}"
            f"{statistics.fmean(ours):>12.1f}{statistics.fmean(theirs):>10.1f}{statistics.fmean(differences):>12.1f} ± {spread:.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
