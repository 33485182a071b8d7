"""A session with the package of examples/python. Usage: session.py ADDRESS FOLDER"""

import sys
from pathlib import Path

import pandas as pd
import pytest
import trackloom

RADAR = {"sensor_id": "radar", "p_d": 0.95, "clutter_per_m2": 1e-9, "sigma_x_m": 10, "sigma_y_m": 10}


def track(service: trackloom.Service, folder: Path) -> trackloom.Job:
    """From a data frame to a data frame; names of numbers stay names."""
    frame = pd.read_csv(folder / "detections.csv")
    recording = service.upload(frame, name="trial 7", sensors=[RADAR])
    assert (recording.info["rows"], recording.info["scans"], recording.info["name"]) == (24, 12, "trial 7")
    assert len(recording.table()) == 24
    told: list[str] = []
    job = service.submit({"kind": "associate", "input": recording.source, "seed": 5}, name="from python")
    job.wait(progress=lambda info: told.append(info["state"]))
    assert job.state == "succeeded" and (not told or told[-1] == "succeeded")
    tracks = job.table("tracks.csv")
    assert tracks["track_id"].nunique() == 2 and tracks["track_id"].dtype == "string"
    assert len(tracks) == sum(track["points"] for track in job.result["association"]["tracks"])
    assert job.result["association"]["counts"]["detections"] == 24
    return job


def judge(service: trackloom.Service, tracked: trackloom.Job, folder: Path, tmp: Path) -> trackloom.Job:
    truth = service.upload(folder / "truth.csv", kind="truth")
    request = {"kind": "evaluate", "tracks": tracked.source, "truth": truth.source, "metrics": [{"metric": "clear"}]}
    request["limits"] = [{"quantity": "clear.recall", "at_least": 0.5}]
    job = service.run(request)
    assert job.met is True
    metrics = job.metrics().set_index(["metric", "quantity"])
    clear = job.result["metrics"]["clear"]
    assert metrics.loc[("clear", "mota"), "value"] == clear["value"]
    request["limits"] = [{"quantity": "clear.recall", "at_least": 1.1}]
    assert service.run(request).met is False
    shown = job._repr_html_()
    assert shown is not None and "srcdoc=" in shown and "&lt;html" in shown
    assert job.save("report.json", tmp).read_bytes().startswith(b"{")
    assert "tracks.csv" in tracked.artifacts()
    return job


def be_refused(service: trackloom.Service, tracked: trackloom.Job) -> None:
    with pytest.raises(trackloom.Refused) as refused:
        service.run({"kind": "associate", "input": tracked.source, "seed": -1})
    assert refused.value.code == "validation" and refused.value.status == 422
    assert "/seed" in [fault.pointer for fault in refused.value.faults]
    assert "/seed" in str(refused.value)
    with pytest.raises(trackloom.Refused) as refused:
        service.upload(b"time_s,scan,x_m,y_m\n0,1,five,0\n")
    assert refused.value.faults[0].line == 2


def find(service: trackloom.Service, tracked: trackloom.Job) -> None:
    """More than a page of them, each once."""
    request = service.preset("two-radars")
    assert request["kind"] in {"evaluate", "correlate", "associate"}
    one = {"scans": 2, "scan_period_s": 1, "sensors": [{"max_range_m": 1000, "sigma_x_m": 1, "sigma_y_m": 1}]}
    one["targets"] = {"kind": "random", "count": 1, "area_side_m": 100, "speed_min_mps": 1, "speed_max_mps": 2}
    made = [service.submit({"kind": "simulate", "scenario": one, "seed": seed}, labels={"of": "find"}) for seed in range(5)]
    found = [job.id for job in service.jobs(label="of:find", limit=2)]
    assert sorted(found) == sorted(job.id for job in made)
    assert service.job(tracked.id).info["name"] == "from python"
    for job in made:
        job.wait()
    compared = service.compare(made[0], made[1])
    assert len(compared["jobs"]) == 2
    made[0].delete()
    with pytest.raises(trackloom.Refused) as refused:
        service.job(made[0].id)
    assert refused.value.status in (404, 410)
    big = dict(one, scans=100_000, targets=dict(one["targets"], count=50))
    running = service.submit({"kind": "simulate", "scenario": big})
    running.cancel()
    with pytest.raises(trackloom.JobFailed):
        running.wait()


def main() -> None:
    service = trackloom.Service(sys.argv[1])
    folder = Path(sys.argv[2])
    assert service.version()
    tracked = track(service, folder)
    judge(service, tracked, folder, Path(sys.argv[3]))
    be_refused(service, tracked)
    find(service, tracked)


main()
