"""The fixed jobs: every preset, every job file of the examples, recordings."""

import json
import os
import subprocess
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]

# Runs of each cell of a campaign: the presets' own take minutes.
CAMPAIGN_RUNS = 2

# Origins and amplitudes are not in a recording.
ASSOCIATORS_WITHOUT_RECORDINGS = {"oracle", "strongest_neighbour"}


class Job(NamedTuple):
    """What `trackloom run` is told, apart from where to write."""
    group: str
    name: str
    arguments: list


def told(program, *words):
    """What the program says as JSON."""
    return json.loads(subprocess.run([program, *words], check=True, capture_output=True).stdout)


def presets(program):
    jobs = []
    for preset in told(program, "presets", "--json"):
        runs = ["--runs", str(CAMPAIGN_RUNS)] if preset["kind"] == "campaign" else []
        jobs.append(Job("presets", preset["name"], ["--preset", preset["name"], *runs]))
    return jobs


def examples():
    files = sorted((ROOT / "examples").glob("*.json"))
    return [Job("examples", path.stem, [str(path)]) for path in files]


def recordings(program, folder):
    """Jobs on the files of the tests, and on those of `$TRACKLOOM_DATA` where it is set."""
    bodies = dict(client_files())
    data = os.environ.get("TRACKLOOM_DATA")
    if data:
        associators = recording_associators(program)
        for detections in sorted(Path(data, "autoferry").glob("scenario*_detections.json")):
            bodies.update(autoferry(detections, associators))
        bodies.update(vision(Path(data, "mot-tud", "TUD-Campus")))
    return [written(folder, "recordings", name, body) for name, body in bodies.items()]


def recording_associators(program):
    for family in told(program, "methods", "--json")["families"]:
        if family["family"] == "associator":
            names = [method["name"] for method in family["methods"]]
            return [name for name in names if name not in ASSOCIATORS_WITHOUT_RECORDINGS]
    raise SystemExit("goldens: the catalogue has no associators")


def written(folder, group, name, body):
    """A job whose request is a file in `folder`."""
    path = Path(folder, f"{group}-{name}.json")
    path.write_text(json.dumps(body))
    return Job(group, name, [str(path)])


def client_files():
    folder = ROOT / "tests" / "client" / "data"
    detections, truth = (file(folder / f"{name}.csv") for name in ("detections", "truth"))
    sensor = {"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-8,
              "sigma_x_m": 10, "sigma_y_m": 10}
    for method in ("oracle", "jpda"):
        yield f"client-{method}", {
            "kind": "evaluate", "input": detections, "truth": truth, "sensors": [sensor],
            "associator": {"method": method}}


def file(path, **options):
    return {"source": "file", "path": str(path), **options}


def autoferry(detections, associators):
    """A scenario of Autoferry: the radar against the boats, both cameras, radar beside lidar."""
    name = detections.name.removesuffix("_detections.json")
    truth = file(detections.with_name(f"{name}_groundTruth.json"), format="autoferry")
    for method in associators:
        yield f"{name}-radar-{method}", {
            "kind": "evaluate", **tracked(detections, ["radar"], method), "truth": truth,
            "comparison": {"gate_m": 30},
            "metrics": [{"metric": "gospa", "cutoff_m": 30}, {"metric": "clear"},
                        {"metric": "kinematics"}],
            "tfa": {"symbols": {"kind": "nearest_truth", "gate_m": 30, "max_gap_s": 5},
                    "max_missed": 5}}
    for camera in ("daylight", "infrared"):
        yield f"{name}-{camera}", {"kind": "associate", **seen_by(camera, detections)}
    yield f"{name}-radar-lidar", {
        "kind": "correlate", **tracked(detections, ["radar", "lidar"], "pda"), "truth": truth,
        "alignment": {"period_s": 1, "max_gap_s": 3}, "correlator": {"method": "lagrangian"}}


def tracked(detections, sensor_ids, method):
    sensors = [{"sensor_id": sensor_id, "p_d": 0.9, "clutter_per_m2": 1e-5,
                "sigma_x_m": 4, "sigma_y_m": 4} for sensor_id in sensor_ids]
    return {
        "input": file(detections, format="autoferry", sensor_ids=sensor_ids),
        "sensors": sensors, "associator": {"method": method},
        "filter": {"method": "kalman", "process_noise_m2ps3": 0.05},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8,
                    "max_missed": 5, "initial_speed_sigma_mps": 3}}


def seen_by(camera, detections):
    sensor = {"sensor_id": camera, "p_d": 0.7, "clutter_per_deg": 0.01, "sigma_bearing_deg": 2}
    return {
        "input": file(detections, format="autoferry", sensor_ids=[camera]),
        "sensors": [sensor], "associator": {"method": "jpda"},
        "filter": {"method": "bearing_only", "process_noise_deg2ps3": 0.05,
                   "initial_rate_sigma_degps": 1.5},
        "tracker": {"gate_probability": 0.99, "confirm_hits": 6, "confirm_window": 8,
                    "max_missed": 15}}


def vision(folder):
    if (folder / "gt.txt").exists():
        yield "tud-campus", {
            "kind": "evaluate", "profile": "vision", "truth": file(folder / "gt.txt"),
            "tracks": file(folder / "test.txt")}
