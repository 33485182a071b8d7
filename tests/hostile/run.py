#!/usr/bin/env python3
"""Files and jobs made to exhaust the machine, each given to `trackloom run` under a limit of 8 GB of address space.

Usage: run.py PROGRAM [NAME...]. Each case says which exit code is right, what the program must say, and how much memory it
may take. Nothing is stored: the files are made here, in a directory that goes away.
"""

import json
import os
import resource
import struct
import subprocess
import sys
import tempfile
import time

LIMIT_BYTES = 8_000_000_000
DONE, REFUSED = 0, 2
TIME_LIMIT_S = 600

CASES = {}


def case(exit_code, says, mib):
    """A case: its function writes files and returns a job; `mib` bounds the resident memory at its peak."""
    return lambda make: CASES.setdefault(make.__name__, (make, exit_code, says, mib))


def write(name, *parts):
    with open(name, "wb") as file:
        for part in parts:
            file.write(part if isinstance(part, bytes) else part.encode())
    return {"source": "file", "path": name}


def judged(text, format_name=None, **settings):
    """Truth and tracks from one text; `ID` is the name of the column of ids."""
    sides = {}
    for side, id_name in (("truth", "truth_id"), ("tracks", "track_id")):
        sides[side] = write(side, text.replace("ID", id_name))
        if format_name:
            sides[side]["format"] = format_name
    return {"kind": "evaluate", **sides, **settings}


def tracked(file, method):
    sensor = {"sensor_id": "r", "p_d": 0.9, "clutter_per_m2": 1e-6, "sigma_x_m": 10, "sigma_y_m": 10}
    return {"kind": "associate", "input": file, "associator": {"method": method}, "filter": {"method": "kalman"},
            "tracker": {"initial_speed_sigma_mps": 1}, "sensors": [sensor]}


def truth_of(file):
    return {"kind": "evaluate", "truth": file, "tracks": write("tracks.csv", "time_s,track_id,x_m,y_m\n0,1,0,0\n")}


def npy(shape):
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    file = write("record.npy", b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)), header)
    axes = {"time_step_s": 1, "first_bearing_deg": 0, "bearing_step_deg": 1}
    return {"kind": "associate", "input": {**file, "bearing_time": axes}, "detector": {}}


@case(REFUSED, "1000000000000 rows and 0 columns", 100)
def npy_of_many_empty_rows():
    return npy("(1000000000000, 0)")


@case(REFUSED, "bytes; there are 0", 100)
def npy_without_its_values():
    return npy("(10000000, 2)")


@case(REFUSED, "expected a record", 200)
def json_of_ones():
    return truth_of(write("truth.json", "[", "1," * 10_000_000, "1]"))


@case(REFUSED, "needs a column 'y_m'", 200)
def json_of_records():
    return truth_of(write("truth.json", "[", '{"time":1},' * 2_000_000, '{"time":1}]'))


@case(REFUSED, "EOF while parsing a list", 200)
def json_of_brackets():
    return truth_of(write("truth.json", "[" * 5_000_000))


@case(REFUSED, "there are 2000000 columns", 200)
def json_of_many_columns():
    columns = ",".join(f'"c{index}":[]' for index in range(2_000_000))
    return truth_of(write("truth.json", '{"columns":{', columns, "}}"))


@case(REFUSED, "expected a list of positions", 200)
def autoferry_of_ones():
    return truth_of({**write("truth.json", "[[],", "1," * 10_000_000, "1]"), "format": "autoferry"})


@case(REFUSED, "is longer than", 200)
def csv_header_of_many_columns():
    return truth_of(write("truth.csv", "time_s,truth_id,x_m,y_m", ",c12345" * 10_000_000, "\n0,A,1,2\n"))


@case(REFUSED, "the header names", 300)
def csv_header_of_many_lines():
    return truth_of(write("truth.csv", '"\n",' * 5_000_000, "\n"))


@case(REFUSED, "is longer than", 200)
def csv_row_of_commas():
    return truth_of(write("truth.csv", "time_s,truth_id,x_m,y_m\n", "," * 100_000_000))


@case(REFUSED, "is longer than", 200)
def mot_without_line_ends():
    return judged("1," * 20_000_000, "mot", profile="vision")


@case(REFUSED, "pairs within reach", 2000)
def boxes_all_in_one_place():
    return judged("".join(f"1,{index},1,1,30,60,1,1,1\n" for index in range(20_000)), "mot", profile="vision")


@case(DONE, "hota", 2000)
def boxes_as_many_in_one_place_as_allowed():
    return judged("".join(f"1,{index},1,1,30,60,1,1,1\n" for index in range(2000)), "mot", profile="vision")


@case(REFUSED, "pairs within reach", 2500)
def boxes_in_one_place_for_many_frames():
    lines = (f"{frame},{index},1,1,30,60,1,1,1\n" for frame in range(1, 60) for index in range(600))
    return judged("".join(lines), "mot", profile="vision")


@case(REFUSED, "targets and tracks", 1500)
def frames_with_an_object_each():
    return judged("".join(f"{frame},{frame},1,1,30,60,1,1,1\n" for frame in range(1, 1_000_001)), "mot", profile="vision")


@case(REFUSED, "points of truth", 4000)
def truth_drawn_out_between_two_points():
    job = {"kind": "evaluate", "metrics": [{"metric": "clear"}]}
    truth = "".join(f"{time_s},{target},0,{target}\n" for target in range(3000) for time_s in (0, 10_000))
    job["truth"] = write("truth.csv", "time_s,truth_id,x_m,y_m\n", truth)
    job["tracks"] = write("tracks.csv", "time_s,track_id,x_m,y_m\n", "".join(f"{time_s},1,0,0\n" for time_s in range(10_000)))
    job["comparison"] = {"alignment": {"method": "interpolate", "max_gap_s": 1e6}, "steps": "every_s", "every_s": 1}
    return job


@case(REFUSED, "pairs within reach", 3000)
def trajectories_near_each_other():
    lines = (f"{time_s},{index},0,{index / 100}\n" for time_s in range(1000) for index in range(300))
    return judged("time_s,ID,x_m,y_m\n" + "".join(lines), metrics=[{"metric": "t_gospa"}])


def crowd(scans, detections):
    lines = (f"{scan},{scan},r,d{index},0,0\n" for scan in range(1, scans + 1) for index in range(detections))
    return write("detections.csv", "time_s,scan,sensor_id,detection_id,x_m,y_m\n", "".join(lines))


@case(REFUSED, "candidates of tracks to be remembered", 1500)
def soft_candidates_at_one_point():
    return tracked(crowd(100, 1000), "pda")


@case(REFUSED, "candidates of tracks in one scan", 1500)
def detections_at_one_point():
    return tracked(crowd(3, 50_000), "nearest_neighbour")


def measured(program, make):
    """Exit code, what was said, seconds and peak resident MiB of the job that `make` describes, in the current directory."""
    job = make()
    with open("job.json", "w", encoding="utf-8") as file:
        json.dump(job, file)
    begun = time.monotonic()
    with open("said", "wb") as said:
        child = subprocess.Popen([program, "run", "job.json", "--out", "out"], stdout=said, stderr=said, stdin=subprocess.DEVNULL,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES)))
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - begun > TIME_LIMIT_S:
                child.kill()
            time.sleep(0.02)
    with open("said", encoding="utf-8", errors="replace") as file:
        text = file.read()
    return os.waitstatus_to_exitcode(status), text, time.monotonic() - begun, usage.ru_maxrss / 1024


def main():
    program, names = os.path.abspath(sys.argv[1]), sys.argv[2:] or list(CASES)
    failed = []
    for name in names:
        make, right_code, says, most_mib = CASES[name]
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            code, text, seconds, mib = measured(program, make)
            os.chdir("/")
        is_right = code == right_code and says in text and mib <= most_mib
        print(f"{'ok  ' if is_right else 'FAIL'} {name}: exit {code}, {mib:.0f} of {most_mib} MiB, {seconds:.1f} s", flush=True)
        if not is_right:
            failed.append(name)
            print(f"     wanted exit {right_code} and '{says}'; it said: {text[-500:]}", flush=True)
    sys.exit(f"{len(failed)} of {len(names)} cases failed: {', '.join(failed)}" if failed else 0)


if __name__ == "__main__":
    main()
