"""Runs every command and request of README, docs/*.md and the API document's examples, and looks at what comes of them.

Usage: run.py PROGRAM ADDRESS OPENAPI PAGE...   (run.sh starts the service and calls this)
"""

import csv
import json
import re
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

import pages

ROOT = Path(__file__).resolve().parents[2]

# Commands that are not run, by how they begin, with the reason.
SKIPPED = {
    "tests/run": "this is one of its lanes",
    "tests/goldens.sh": "builds another commit; tests/domain/goldens.rs compares with stored results",
    "cargo run --release -p trackloom-domain": "builds a release and draws for minutes; its numbers have tests of their own",
    "trackloom serve": "a service runs already; two pages need PostgreSQL or a bucket, which other lanes have",
    "trackloom worker": "needs PostgreSQL; the lane 'processes' has it",
    "trackloom feed --session": "waits for datagrams; tests/processes/feed.rs sends them",
    "trackloom feed --server http://127.0.0.1:8080 --session": "waits for a network; tests/processes/feed.rs has one",
    "export AWS_": "names a bucket; tests/s3 has one",
    "trackloom run --preset papers": "minutes; the presets of its parts run below",
    "trackloom run --preset NAME": "no preset is called so; the real ones run below",
}
# Pages whose commands another lane runs.
ELSEWHERE = {
    "api-clients.md": "tests/client generates each client and plays a session with it",
    "python.md": "tests/client installs the package, plays a session with it and runs the example of the page",
}
# Campaigns are run with so few runs here.
RUNS = "2"

# JSON blocks that are no job files, by how they begin: the kind and body of which they are a part, or why they are not sent.
DETECTIONS = {"source": "dataset", "dataset_id": "DETECTIONS"}
TRUTH = {"source": "dataset", "dataset_id": "TRUTH"}
LIVE_SESSION = '{\n  "name": "harbour"'
PUSHED_SCANS = ('{"sensor_id": "radar", "sequence"', '{"sensor_id": "radar", "time"')
HAND_TRACK = '{"x_m": 4000.0'
PARTS = {
    '"tfa":': lambda part: ("evaluate", {"input": DETECTIONS, "truth": TRUTH, "sensors": SENSORS, **json.loads("{" + part + "}")}),
    '{"source": "file", "path": "levels.npy"': "a source; tests/domain/bearing_time.rs reads such a file",
    '{"columns":': "a part of an upload; tests/domain/formats reads renamed columns",
    '{"method": "imm"': lambda part: ("associate", {
        "input": DETECTIONS, "sensors": SENSORS, "associator": {"method": "jpda"}, "filter": json.loads(part)}),
    '{"initiation":': lambda part: ("associate", {"input": DETECTIONS, "sensors": SENSORS, "tracker": json.loads(part)}),
    '{"tracker":': lambda part: ("associate", {
        "input": DETECTIONS, "sensors": SENSORS, "associator": {"method": "jpda"}, **json.loads(part)}),
    '"from": [': "a part of a report",
    '{"sensors":': lambda part: ("associate", {
        "input": DETECTIONS, "associator": {"method": "jpda"}, "sensors": [{**SENSORS[0], **json.loads(part)["sensors"][0]}]}),
    '{"limits":': lambda part: ("evaluate", {"input": DETECTIONS, "truth": TRUTH, "sensors": SENSORS, **json.loads(part)}),
    '{"requirements":': lambda part: ("evaluate", {"input": DETECTIONS, "truth": TRUTH, "sensors": SENSORS, **json.loads(part)}),
    '{"truth_id":': "a part of a report",
    '{"name": "correct", "forgiven":': "a part of a report",
}
SENSORS = [{"sensor_id": "radar", "p_d": 0.9, "clutter_per_m2": 1e-8, "sigma_x_m": 10, "sigma_y_m": 10}]

SCENE = {
    "scans": 25, "scan_period_s": 2.0,
    "sensors": [
        {"sensor_id": "radar", "max_range_m": 20000.0, "p_d": 0.95, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 2.0},
        {"sensor_id": "lidar", "max_range_m": 20000.0, "p_d": 0.95, "sigma_x_m": 10.0, "sigma_y_m": 10.0, "clutter_per_scan": 1.0},
    ],
    "targets": {"kind": "listed", "targets": [
        {"truth_id": "A", "x_m": -4000.0, "y_m": 0.0, "vx_mps": 150.0, "vy_mps": 0.0},
        {"truth_id": "B", "x_m": 0.0, "y_m": -4000.0, "vx_mps": 0.0, "vy_mps": 120.0}]},
}


class Failure(Exception):
    pass


def check(is_right, what):
    if not is_right:
        raise Failure(what)


class Session:
    def __init__(self, program, address):
        self.program, self.address = program, address
        self.folder = Path(tempfile.mkdtemp())
        (self.folder / "examples").symlink_to(ROOT / "examples")
        (self.folder / "docs").symlink_to(ROOT / "docs")
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        (bin_folder / "trackloom").symlink_to(Path(program).resolve())
        self.path = f"{bin_folder}:/usr/local/bin:/usr/bin:/bin"
        self.dataset = self.job = None
        self.said = ""
        self.ids = {}
        self.make_files()

    def run(self, command, **variables):
        environment = {"PATH": self.path, **variables}
        done = subprocess.run(["bash", "-c", command], cwd=self.folder, env=environment, capture_output=True, text=True, timeout=600)
        check(done.returncode == 0, f"exit code {done.returncode}: {(done.stderr or done.stdout)[-600:]}")
        return done.stdout

    def post(self, path, body):
        request = urllib.request.Request(
            self.address + path, json.dumps(body).encode(), {"Content-Type": "application/json", "Prefer": "wait=30"})
        try:
            with urllib.request.urlopen(request) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as refused:
            raise Failure(f"{refused.code}: {refused.read().decode()[:600]}") from None

    def get(self, path):
        with urllib.request.urlopen(self.address + path) as answer:
            return json.load(answer)

    def upload(self, name, meta):
        answer = json.loads(self.run(f"curl -sS -F 'meta={json.dumps(meta)};type=application/json' -F file=@{name} {self.address}/v1/datasets"))
        check("id" in answer, f"{name}: {answer}")
        return answer["id"]

    def make_files(self):
        """The files that pages name."""
        (self.folder / "scene.json").write_text(json.dumps({"kind": "simulate", "scenario": SCENE}))
        self.run("trackloom run scene.json --out scene")
        for name, keep in [("trial7.csv", lambda row: row["sensor_id"] == "radar")]:
            with open(self.folder / "scene/detections.csv") as made, open(self.folder / name, "w", newline="") as kept:
                rows = [row for row in csv.DictReader(made) if keep(row)]
                columns = [column for column in rows[0] if column != "truth_id"]
                writer = csv.DictWriter(kept, columns, extrasaction="ignore")
                writer.writeheader()
                writer.writerows(rows)
        for name in ["trial7-truth.csv", "truth.csv"]:
            (self.folder / name).write_bytes((self.folder / "scene/truth.csv").read_bytes())
        live = {"name": "harbour", "sensors": SENSORS, "tracker": {"initial_speed_sigma_mps": 100.0}}
        (self.folder / "harbour.json").write_text(json.dumps(live))
        # The file that the page shows, as it stands there.
        shown = re.search(r"```\n(time_s,scan,sensor_id,.*?)```", (ROOT / "docs/recordings.md").read_text(), re.DOTALL)
        (self.folder / "four-sensors.csv").write_text(shown[1])
        for sensor in ["radar", "lidar"]:
            job = {"kind": "associate", "input": {"source": "file", "path": "scene/detections.csv", "sensor_ids": [sensor]},
                   "sensors": [{**SENSORS[0], "sensor_id": sensor}]}
            (self.folder / "associate.json").write_text(json.dumps(job))
            self.run(f"trackloom run associate.json --out {sensor} && cp {sensor}/tracks.csv {sensor}-tracks.csv")
        self.ids["DETECTIONS"] = self.upload("scene/detections.csv", {"name": "detections", "sensors": [{**SENSORS[0], "sensor_id": "lidar"}, SENSORS[0]]})
        self.ids["TRUTH"] = self.upload("scene/truth.csv", {"name": "truth"})
        self.ids["TRACKS"] = self.upload("radar-tracks.csv", {"name": "tracks"})
        self.ids["SIMULATED"] = self.post("/v1/jobs/simulate", {"scenario": SCENE})["id"]
        self.ids["TRACKED"] = self.post("/v1/jobs/associate", {"input": {"source": "job", "job_id": self.ids["SIMULATED"]}})["id"]

    def command(self, text):
        """Runs a command of a page as a user would, with the ids of the answers before."""
        text = text.replace("http://127.0.0.1:8080", self.address).replace("curl ", "curl -sS ", 1)
        text = text.replace('"dataset_id": "…"', f'"dataset_id": "{self.dataset}"').replace("…", str(self.job))
        text = text.replace("cargo run --release -- demo", "trackloom demo --once --listen 127.0.0.1:0 --data demo")
        preset = re.search(r"--preset (\S+)", text)
        if preset and "--runs" not in text and self.is_campaign(preset[1]):
            text += f" --runs {RUNS}"
        text = re.sub(r"--runs \d+", f"--runs {RUNS}", text)
        if text == "trackloom run":
            return
        if "trackloom keys " in text:
            return self.keys(text)
        if " | " in text and "'" not in text and text.startswith("trackloom "):
            first, *others = text.split(" | ")
            for command in [first] + [f"trackloom {other}" for other in others]:
                self.run(command)
            return
        self.said = output = self.run(text)
        if text.startswith("curl"):
            self.look_at(json.loads(output))
        return output

    def printed(self, text):
        """The command before has printed these lines."""
        missing = [line for line in text.splitlines() if line.strip() and line not in self.said]
        check(not missing, f"not printed: {missing}")

    def keys(self, text):
        """A command on keys, for a service that asks for them: with the master key, as its owner has it."""
        (self.folder / "master.key").write_text("0123456789abcdef" * 2)
        serve = ["bin/trackloom", "serve", "--listen", "127.0.0.1:0", "--data", "keys", "--master-key-file", "master.key"]
        with subprocess.Popen(serve, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as service:
            try:
                address = re.search(r"http://\S+", service.stdout.readline())[0]
                master = (self.folder / "master.key").read_text()
                output = self.run(f"{text} --server {address}", TRACKLOOM_MASTER_KEY=master)
            finally:
                service.terminate()
        check(" add " not in text or output.startswith("tlk_"), f"no key: {output}")

    def look_at(self, answer):
        check("status" not in answer or "id" in answer, f"{answer}")
        if "state" in answer:
            check(answer["state"] == "succeeded", f"{answer}")
            self.job = answer["id"]
        elif "sha256" in answer:
            self.dataset = answer["id"]
        else:
            check(self.job and answer.get("job_id") == self.job, f"no report: {answer}")
            tracks = answer["result"].get("association", {}).get("tracks")
            check(tracks is None or tracks, "the report has no track")

    def is_campaign(self, preset):
        try:
            return json.loads(self.run(f"trackloom presets {preset}"))["kind"] == "campaign"
        except Failure:
            return False

    def job_file(self, text, name):
        job = json.loads(text)
        if job["kind"] == "campaign":
            job["runs"] = 10
        (self.folder / name).write_text(json.dumps(job))
        report = json.loads(self.run(f"trackloom run {name} --format json"))
        if job["kind"] == "campaign":
            look_at_cells(report)

    def part(self, text, made):
        kind, body = made(text)
        body = json.loads(self.with_ids(json.dumps(body)))
        answer = self.post("/v1/validate", {"kind": kind, "spec": body})
        check(answer["valid"], f"{answer['errors']}")

    def with_ids(self, text):
        for name, value in self.ids.items():
            text = text.replace(f'"{name}"', f'"{value}"')
        return text

    def begin(self, body):
        """A live session, for what is pushed afterwards."""
        self.live = self.post("/v1/sessions", body)["id"]

    def push(self, scan):
        answer = self.post(f"/v1/sessions/{self.live}/scans", scan)
        check(answer["scans"][0]["fate"] in ("taken", "waiting"), f"{answer}")

    def begin_track(self, body):
        """A track of that session, once it has seen a scan, be it late."""
        self.post(f"/v1/sessions/{self.live}/scans", {"sensor_id": "radar", "time_s": 1.7e9})
        answer = self.post(f"/v1/sessions/{self.live}/tracks", body)
        check(answer["status"] == "confirmed" and answer["x_m"] == body["x_m"], f"{answer}")

    def example(self, path, body):
        """An example of the API document, with ids of things that exist."""
        self.name_sources(body)
        if path == "/v1/sessions":
            self.begin(body)
        elif path == "/v1/sessions/{id}/scans":
            self.push(body)
        elif path == "/v1/sessions/{id}/tracks":
            self.begin_track(body)
        elif path == "/v1/validate":
            answer = self.post(path, body)
            check(answer["valid"], f"{answer['errors']}")
        elif path.startswith("/v1/jobs/") and "{" not in path:
            if "runs" in body:
                body["runs"] = 10
            job = self.post(path, body)
            for _ in range(20):
                if job["state"] in ("queued", "running"):
                    job = self.wait(job["id"])
            check(job["state"] == "succeeded", f"{job.get('error') or job['state']}")
            report = self.get(f"/v1/jobs/{job['id']}/report")
            tracks = report["result"].get("association", {}).get("tracks")
            check(tracks is None or tracks, f"the report has no track: {report['warnings']}")
            if "runs" in body:
                look_at_cells(report)

    def wait(self, job):
        request = urllib.request.Request(f"{self.address}/v1/jobs/{job}?wait=30")
        with urllib.request.urlopen(request) as answer:
            return json.load(answer)

    def name_sources(self, body):
        """Puts ids of what there is in the place of those of the example."""
        datasets = {"input": "DETECTIONS", "detections": "DETECTIONS", "truth": "TRUTH", "tracks": "TRACKS"}
        jobs = {"input": "SIMULATED", "tracks": "TRACKED", "truth": "SIMULATED", "detections": "SIMULATED"}
        for place, name in datasets.items():
            source = body.get(place)
            if isinstance(source, dict) and "dataset_id" in source:
                source["dataset_id"] = self.ids[name]
            if isinstance(source, dict) and "job_id" in source:
                source["job_id"] = self.ids[jobs[place]]


def look_at_cells(report):
    """A campaign that an example shows has numbers, which differ between its cells."""
    check(not report["warnings"], f"{report['warnings']}")
    cells = report["result"]["cells"]
    for outcome in report["result"]["outcomes"]:
        means = [cell["outcomes"][outcome]["mean"] for cell in cells]
        check(None not in means, f"{outcome} is missing in a cell: {means}")
        check(len(cells) == 1 or len(set(means)) > 1, f"{outcome} is the same in all cells: {means}")


def tour_is_that_of(readme, session):
    """The table of README is what the tour prints."""
    table = next(content for _, content in pages.blocks(readme) if content.startswith("scene  "))
    printed = [line.split() for line in session.run("trackloom demo --once --listen 127.0.0.1:0 --data tour").splitlines()]
    for line in table.splitlines():
        # Its last column is how long a scene took.
        check(any(words[:-1] == line.split() for words in printed), f"the tour does not print: {line}")


def tried(name, failures, do):
    try:
        do()
        print(f"ok       {name}")
    except (Failure, subprocess.TimeoutExpired, ValueError, KeyError) as failure:
        failures.append(name)
        print(f"FAILED   {name}\n         {type(failure).__name__}: {failure}")


def try_command(session, page, command, failures, done):
    name = f"{page.name}: {command.splitlines()[0]}"
    reason = next((reason for start, reason in SKIPPED.items() if command.startswith(start)), None)
    if reason:
        print(f"skipped  {name}  ({reason})")
    elif command.startswith("curl") or command not in done:
        done.add(command)
        tried(name, failures, lambda: session.command(command))


def try_block(session, page, block, failures):
    text, file_name = block
    name = f"{page.name}: {text.splitlines()[0][:80]}"
    part = next((part for start, part in PARTS.items() if text.startswith(start)), None)
    if isinstance(part, str):
        print(f"skipped  {name}  ({part})")
    elif text.startswith(LIVE_SESSION):
        tried(name, failures, lambda: session.begin(json.loads(text)))
    elif text.startswith(PUSHED_SCANS):
        tried(name, failures, lambda: session.push(json.loads(text)))
    elif text.startswith(HAND_TRACK):
        tried(name, failures, lambda: session.begin_track(json.loads(text)))
    elif part:
        tried(name, failures, lambda: session.part(text, part))
    else:
        tried(name, failures, lambda: session.job_file(text, file_name))


def main(program, address, openapi, *names):
    session, failures, done = Session(program, address), [], set()
    for page in map(Path, names):
        text = page.read_text()
        if page.name in ELSEWHERE:
            print(f"skipped  {page.name}  ({ELSEWHERE[page.name]})")
            continue
        for item in pages.items(text):
            if item[0] == "command":
                try_command(session, page, item[1], failures, done)
            elif item[0] == "output":
                tried(f"{page.name}: what it prints", failures, lambda: session.printed(item[1]))
            else:
                try_block(session, page, item[1:], failures)
        if page.resolve() == ROOT / "README.md":
            tried("README.md: the table of the tour", failures, lambda: tour_is_that_of(text, session))
    for path, name, body in pages.examples(json.loads(Path(openapi).read_text())):
        tried(f"API document: {path} {name}", failures, lambda: session.example(path, body))
    if failures:
        sys.exit(f"{len(failures)} of what the pages say is not so")


main(*sys.argv[1:])
