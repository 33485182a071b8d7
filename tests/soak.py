#!/usr/bin/env python3
"""Kills processes of a running service without warning, again and again, and checks that nothing is lost.

tests/soak.py BIN KILLS [postgres]: on a file, the server and the children that work for it are killed; with `postgres`, a server,
two workers and their children on a database of their own. Jobs are sent while it happens. At the end of each round every job
has succeeded once, with the `result` of the same job run undisturbed by `trackloom run`.
"""

import collections
import json
import os
import pathlib
import random
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
PATIENCE_S = 120
JOBS = 4


def body(seed):
    """A job of a tenth of a second to half a second; every seed makes another one."""
    radar = {"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.9, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 20.0}
    targets = {"kind": "random", "count": 10, "area_side_m": 10000.0, "speed_min_mps": 5.0, "speed_max_mps": 20.0}
    scenario = {"scans": 200 + 400 * (seed % 5), "scan_period_s": 1.0, "sensors": [radar], "targets": targets}
    return {"seed": seed, "input": {"source": "scenario", "scenario": scenario}, "profile": "tfa"}


def campaign(seed):
    outcomes = [{"name": "P correct", "path": "tfa.probability.correct"}]
    base = {"kind": "evaluate", "input": {"source": "preset", "preset": "liang2009-10"}, "profile": "tfa"}
    grid = [{"by": "values", "name": "p_d", "path": "/input/scenario/sensors/0/p_d", "values": [0.7, 0.9]}]
    return {"seed": seed, "base": base, "grid": grid, "runs": 200, "outcomes": outcomes}


class Service:
    """The server, and with a database two workers; whoever is killed is started again."""

    def __init__(self, program, data, database_url):
        self.program, self.data, self.database_url = program, data, database_url
        self.server, self.url, self.workers = None, None, []
        self.log = open(data / "soak.log", "ab")
        self.start_server()
        if database_url:
            self.workers = [self.start_worker() for _ in range(2)]

    def start_server(self):
        command = [self.program, "serve", "--listen", "127.0.0.1:0", "--data", str(self.data / "data"), "--workers", "2"]
        if self.database_url:
            command += ["--database-url", self.database_url]
        self.server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=self.log, text=True)
        line = self.server.stdout.readline()
        prefix = "trackloom listening on "
        if not line.startswith(prefix):
            raise SystemExit(f"the server did not start: it said {line!r}")
        self.url = line.removeprefix(prefix).strip()

    def start_worker(self):
        command = [self.program, "worker", "--database-url", self.database_url, "--data", str(self.data / "data"), "--slots", "1"]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=self.log)

    def ask(self, path, request=None):
        data = None if request is None else json.dumps(request).encode()
        headers = {"content-type": "application/json"} if data else {}
        since = time.monotonic()
        while True:
            try:
                with urllib.request.urlopen(urllib.request.Request(self.url + path, data, headers), timeout=30) as answer:
                    return json.load(answer)
            except urllib.error.HTTPError as error:
                if error.code != 503 or time.monotonic() - since > PATIENCE_S:
                    raise SystemExit(f"{path}: {error.code} {error.read().decode()[:500]}")
            time.sleep(0.2)

    def kill(self, victim):
        """Kills without warning; gives what was killed, or None when there was nothing to kill."""
        if victim == "child":
            parents = [self.server, *self.workers]
            children = [pid for parent in parents for pid in children_of(parent.pid)]
            if not children:
                return None
            try:
                os.kill(random.choice(children), signal.SIGKILL)
            except ProcessLookupError:
                return None
            return "child"
        if victim == "worker":
            place = random.randrange(len(self.workers))
            self.workers[place].kill()
            self.workers[place].wait()
            self.workers[place] = self.start_worker()
            return "worker"
        children = children_of(self.server.pid)
        self.server.kill()
        self.server.wait()
        wait_for_end_of(children)
        self.start_server()
        return "server"

    def stop(self):
        for process in [self.server, *self.workers]:
            process.terminate()
            process.wait()


def children_of(pid):
    try:
        return [int(child) for child in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()] + [
            int(child)
            for task in pathlib.Path(f"/proc/{pid}/task").iterdir()
            if task.name != str(pid)
            for child in (task / "children").read_text().split()
        ]
    except (FileNotFoundError, ProcessLookupError):
        return []


def wait_for_end_of(children):
    """A child does not outlive the process that it works for."""
    since = time.monotonic()
    while any(is_running(child) for child in children):
        if time.monotonic() - since > 5:
            raise SystemExit(f"of the children {children} some live on after their server was killed")
        time.sleep(0.02)


def is_running(pid):
    try:
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z"


def expected(program, folder, kind, request):
    """The result of the job run by one undisturbed process."""
    job = folder / "job.json"
    job.write_text(json.dumps({"kind": kind, **request}))
    printed = subprocess.run([program, "run", str(job), "--format", "json"], capture_output=True, check=True).stdout
    return json.loads(printed)["result"]


def check(service, job_id, wanted):
    since = time.monotonic()
    job = service.ask(f"/v1/jobs/{job_id}")
    while job["state"] in ("queued", "running"):
        if time.monotonic() - since > PATIENCE_S:
            raise SystemExit(f"job {job_id} does not end: {job}")
        time.sleep(0.05)
        job = service.ask(f"/v1/jobs/{job_id}")
    if job["state"] != "succeeded":
        raise SystemExit(f"job {job_id} {job['state']}: {job}")
    if service.ask(f"/v1/jobs/{job_id}/report")["result"] != wanted:
        raise SystemExit(f"job {job_id} has another result than undisturbed")
    events = service.ask(f"/v1/jobs/{job_id}/history")["events"]
    if sum(event["type"] == "done" for event in events) != 1:
        raise SystemExit(f"job {job_id} has not one event 'done': {events}")


def one_round(service, folder, seed, victims):
    """Sends jobs, kills each of the victims at a moment of its own, and waits for all jobs; gives what was killed."""
    requests = [("evaluate", body(seed + index)) for index in range(JOBS)]
    if seed % (5 * JOBS) == 0:
        requests.append(("campaign", campaign(seed)))
    wanted = [expected(service.program, folder, kind, request) for kind, request in requests]
    ids = [service.ask(f"/v1/jobs/{kind}", request)["id"] for kind, request in requests]
    killed = []
    for victim in victims:
        time.sleep(random.uniform(0.0, 0.4))
        killed.append(service.kill(victim))
    for job_id, result in zip(ids, wanted):
        check(service, job_id, result)
    return [victim for victim in killed if victim]


def soak(program, kills, database_url, folder):
    service = Service(program, folder, database_url)
    counts, jobs, seed = collections.Counter(), 0, 1000 * JOBS
    while sum(counts.values()) < kills:
        # A job may lose one child and still succeed, and one server or worker besides.
        others = ["server", "worker", "worker"] if database_url else ["server"]
        victims = [random.choice(others), "child"]
        random.shuffle(victims)
        counts.update(one_round(service, folder, seed, victims))
        seed, jobs = seed + JOBS, jobs + JOBS
        if jobs % (25 * JOBS) == 0:
            print(f"{sum(counts.values())} killed ({dict(counts)}), {jobs} jobs, each with its one result", flush=True)
    service.stop()
    print(f"{sum(counts.values())} killed ({dict(counts)}), {jobs} jobs and some campaigns: nothing lost, doubled or different")


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def main():
    program, kills = sys.argv[1], int(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        folder.chmod(0o755)
        if "postgres" not in sys.argv[3:]:
            soak(program, kills, None, folder)
            answer = sqlite3.connect(folder / "data" / "app.db").execute("PRAGMA integrity_check").fetchone()
            if answer != ("ok",):
                raise SystemExit(f"the database is damaged: {answer}")
            return
        port, directory = free_port(), folder / "postgres"
        script = str(HERE / "postgres.sh")
        subprocess.run([script, "start", str(directory), str(port)], check=True)
        try:
            soak(program, kills, f"postgres://trackloom@127.0.0.1:{port}/postgres", folder)
        finally:
            subprocess.run([script, "drop", str(directory)], check=True)


if __name__ == "__main__":
    main()
