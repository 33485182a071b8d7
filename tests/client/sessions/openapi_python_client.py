"""A session with the client of openapi-python-client: upload, associate, evaluate, report, a refusal, cancel.

Every answer is read through the client's types; an untyped one fails.
"""

import io
import json
import sys
import time
from pathlib import Path

from trackloom_client import Client
from trackloom_client.api.catalogue import get_preset, list_methods
from trackloom_client.api.datasets import download_dataset, get_dataset, list_datasets, upload_dataset, upload_raw_dataset
from trackloom_client.api.jobs import (
    cancel_job,
    create_associate_job,
    create_evaluate_job,
    create_job,
    create_simulate_job,
    get_job,
    get_job_history,
    get_job_spec,
    list_jobs,
    validate_job,
)
from trackloom_client.api.sessions import (
    begin_session_track,
    close_session,
    create_session,
    get_session_history,
    list_session_tracks,
    pause_session,
    push_scans,
    resume_session,
)
from trackloom_client.api.results import get_job_plan, get_job_report, get_job_series, list_job_artifacts
from trackloom_client.models import (
    AssociateReport,
    AssociateRequest,
    DatasetInfo,
    DatasetKind,
    DatasetMeta,
    DatasetSource,
    DatasetSourceSource,
    DatasetUpload,
    DoneEvent,
    EvaluateReport,
    EvaluateRequest,
    EvaluateSpec,
    EvaluateSpecKind,
    HandTrack,
    Job,
    JobSource,
    JobSourceSource,
    JobState,
    LiveTrack,
    NearestNeighbour,
    NearestNeighbourMethod,
    PlanView,
    Problem,
    PushedDetection,
    PushedScan,
    SensorSettings,
    SessionEventKind,
    SessionInfo,
    SessionRequest,
    SessionState,
    SimulateRequest,
    TfaVerdict,
    TrackerSettings,
    TrackProbabilitySeries,
    UploadOrigin,
    UploadRawDatasetKind,
    ValidationResult,
)
from trackloom_client.types import File

DATA = Path(__file__).parent.parent / "data"
DETECTIONS = (DATA / "detections.csv").read_text()
TRUTH = (DATA / "truth.csv").read_text()


def typed(answer, kind):
    assert isinstance(answer, kind), f"expected {kind.__name__}, got {answer!r}"
    return answer


def upload(client, name, text, **meta):
    body = DatasetUpload(
        file=File(payload=io.BytesIO(text.encode()), file_name=name, mime_type="text/csv"),
        meta=DatasetMeta(name=name, **meta),
    )
    return typed(upload_dataset.sync(client=client, body=body), DatasetInfo)


def upload_raw(client, name, text, **query):
    body = File(payload=io.BytesIO(text.encode()), file_name=name, mime_type="application/octet-stream")
    return typed(upload_raw_dataset.sync(client=client, body=body, name=name, **query), DatasetInfo)


def ended(client, job):
    """The job as soon as it has ended, by asking again and again."""
    typed(job, Job)
    for _ in range(300):
        if job.state not in (JobState.QUEUED, JobState.RUNNING):
            return job
        time.sleep(0.1)
        job = typed(get_job.sync(client=client, id=job.id), Job)
    raise AssertionError(f"the job does not end: {job}")


def dataset(info):
    return DatasetSource(source=DatasetSourceSource.DATASET, dataset_id=info.id)


def output_of(job):
    return JobSource(source=JobSourceSource.JOB, job_id=job.id)


def upload_and_find(client):
    radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
    detections = upload(client, "detections.csv", DETECTIONS, sensors=[radar])
    truth = upload_raw(client, "truth.csv", TRUTH, kind=UploadRawDatasetKind.TRUTH)
    assert (detections.kind, detections.rows, detections.scans) == (DatasetKind.DETECTIONS, 24, 12)
    assert (truth.kind, truth.objects) == (DatasetKind.TRUTH, 2)
    assert typed(detections.origin, UploadOrigin).file_name == "detections.csv"
    assert detections.sensors[0].p_d == 0.95
    assert get_dataset.sync(client=client, id=detections.id) == detections
    listed = list_datasets.sync(client=client, kind="truth", count=True)
    assert listed.total == 1 and listed.items[0].id == truth.id
    assert typed(download_dataset.sync(client=client, id=truth.id), File).payload.read() == TRUTH.encode()
    return detections, truth


def associate(client, detections):
    method = NearestNeighbour(method=NearestNeighbourMethod.NEAREST_NEIGHBOUR)
    tracker = TrackerSettings(initial_speed_sigma_mps=60.0)
    body = AssociateRequest(input_=dataset(detections), associator=method, tracker=tracker, name="from python", seed=5)
    queued = typed(create_associate_job.sync(client=client, body=body), Job)
    job = ended(client, queued)
    assert job.state == JobState.SUCCEEDED and job.seed == 5 and job.name == "from python", job
    report = typed(get_job_report.sync(client=client, id=job.id), AssociateReport)
    assert report.spec.seed == 5
    assert report.result.association.counts.detections == 24
    assert len(report.result.association.tracks) == 2
    return job


def evaluate(client, associated, truth):
    body = EvaluateRequest(tracks=output_of(associated), truth=dataset(truth))
    job = typed(create_evaluate_job.sync(client=client, body=body, prefer="wait=30"), Job)
    job = ended(client, job)
    assert job.state == JobState.SUCCEEDED, job
    report = typed(get_job_report.sync(client=client, id=job.id), EvaluateReport)
    counts = report.result.tfa.counts
    assert (counts.targets, counts.correct, counts.missed, counts.false_) == (2, 2, 0, 0), counts
    assert [target.verdict for target in report.result.tfa.targets] == [TfaVerdict.CORRECT, TfaVerdict.CORRECT]
    assert report.result.tfa.probability.correct == 1.0
    return job


def ask_again(client, job):
    """The job as it is given out is the job as it is asked for."""
    spec = typed(get_job_spec.sync(client=client, id=job.id), EvaluateSpec)
    assert spec.kind == EvaluateSpecKind.EVALUATE
    assert typed(validate_job.sync(client=client, body=spec), ValidationResult).valid
    again = typed(create_job.sync(client=client, body=spec), Job)
    assert ended(client, again).duplicate_of == job.id


def look(client, job):
    plan = typed(get_job_plan.sync(client=client, id=job.id), PlanView)
    assert len(plan.tracks.columns.x_m) == plan.tracks.returned_points > 0
    series = typed(get_job_series.sync(client=client, id=job.id, name="track_probability", max_points=10), TrackProbabilitySeries)
    assert series.returned_points <= 10
    names = [item.name for item in list_job_artifacts.sync(client=client, id=job.id).items]
    assert "report.json" in names and "tracks.csv" in names, names
    history = get_job_history.sync(client=client, id=job.id)
    assert [event.seq for event in history.events] == list(range(1, len(history.events) + 1))
    assert typed(history.events[-1], DoneEvent).data.state == JobState.SUCCEEDED
    assert typed(get_preset.sync(client=client, name="liang2009-10").name, str) == "liang2009-10"
    assert [family.family for family in list_methods.sync(client=client).families] == ["associator", "filter", "grouper", "correlator"]


def be_refused(client, detections):
    radar = SensorSettings(sensor_id="radar", p_d=1.5)
    answer = create_associate_job.sync_detailed(
        client=client, body=AssociateRequest(input_=dataset(detections), sensors=[radar], seed=-1)
    )
    assert answer.status_code == 422
    problem = typed(answer.parsed, Problem)
    assert problem.code == "validation" and problem.type_ == "/problems/validation"
    assert {fault.pointer: fault.code for fault in problem.errors} == {
        "/seed": "out_of_range",
        "/sensors/0/p_d": "out_of_range",
    }, problem


def cancel(client):
    body = json.loads(SCENARIO)
    queued = typed(create_simulate_job.sync(client=client, body=SimulateRequest.from_dict(body)), Job)
    asked = typed(cancel_job.sync(client=client, id=queued.id), Job)
    assert not asked.can_cancel
    assert ended(client, asked).state == JobState.CANCELED
    again = cancel_job.sync_detailed(client=client, id=queued.id)
    assert again.status_code == 409 and typed(again.parsed, Problem).code == "job_terminal"
    assert list_jobs.sync(client=client, state="canceled", count=True).total == 1


def live(client):
    """A live session: scans in, tracks and events out, closed into a job."""
    radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
    body = SessionRequest(sensors=[radar], tracker=TrackerSettings(initial_speed_sigma_mps=60.0), name="live")
    session = typed(create_session.sync(client=client, body=body), SessionInfo)
    for index in range(4):
        scan = PushedScan(sensor_id="radar", sequence=index, time_s=2.0 * index, detections=[PushedDetection(x_m=100.0 * index, y_m=5.0)])
        pushed = push_scans.sync(client=client, id=session.id, body=scan)
        assert (pushed.scans[0].fate, pushed.processed_to_s) == ("taken", 2.0 * index), pushed
    twice = push_scans.sync(client=client, id=session.id, body=scan)
    assert (twice.scans[0].fate, twice.entries) == ("duplicate", 4), twice
    tracks = list_session_tracks.sync(client=client, id=session.id, at_s=8.0).tracks
    assert len(tracks) == 1 and abs(tracks[0].x_m - 400.0) < 10.0 and tracks[0].status == "confirmed", tracks
    kinds = [event.kind for event in get_session_history.sync(client=client, id=session.id).items]
    assert kinds == [SessionEventKind.STARTED, SessionEventKind.CONFIRMED], kinds
    hand = HandTrack(x_m=9000.0, y_m=0.0, sigma_m=30.0, sigma_mps=5.0)
    assert typed(begin_session_track.sync(client=client, id=session.id, body=hand), LiveTrack).track_id == "2"
    assert pause_session.sync(client=client, id=session.id).live.is_paused
    refused = push_scans.sync_detailed(client=client, id=session.id, body=scan)
    assert refused.status_code == 409 and typed(refused.parsed, Problem).code == "session_paused", refused
    assert not resume_session.sync(client=client, id=session.id).live.is_paused
    closed = typed(close_session.sync(client=client, id=session.id), SessionInfo)
    assert closed.state == SessionState.CLOSED
    assert ended(client, get_job.sync(client=client, id=closed.job_id)).state == JobState.SUCCEEDED


SCENARIO = """
{"scenario": {"scans": 100000, "scan_period_s": 1.0,
  "sensors": [{"sensor_id": "radar", "max_range_m": 20000, "p_d": 0.9, "sigma_x_m": 30, "sigma_y_m": 30, "clutter_per_scan": 100}],
  "targets": {"kind": "random", "count": 10, "area_side_m": 10000, "speed_min_mps": 1, "speed_max_mps": 2}}}
"""


def main():
    client = Client(base_url=sys.argv[1], timeout=60.0)
    detections, truth = upload_and_find(client)
    associated = associate(client, detections)
    judged = evaluate(client, associated, truth)
    ask_again(client, judged)
    look(client, judged)
    be_refused(client, detections)
    cancel(client)
    live(client)
    print("openapi-python-client: ok")


main()
