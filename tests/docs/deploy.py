#!/usr/bin/env python3
"""Whether the files of docs/deploy are what systemd, Prometheus, Grafana and the program itself take.

Usage: deploy.py PROGRAM ADDRESS   (run.sh starts the service and calls this)
"""

import json
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DEPLOY = ROOT / "docs/deploy"


def check(is_right, what):
    if not is_right:
        sys.exit(f"docs/deploy: {what}")


def metrics_exist(address):
    """Of every series that a panel or an alert asks for."""
    with urllib.request.urlopen(f"{address}/v1/jobs"):
        pass
    with urllib.request.urlopen(f"{address}/metrics") as answer:
        there = set(re.findall(r"^(trackloom_\w+)", answer.read().decode(), re.MULTILINE))
    panels = json.loads((DEPLOY / "grafana.json").read_text())["panels"]
    asked = [target["expr"] for panel in panels for target in panel["targets"]]
    rules = re.findall(r"expr: (.*)", (DEPLOY / "alerts.yml").read_text())
    check(len(asked) >= 8 and len(rules) == 4, "panels or alerts are missing")
    for expression in asked + rules:
        for name in re.findall(r"trackloom_\w+", expression):
            check(name in there, f"the service has no {name}")
    places = [panel["gridPos"] for panel in panels]
    for at, one in enumerate(places):
        for other in places[:at]:
            apart = (one["x"] >= other["x"] + other["w"] or other["x"] >= one["x"] + one["w"]
                     or one["y"] >= other["y"] + other["h"] or other["y"] >= one["y"] + one["h"])
            check(apart, f"panels lie over one another at {one}")


def variables_are_options():
    known = set(re.findall(r"`(TRACKLOOM_\w+)`", (ROOT / "docs/options.md").read_text()))
    for path in DEPLOY.iterdir():
        used = set(re.findall(r"\b(TRACKLOOM_\w+)", path.read_text()))
        check(used <= known, f"{path.name} has {used - known}")


def units_are_sound(program):
    if not shutil.which("systemd-analyze"):
        print("skipped  units: systemd-analyze is not installed")
        return
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for unit in DEPLOY.glob("*.service"):
            text = unit.read_text().replace("/usr/local/bin/trackloom", str(Path(program).resolve()))
            path = Path(folder) / unit.name
            path.write_text(text)
            paths.append(str(path))
        done = subprocess.run(["systemd-analyze", "verify", *paths], capture_output=True, text=True)
        said = [line for line in done.stderr.splitlines() if "trackloom" in line]
        check(done.returncode == 0 and not said, f"units: {done.stderr}")


def rules_are_sound():
    if not shutil.which("promtool"):
        print("skipped  alerts: promtool is not installed")
        return
    done = subprocess.run(["promtool", "check", "rules", DEPLOY / "alerts.yml"], capture_output=True, text=True)
    check(done.returncode == 0, done.stdout + done.stderr)


def the_sample_file_starts_a_service(program):
    with tempfile.TemporaryDirectory() as folder:
        sample = (DEPLOY / "trackloom.env").read_text()
        path = Path(folder) / "trackloom.env"
        path.write_text(sample.replace("#TRACKLOOM_LISTEN=127.0.0.1:8080", "TRACKLOOM_LISTEN=127.0.0.1:0")
                        .replace("#TRACKLOOM_LOG_FORMAT=text", "TRACKLOOM_LOG_FORMAT=json"))
        serve = [program, "serve", "--config", path, "--data", Path(folder) / "data"]
        with subprocess.Popen(serve, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as service:
            address = re.search(r"http://127\.0\.0\.1:(\d+)", service.stdout.readline())
            service.terminate()
            _, log = service.communicate()
        check(address and address[1] != "8080", "the service does not listen where the file says")
        lines = [json.loads(line) for line in log.splitlines()]
        check(any(line.get("file") == str(path) for line in lines), f"the log does not name the file: {log}")
        path.write_text("TRACKLOOM_LISTN=127.0.0.1:0\nlisten\n")
        done = subprocess.run(serve, capture_output=True, text=True)
        check(done.returncode == 2 and "line 1" in done.stderr and "line 2" in done.stderr, f"{done.returncode}: {done.stderr}")


class Service:
    """A service over a directory."""

    def __init__(self, program, data):
        serve = [program, "serve", "--listen", "127.0.0.1:0", "--data", data]
        self.process = subprocess.Popen(serve, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.address = re.search(r"http://\S+", self.process.stdout.readline())[0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.communicate()

    def ask(self, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        headers = {"content-type": "application/json", "prefer": "wait=30"}
        with urllib.request.urlopen(urllib.request.Request(self.address + path, data, headers)) as answer:
            return answer.read()


def a_copy_of_a_running_service_is_a_backup(program):
    """As the page says: the tables by SQLite's own means, then the blobs."""
    scene = json.loads(subprocess.run([program, "presets", "liang2009-10"], capture_output=True, text=True, check=True).stdout)
    kind = scene.pop("kind")
    with tempfile.TemporaryDirectory() as folder:
        data, copy = Path(folder) / "data", Path(folder) / "copy"
        with Service(program, data) as service:
            job = json.loads(service.ask(f"/v1/jobs/{kind}", scene))
            check(job["state"] == "succeeded", f"the job: {job}")
            copy.mkdir()
            with sqlite3.connect(data / "app.db") as tables, sqlite3.connect(copy / "app.db") as kept:
                tables.backup(kept)
            shutil.copytree(data / "blobs", copy / "blobs")
            paths = [f"/v1/jobs/{job['id']}/report"]
            files = json.loads(service.ask(f"/v1/jobs/{job['id']}/artifacts"))["items"]
            paths += [f"/v1/jobs/{job['id']}/artifacts/{file['name']}" for file in files]
            wanted = [service.ask(path) for path in paths]
        with Service(program, copy) as restored:
            check(len(paths) > 2, "the job has files")
            check([restored.ask(path) for path in paths] == wanted, "a restored service has other files")


def main(program, address):
    metrics_exist(address)
    variables_are_options()
    units_are_sound(program)
    rules_are_sound()
    the_sample_file_starts_a_service(program)
    a_copy_of_a_running_service_is_a_backup(program)
    print("ok       docs/deploy")


main(*sys.argv[1:])
