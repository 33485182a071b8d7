"""Artefacts in an S3-compatible bucket: the same bytes as in a directory, nothing half-written, nothing left behind.

The store is a real HTTP server in this process, which keeps its objects while it is stopped.
"""

import atexit
import hashlib
import io
import json
import logging
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
import uuid
from pathlib import Path

import boto3
from moto.server import ThreadedMotoServer

PROGRAM = sys.argv[1]
BUCKET, PREFIX = "tracks", "lab/one"
URL = f"s3://{BUCKET}/{PREFIX}"
KEYS = {"AWS_ACCESS_KEY_ID": "the-id", "AWS_SECRET_ACCESS_KEY": "the-secret", "AWS_REGION": "us-east-1"}
SENSORS = {"sensors": [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-9, "sigma_x_m": 5, "sigma_y_m": 5}]}
NOISE = {"p_d": 0.9, "sigma_x_m": 10, "sigma_y_m": 10, "clutter_per_scan": 3}
RADAR = {"sensor_id": "radar", "x_m": 0, "y_m": 0, "max_range_m": 20000, **NOISE}
TARGETS = {"kind": "random", "count": 5, "area_side_m": 10000, "speed_min_mps": 5, "speed_max_mps": 20}
SCENE = {"seed": 7, "scenario": {"scans": 20, "scan_period_s": 1, "sensors": [RADAR], "targets": TARGETS}}


class Store:
    """The object store; starts and stops at the same address."""

    def __init__(self):
        self.server, self.address = None, None
        self.start()
        self.client = boto3.client(
            "s3", endpoint_url=self.address, region_name="us-east-1", aws_access_key_id="id", aws_secret_access_key="secret"
        )
        self.client.create_bucket(Bucket=BUCKET)

    def start(self):
        port = int(self.address.rsplit(":", 1)[1]) if self.address else 0
        self.server = ThreadedMotoServer(ip_address="127.0.0.1", port=port, verbose=False)
        self.server.start()
        self.address = "http://%s:%d" % self.server.get_host_and_port()

    def stop(self):
        self.server.stop()

    def objects(self):
        """Name below the prefix -> content."""
        pages = self.client.get_paginator("list_objects_v2").paginate(Bucket=BUCKET)
        keys = [entry["Key"] for page in pages for entry in page.get("Contents", [])]
        assert all(key.startswith(PREFIX + "/") for key in keys), keys
        return {key.rsplit("/", 1)[1]: self.client.get_object(Bucket=BUCKET, Key=key)["Body"].read() for key in keys}

    def unfinished(self):
        return self.client.list_multipart_uploads(Bucket=BUCKET).get("Uploads", [])


class Service:
    """A running trackloom."""

    def __init__(self, data, environment, *arguments):
        self.data, self.log = data, tempfile.TemporaryFile("w+")
        command = [PROGRAM, "serve", "--listen", "127.0.0.1:0", "--workers", "2", "--data", data, *arguments]
        self.process = subprocess.Popen(
            command, env={**os.environ, **environment, "NO_COLOR": "1"}, stdout=subprocess.PIPE, stderr=self.log, text=True
        )
        atexit.register(self.process.kill)
        line = self.process.stdout.readline()
        assert line.startswith("trackloom listening on "), line + self.logged()
        self.address = line.removeprefix("trackloom listening on ").strip()

    def logged(self):
        self.log.seek(0)
        return self.log.read()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        assert self.process.wait(20) == 0, self.logged()

    def ask(self, method, path, body=None, **headers):
        """Status and content of the answer."""
        request = urllib.request.Request(self.address + path, data=body, method=method, headers=headers)
        try:
            with urllib.request.urlopen(request, timeout=120) as answer:
                return answer.status, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.read()

    def get(self, path):
        status, content = self.ask("GET", path)
        assert status == 200, (path, status, content, self.logged())
        return content

    def upload(self, file_name, content, **meta):
        edge = uuid.uuid4().hex
        part = f'--{edge}\r\nContent-Disposition: form-data; name="%s"%s\r\nContent-Type: %s\r\n\r\n'
        body = io.BytesIO()
        body.write((part % ("meta", "", "application/json")).encode() + json.dumps(meta).encode() + b"\r\n")
        body.write((part % ("file", f'; filename="{file_name}"', "text/csv")).encode() + content + f"\r\n--{edge}--\r\n".encode())
        form = {"Content-Type": f"multipart/form-data; boundary={edge}"}
        return self.ask("POST", "/v1/datasets", body.getvalue(), **form)

    def submit(self, kind, body):
        status, content = self.ask("POST", f"/v1/jobs/{kind}", json.dumps(body).encode(), **{"Content-Type": "application/json"})
        assert status == 202, (status, content)
        return json.loads(content)["id"]

    def ended(self, job_id):
        for _ in range(600):
            job = json.loads(self.get(f"/v1/jobs/{job_id}"))
            if job["state"] not in ("queued", "running"):
                return job
            time.sleep(0.1)
        raise AssertionError(f"job {job_id} does not end")

    def run(self, kind, body):
        job = self.ended(self.submit(kind, body))
        assert job["state"] == "succeeded", (job, self.logged())
        return job["id"]

    def files(self, job_id):
        """Name -> content of every artefact, each checked against the SHA-256 that is told."""
        files = {}
        for item in json.loads(self.get(f"/v1/jobs/{job_id}/artifacts"))["items"]:
            files[item["name"]] = self.get(item["href"])
            assert sha256(files[item["name"]]) == item["sha256"], item
        return files


def sha256(content):
    return hashlib.sha256(content).hexdigest()


def detections(scans):
    rows = (
        f"{scan},{scan + 1},radar,{name}{scan},{10 * scan},{y},{name}" for scan in range(scans) for name, y in (("A", 0), ("B", 5000))
    )
    return ("time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n" + "\n".join(rows) + "\n").encode()


def work(service):
    """A recording, a scene, tracks of both, their verdicts; the results and files that must not depend on where they are."""
    status, dataset = service.upload("trial.csv", detections(30), name="trial", **SENSORS)
    assert status == 201, (status, dataset, service.logged())
    dataset = json.loads(dataset)
    simulated = service.run("simulate", SCENE)
    judged = service.run("evaluate", {"input": {"source": "job", "job_id": simulated}})
    recorded = service.run("associate", {"input": {"source": "dataset", "dataset_id": dataset["id"]}})
    return dataset, [simulated, judged, recorded]


def comparable(service, jobs):
    """Everything but ids and times."""
    compared = []
    for job_id in jobs:
        files = service.files(job_id)
        report = json.loads(files.pop("report.json"))
        compared.append((files, json.dumps(report["result"])))
    return compared


def is_refused(arguments, environment, exit_code, *said):
    with tempfile.TemporaryDirectory() as data:
        command = [PROGRAM, "serve", "--listen", "127.0.0.1:0", "--data", data, *arguments]
        began = time.monotonic()
        answer = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, timeout=60)
        assert answer.returncode == exit_code, answer
        assert time.monotonic() - began < 30, "told late"
        for text in said:
            assert text in answer.stderr, (text, answer.stderr)
        assert KEYS["AWS_SECRET_ACCESS_KEY"] not in answer.stderr, answer.stderr


def refusals(store, reach):
    """What cannot be used is told at the start."""
    is_refused(["--artifacts", "gs://tracks"], reach, 2, "it must be s3://BUCKET or s3://BUCKET/PREFIX")
    is_refused(["--artifacts", "s3://id:secret@/x"], reach, 2, "the name of the bucket")
    is_refused(["--artifacts", "s3://absent"], reach, 1, "artefacts cannot be kept at s3://absent", "there is no such bucket")
    is_refused(["--artifacts", URL], {**reach, "AWS_ALLOW_HTTP": "false"}, 1, "AWS_ALLOW_HTTP")
    nobody = {key: text for key, text in reach.items() if key not in KEYS}
    nowhere = {"AWS_METADATA_ENDPOINT": "http://127.0.0.1:9"}
    is_refused(["--artifacts", URL], {**nobody, **nowhere}, 1, "AWS_ACCESS_KEY_ID is not set")
    store.stop()
    is_refused(["--artifacts", URL], reach, 1, f"artefacts cannot be kept at {URL}: the object store cannot be used")
    store.start()
    assert store.objects() == {}


def all_is_there(store, service, dataset, jobs):
    """The bucket has what the tables name, each object under the hash of its content, and nothing else."""
    named = {dataset["sha256"]}
    for job_id in jobs:
        named |= {sha256(content) for content in service.files(job_id).values()}
    objects = store.objects()
    assert set(objects) == named, set(objects) ^ named
    assert all(sha256(content) == name for name, content in objects.items())
    assert store.unfinished() == []
    assert not (Path(service.data) / "blobs").exists()
    assert list((Path(service.data) / "tmp").iterdir()) == []


def without_cache(data, reach):
    shutil.rmtree(Path(data) / "cache")
    return Service(data, reach, "--artifacts", URL)


def damage(store, service, dataset):
    """A copy that is not what its name says is never given out; an object that is gone is gone."""
    key = f"{PREFIX}/{dataset['sha256'][:2]}/{dataset['sha256']}"
    content = store.client.get_object(Bucket=BUCKET, Key=key)["Body"].read()
    path = f"/v1/datasets/{dataset['id']}/content"
    store.client.put_object(Bucket=BUCKET, Key=key, Body=content[:-2] + b"X\n")
    assert service.ask("GET", path)[0] == 500
    assert "is damaged" in service.logged()
    store.client.delete_object(Bucket=BUCKET, Key=key)
    assert service.ask("GET", path)[0] == 410
    store.client.put_object(Bucket=BUCKET, Key=key, Body=content)
    assert service.get(path) == content
    assert list((Path(service.data) / "tmp").iterdir()) == []


def large(store, service, reach):
    """A file that is sent and fetched in parts."""
    content = detections(250_000)
    assert len(content) > 2 * (8 << 20)
    status, dataset = service.upload("large.csv", content, name="large")
    assert status == 201, (status, dataset, service.logged())
    dataset = json.loads(dataset)
    assert store.objects()[sha256(content)] == content and store.unfinished() == []
    key = f"{PREFIX}/{sha256(content)[:2]}/{sha256(content)}"
    assert store.client.head_object(Bucket=BUCKET, Key=key)["ETag"].endswith('-3"'), "not in three parts"
    service.stop()
    service = without_cache(service.data, reach)
    path = f"/v1/datasets/{dataset['id']}"
    assert service.get(path + "/content") == content
    assert service.ask("DELETE", path)[0] == 204
    assert sha256(content) not in store.objects()
    return service


def outage(store, service, dataset, jobs):
    """A short one is not noticed. In a long one, what needs the store fails and leaves nothing, and the rest goes on."""
    before = store.objects()
    store.stop()
    threading.Timer(6, store.start).start()
    short = service.run("simulate", {**SCENE, "seed": 8})
    assert set(before) < set(store.objects())

    store.stop()
    known = service.get("/v1/datasets")
    failing = service.submit("simulate", {**SCENE, "seed": 9})
    status, problem = service.upload("other.csv", detections(31), name="other")
    assert (status, json.loads(problem)["code"]) == (500, "internal"), problem
    job = service.ended(failing)
    assert (job["state"], job["error"]["code"]) == ("failed", "internal"), job
    assert f"to {URL}" in service.logged() and "cannot write blob" in service.logged()
    assert service.get("/v1/datasets") == known
    assert list((Path(service.data) / "tmp").iterdir()) == []
    # What was read before is there without the store.
    assert comparable(service, jobs) and service.get(f"/v1/datasets/{dataset['id']}/content")
    # Deleted, although its objects cannot be removed yet.
    assert service.ask("DELETE", f"/v1/jobs/{short}")[0] == 204
    assert service.ask("GET", f"/v1/jobs/{short}")[0] == 410

    store.start()
    gone = service.run("simulate", {**SCENE, "seed": 10})
    for item in json.loads(service.get("/v1/datasets?limit=100"))["items"]:
        origin = item["origin"].get("job_id")
        if origin in (short, gone):
            assert service.ask("DELETE", f"/v1/datasets/{item['id']}")[0] == 204
    assert service.ask("DELETE", f"/v1/jobs/{gone}")[0] == 204
    assert set(store.objects()) == set(before), "what was left over has been removed with the next"
    assert not (Path(service.data) / "removals").exists()


def deletion(store, service, dataset, jobs):
    """Jobs and datasets go with their objects."""
    for job_id in reversed(jobs):
        assert service.ask("DELETE", f"/v1/jobs/{job_id}")[0] == 204
    for item in json.loads(service.get("/v1/datasets?limit=100"))["items"]:
        assert service.ask("DELETE", f"/v1/datasets/{item['id']}")[0] == 204
    assert store.objects() == {}
    assert not any(path.is_file() for path in (Path(service.data) / "cache").rglob("*"))


def main():
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    store = Store()
    reach = {**KEYS, "AWS_ENDPOINT": store.address, "AWS_ALLOW_HTTP": "true"}
    refusals(store, reach)
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as other:
        service = Service(one, {})
        plain = comparable(service, work(service)[1])
        service.stop()
        service = Service(other, reach, "--artifacts", URL)
        dataset, jobs = work(service)
        assert comparable(service, jobs) == plain, "the place changes the result"
        all_is_there(store, service, dataset, jobs)
        compared = service.get(f"/v1/compare?job={jobs[1]}&job={jobs[2]}")
        service.stop()
        service = without_cache(other, reach)
        assert comparable(service, jobs) == plain
        service.stop()
        service = without_cache(other, reach)
        # The inputs of a job come from the bucket too, and so does what a comparison and a picture show.
        again = service.run("associate", {"input": {"source": "dataset", "dataset_id": dataset["id"]}})
        assert comparable(service, [again]) == plain[2:]
        assert service.get(f"/v1/compare?job={jobs[1]}&job={jobs[2]}") == compared
        assert service.ask("DELETE", f"/v1/jobs/{again}")[0] == 204
        assert comparable(service, jobs) == plain, "what other jobs have too stays"
        service.stop()
        service = without_cache(other, reach)
        damage(store, service, dataset)
        service = large(store, service, reach)
        comparable(service, jobs)
        outage(store, service, dataset, jobs)
        deletion(store, service, dataset, jobs)
        service.stop()
    store.stop()


main()
