"""A session with the Python client of openapi-generator: upload, associate, evaluate, wait, report, a typed refusal."""

import sys
from pathlib import Path

from openapi_client import ApiClient, Configuration, DatasetsApi, JobsApi, ResultsApi, SessionsApi
from openapi_client.exceptions import UnprocessableEntityException
from openapi_client.models import (
    AssociateRequest,
    Associator,
    DatasetInfo,
    DatasetSource,
    DataSource,
    EvaluateReport,
    EvaluateSpec,
    InputSource,
    Job,
    JobSource,
    JobSpec,
    JobState,
    NearestNeighbour,
    Problem,
    PushedDetection,
    PushedScan,
    SensorSettings,
    SessionRequest,
    SessionState,
    TrackerSettings,
)

DATA = Path(__file__).parent.parent / "data"


def typed(answer, kind):
    assert isinstance(answer, kind), f"expected {kind.__name__}, got {answer!r}"
    return answer


def upload(datasets, name, kind):
    return typed(datasets.upload_raw_dataset((DATA / name).read_bytes(), name=name, kind=kind), DatasetInfo)


def associate(jobs, detections):
    radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
    body = AssociateRequest(
        input=InputSource(DatasetSource(source="dataset", dataset_id=detections.id)),
        sensors=[radar],
        associator=Associator(NearestNeighbour(method="nearest_neighbour")),
        tracker=TrackerSettings(initial_speed_sigma_mps=60.0),
    )
    return succeeded(jobs.create_associate_job(body, prefer="wait=30"))


def succeeded(job):
    assert typed(job, Job).state == JobState.SUCCEEDED, job
    return job


def evaluate(jobs, associated, truth):
    tracks = DataSource(JobSource(source="job", job_id=associated.id))
    known = DataSource(DatasetSource(source="dataset", dataset_id=truth.id))
    spec = JobSpec(EvaluateSpec(kind="evaluate", tracks=tracks, truth=known))
    assert jobs.validate_job(spec).valid
    return succeeded(jobs.create_job(spec, prefer="wait=30"))


def be_refused(jobs, detections):
    source = InputSource(DatasetSource(source="dataset", dataset_id=detections.id))
    body = AssociateRequest(input=source, sensors=[SensorSettings(sensor_id="sonar")], filter=None)
    body.sensors[0] = SensorSettings.model_construct(sensor_id="sonar", p_d=1.5)
    try:
        jobs.create_associate_job(body)
    except UnprocessableEntityException as refusal:
        problem = typed(refusal.data, Problem)
        assert problem.code == "validation"
        assert [(fault.pointer, fault.code) for fault in problem.errors] == [("/sensors/0/p_d", "out_of_range")], problem
        return
    raise AssertionError("the request was not refused")


def live(sessions):
    radar = SensorSettings(sensor_id="radar", p_d=0.95, clutter_per_m2=1e-9, sigma_x_m=10.0, sigma_y_m=10.0)
    body = SessionRequest(sensors=[radar], tracker=TrackerSettings(initial_speed_sigma_mps=60.0))
    session = sessions.create_session(body)
    for index in range(4):
        detections = [PushedDetection(x_m=100.0 * index, y_m=5.0)]
        pushed = sessions.push_scans(session.id, PushedScan(sensor_id="radar", time_s=2.0 * index, detections=detections))
        assert (pushed.entries, pushed.scans[0].sequence) == (index + 1, index + 1), pushed
    tracks = sessions.list_session_tracks(session.id).tracks
    assert len(tracks) == 1 and abs(tracks[0].x_m - 300.0) < 10.0, tracks
    assert [event.kind.value for event in sessions.get_session_history(session.id).items] == ["started", "confirmed"]
    assert sessions.close_session(session.id).state == SessionState.CLOSED


def main():
    client = ApiClient(Configuration(host=sys.argv[1]))
    datasets, jobs, results = DatasetsApi(client), JobsApi(client), ResultsApi(client)
    detections, truth = upload(datasets, "detections.csv", "detections"), upload(datasets, "truth.csv", "truth")
    assert (detections.rows, truth.objects) == (24, 2)
    assert bytes(datasets.download_dataset(truth.id)) == (DATA / "truth.csv").read_bytes()
    judged = evaluate(jobs, associate(jobs, detections), truth)
    report = typed(results.get_job_report(judged.id).actual_instance, EvaluateReport)
    counts = report.result.tfa.counts
    assert (counts.targets, counts.correct, counts.missed, counts.var_false) == (2, 2, 0, 0), counts
    be_refused(jobs, detections)
    live(SessionsApi(client))
    print("openapi-generator, python: ok")


main()
