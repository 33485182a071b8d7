#!/usr/bin/env python3
"""Two builds of trackloom, the same jobs: is every `result` and every artefact the same, byte for byte?

Usage: compare.py OLD NEW. Exit code 0: all is the same, 1: something differs, 2: the jobs are poor.
"""

import concurrent.futures
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import jobs
import requests_at_random

# What two runs of one program do not have in common.
VOLATILE = {"job_id", "timing", "engine_version"}
TIME_LIMIT_S = 600
SHOWN_IN_A_GROUP = 10


def main(old, new):
    folder = tempfile.mkdtemp(prefix="goldens-")
    todo = [*jobs.presets(old), *jobs.examples(), *jobs.recordings(old, folder),
            *requests_at_random.jobs(old, folder)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda job: compared(job, old, new, folder), todo))
    exit_code = tell(list(zip(todo, found)))
    if exit_code:
        print(f"The requests of recordings and the random ones are kept in {folder}")
    else:
        shutil.rmtree(folder)
    return exit_code


class Compared:
    """What became of a job."""

    def __init__(self):
        self.files = 0
        self.refused = False
        self.differences = []


def compared(job, old, new, folder):
    outs = [Path(folder, side, job.group, job.name) for side in ("old", "new")]
    ends = [run(program, job, out) for program, out in zip((old, new), outs)]
    result = Compared()
    result.refused = ends[0][0] != 0
    if ends[0] != ends[1]:
        result.differences.append(f"{job.group}/{job.name}: {first_line_apart(*ends)}")
    elif not result.refused:
        compare_folders(job, outs, result)
    for out in outs:
        shutil.rmtree(out, ignore_errors=True)
    return result


def run(program, job, out):
    """Exit code, and what was said of a job that was refused or failed."""
    try:
        end = subprocess.run([program, "run", *job.arguments, "--out", str(out)],
                             capture_output=True, text=True, timeout=TIME_LIMIT_S)
    except subprocess.TimeoutExpired:
        return "timeout", f"not done after {TIME_LIMIT_S} s"
    return end.returncode, end.stderr if end.returncode else ""


def first_line_apart(old, new):
    if old[0] != new[0]:
        return f"exit code {old[0]} != {new[0]}: {(old[1] or new[1]).strip()[:300]}"
    for mine, other in zip(old[1].splitlines() + [""], new[1].splitlines() + [""]):
        if mine != other:
            return f"said {mine.strip()!r} != {other.strip()!r}"
    return "said more or less"


def compare_folders(job, outs, result):
    names = [sorted(os.listdir(out)) for out in outs]
    for name in sorted({*names[0], *names[1]}):
        result.files += 1
        where = f"{job.group}/{job.name}/{name}"
        if name not in names[0] or name not in names[1]:
            side = "old" if name in names[0] else "new"
            result.differences.append(f"{where}: only the {side} program writes it")
            continue
        texts = [(out / name).read_bytes() for out in outs]
        if name == "report.json":
            result.differences += [f"{where} {apart}" for apart in reports_apart(*texts)]
        elif texts[0] != texts[1]:
            result.differences.append(f"{where} {bytes_apart(*texts)}")


def reports_apart(old, new):
    """For each member of two reports whose text differs the first difference."""
    old, new = members(old.decode()), members(new.decode())
    if list(old) != list(new):
        return [names_apart(old, new)]
    if "spec" in old:
        old["spec"], new["spec"] = (json.dumps(spec) for spec in specs(old["spec"], new["spec"]))
    return [value_apart(f"/{name}", parsed(old[name]), parsed(new[name]))
            for name in old if name not in VOLATILE and old[name] != new[name]]


def specs(old, new):
    """Both requests, without the defaults that only the new program knows."""
    old, new = parsed(old), parsed(new)
    return old, known_to(old, new)


def known_to(old, new):
    if isinstance(old, dict) and isinstance(new, dict):
        return {name: known_to(old.get(name), value) for name, value in new.items() if name in old}
    return new


def members(text):
    """Name → text of every member of a JSON object that is written without white space."""
    decoder = json.JSONDecoder()
    found = {}
    at = 1
    while at < len(text) and text[at - 1] != "}":
        name, end = decoder.raw_decode(text, at)
        _, past = decoder.raw_decode(text, end + 1)
        found[name] = text[end + 1:past]
        at = past + 1
    return found


def parsed(text):
    """Numbers stay as they are written."""
    return json.loads(text, parse_float=Written, parse_int=Written)


class Written(str):
    """The text of a number."""

    def __repr__(self):
        return str(self)


def value_apart(pointer, old, new):
    """The first place at which two values differ, with what is there."""
    if isinstance(old, dict) and isinstance(new, dict):
        if list(old) != list(new):
            return f"{pointer}: {names_apart(old, new)}"
        for name in old:
            if old[name] != new[name]:
                return value_apart(f"{pointer}/{name}", old[name], new[name])
    if isinstance(old, list) and isinstance(new, list):
        for index, (mine, other) in enumerate(zip(old, new)):
            if mine != other:
                return value_apart(f"{pointer}/{index}", mine, other)
        return f"{pointer}: {len(old)} items != {len(new)}"
    return f"{pointer}: {old!r:.100} != {new!r:.100}"


def names_apart(old, new):
    """Two objects whose members are not called alike, or not in the same order."""
    gone, added = sorted(old.keys() - new.keys()), sorted(new.keys() - old.keys())
    if gone or added:
        return f"only old {gone}, only new {added}"
    return f"members in another order, {list(old)} != {list(new)}"


def bytes_apart(old, new):
    at = len(os.path.commonprefix([old, new]))
    line = old.count(b"\n", 0, at) + 1
    begin = max(old.rfind(b"\n", 0, at) + 1, at - 30)
    mine, other = (text[begin:at + 40].split(b"\n")[0] for text in (old, new))
    return f"line {line}, byte {at}: {mine!r} != {other!r}"


def tell(all_compared):
    """The table, the differences, and the exit code."""
    groups = {}
    for job, result in all_compared:
        groups.setdefault(job.group, []).append(result)
    print(f"{'what':<12} {'jobs':>5} {'refused':>8} {'files':>6}  result")
    for group, results in groups.items():
        differing = sum(bool(result.differences) for result in results)
        verdict = f"{differing} jobs differ" if differing else "equal"
        refused = sum(result.refused for result in results)
        files = sum(result.files for result in results)
        print(f"{group:<12} {len(results):>5} {refused:>8} {files:>6}  {verdict}")
    for group, results in groups.items():
        show(group, [text for result in results for text in result.differences])
    if any(result.differences for _, result in all_compared):
        return 1
    return poor(all_compared)


def show(group, differences):
    for text in differences[:SHOWN_IN_A_GROUP]:
        print(f"  {text}")
    if len(differences) > SHOWN_IN_A_GROUP:
        print(f"  {group}: and {len(differences) - SHOWN_IN_A_GROUP} more")


def poor(all_compared):
    """2 when jobs that say little were compared."""
    accepted = 0
    for job, result in all_compared:
        if job.group == requests_at_random.GROUP:
            accepted += not result.refused
        elif result.refused:
            print(f"  {job.group}/{job.name}: refused by both, a fixed job should not be")
            return 2
    if accepted < requests_at_random.MIN_ACCEPTED:
        print(f"  only {accepted} random requests were accepted")
        return 2
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*(str(Path(program).resolve()) for program in sys.argv[1:])))
