#!/usr/bin/env python3
"""Whether a job finds what is wrong with a recording of 200 flights, and nothing else: an outside judge of docs/surveillance.md.

Usage: surveillance.py TRACKLOOM [SEED ...]. Flies 200 targets, makes tracks of them, and plants faults: gaps, late begins, positions
far off, wrong and missing codes, wrong heights, wrong velocities, numbers that are swapped, broken or doubled, updates after the end
of a flight, tracks of nobody. Then it holds `requirement_events.csv` against the planted list, and each count and value of the report
against its own formulas, which know who each update is of.
Each recording is judged twice: in a plane, and as latitudes and longitudes about the antimeridian that go on over midnight; these are
laid out by so much a degree, so that their distances are right to 2 %.
Exit code 1: something differs.
"""

import csv
import json
import math
import random
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

FLIGHTS = 200
END_S, TRUTH_S, UPDATE_S = 600.0, 4.0, 5.0
REACH_S, LANE_M, EDGE_M = 5.0, 10_000.0, 60_000.0
CODES = ("address", "callsign", "mode_a")
WITHIN_M, BEYOND_M = 300.0, 500.0
DEGREE_M, MIDDLE_DEG, BEGIN_S = 111_000.0, 179.9, 86_100.0
MINUTE_FT = 0.3048 / 60.0

ITEMS = [
    {"requirement": "detection", "name": "updates", "update_interval_s": 5, "tolerance_s": 0.99, "at_least": 0.9},
    {"requirement": "detection", "name": "slots", "update_interval_s": 5, "count": "slots", "at_least": 0.5},
    {"requirement": "long_gaps", "name": "long", "update_interval_s": 5, "tolerance_s": 0, "min_gap_s": 16.5, "at_most": 0.001},
    {"requirement": "position_within", "name": "near", "distance_m": WITHIN_M, "at_least": 0.9},
    {"requirement": "position_within", "name": "near_turning", "distance_m": WITHIN_M, "phase": "turning", "at_least": 0.9},
    {"requirement": "position_within", "name": "near_climbing", "distance_m": WITHIN_M, "phase": "climbing", "at_least": 0.9},
    {"requirement": "position_within", "name": "near_steady", "distance_m": WITHIN_M, "phase": "steady", "at_least": 0.9},
    {"requirement": "position_beyond", "name": "far", "distance_m": BEYOND_M, "at_most": 0.01},
    {"requirement": "position_rms", "name": "rms", "at_most": 300},
    {"requirement": "position_percentile", "name": "p95", "percent": 95, "at_most": 300},
    {"requirement": "along", "name": "along", "max_m": 250, "at_least": 0.9},
    {"requirement": "across", "name": "across", "max_m": 250, "at_least": 0.9},
    {"requirement": "latency", "name": "latency", "max_s": 1.0, "at_least": 0.9},
    {"requirement": "radar_range", "name": "range", "x_m": -20000, "y_m": 500000, "max_m": 350, "at_least": 0.9},
    {"requirement": "radar_azimuth", "name": "azimuth", "x_m": -20000, "y_m": 500000, "max_deg": 0.3, "at_least": 0.9},
    {"requirement": "position_within", "name": "near_accurate", "distance_m": WITHIN_M, "reference_accuracy_m": 30, "at_least": 0.9},
    {"requirement": "identity_correct", "name": "any_correct", "rule": "any", "at_least": 0.9},
    {"requirement": "identity_correct", "name": "all_correct", "rule": "all", "at_least": 0.9},
    {"requirement": "identity_false", "name": "any_false", "rule": "any", "at_most": 0.01},
    {"requirement": "identity_false", "name": "all_false", "rule": "all", "at_most": 0.01},
    {"requirement": "identity_update", "name": "address_updates", "of": ["address"], "update_interval_s": 5, "tolerance_s": 0.99, "at_least": 0.9},
    {"requirement": "mode_c_update", "name": "height_updates", "update_interval_s": 5, "tolerance_s": 0.99, "at_least": 0.9},
    {"requirement": "code_present", "name": "mode_a_present", "code": "mode_a", "at_least": 0.98},
    {"requirement": "mode_a_false", "name": "mode_a_false", "at_most": 0.01},
    {"requirement": "mode_c_correct", "name": "height_correct", "at_least": 0.9},
    {"requirement": "mode_c_false", "name": "height_false", "at_most": 0.03},
    {"requirement": "speed", "name": "speed", "max_difference_mps": 50, "at_least": 0.9},
    {"requirement": "course", "name": "course", "max_difference_deg": 15, "at_least": 0.9},
    {"requirement": "extra_data", "name": "extra_data", "at_most": 0.03},
    {"requirement": "extra_track", "name": "extra_track", "at_most": 0.0},
    {"requirement": "false_updates", "name": "false_updates", "at_most": 0.0},
    {"requirement": "false_tracks", "name": "false_tracks", "at_most": 0.0},
    {"requirement": "dubious_tracks", "name": "dubious_tracks", "at_most": 0.0},
    {"requirement": "continuity", "name": "continuity", "at_most": 0.0},
    {"requirement": "longest_track", "name": "longest", "at_least": 0.9},
    {"requirement": "initiation_delay", "name": "delay", "max_delay_s": 10, "at_least": 0.9},
]
SECTORS = [
    {"sector_id": "all"},
    {"sector_id": "west", "areas": [{"kind": "polygon", "corners": [
        {"x_m": -1e7, "y_m": -1e7}, {"x_m": EDGE_M, "y_m": -1e7}, {"x_m": EDGE_M, "y_m": 1e7}, {"x_m": -1e7, "y_m": 1e7}]}]},
    {"sector_id": "low", "height_max_m": 5000.0},
]


RADAR_M = (-20000.0, 500000.0)
# Requirements that name a place in the plane.
OF_PLANE = ("range", "azimuth")


def main(trackloom, seeds):
    told = []
    for seed in seeds:
        for is_on_earth in (False, True):
            with tempfile.TemporaryDirectory() as folder:
                place = "on the Earth" if is_on_earth else "in a plane"
                told += [f"seed {seed}, {place}: {one}" for one in judged(trackloom, seed, Path(folder), is_on_earth)]
    print("\n".join(told[:60]))
    print(f"{len(seeds)} recordings, {len(told)} differences")
    return 1 if told else 0


# The recording.

class Flight:
    """A truth every four seconds, and its updates."""

    def __init__(self, number, rng):
        self.name = f"F{number:03}"
        self.is_named = number % 5 != 4
        self.codes = {}
        if self.is_named:
            self.codes = {"address": f"{0x3C0000 + 7 * number:06X}", "callsign": f"TL{number:03}", "mode_a": f"{oct_of(number)}"}
        self.truth = path(number, rng)
        # A code that changes is no fault.
        self.change_s = 200.0 if self.is_named and number % 7 == 3 else None
        # From 300 to 340 s some flights say that they are known within 100 m only.
        self.is_vague = number % 6 == 1
        self.updates = []

    def accuracy(self, time_s):
        return 100 if self.is_vague and 300 <= time_s <= 340 else ""

    def is_inaccurate(self, beside):
        return any(self.accuracy(self.truth[i][0]) for i in beside)

    def code(self, name, time_s):
        if name == "mode_a" and self.change_s is not None and time_s > self.change_s:
            return "7000"
        return self.codes.get(name)


def oct_of(number):
    return f"{0o1000 + number:04o}"


def path(number, rng):
    """Straight to the east, or with a turn to the left and back; some climb."""
    x, y, speed = rng.uniform(-5e3, 5e3), LANE_M * number, rng.uniform(150, 230)
    heading, height, turns, climbs = math.pi / 2, rng.uniform(3e3, 9e3), number % 3 == 0, number % 4 == 1
    points, time_s = [], 0.0
    while time_s <= END_S:
        rate = 0.0
        if turns and 200 <= time_s < 260:
            rate = math.radians(1.5) * (-1 if time_s < 230 else 1)
        climb = 8.0 if climbs and 100 <= time_s < 300 else 0.0
        points.append((time_s, x, y, speed * math.sin(heading), speed * math.cos(heading), height))
        x, y = x + TRUTH_S * points[-1][3], y + TRUTH_S * points[-1][4]
        heading, height, time_s = heading + TRUTH_S * rate, height + TRUTH_S * climb, time_s + TRUTH_S
    return points


def between(flight, time_s):
    """The truth at a time: the point, else the line between two that are both within reach."""
    points = flight.truth
    after = next((i for i, point in enumerate(points) if point[0] >= time_s), None)
    if after is None:
        return None
    if points[after][0] == time_s:
        return points[after], (after, after)
    if after == 0 or max(time_s - points[after - 1][0], points[after][0] - time_s) > REACH_S:
        return None
    low, high = points[after - 1], points[after]
    share = (time_s - low[0]) / (high[0] - low[0])
    mixed = [a + share * (b - a) for a, b in zip(low, high)]
    speed = (1 - share) * math.hypot(*low[3:5]) + share * math.hypot(*high[3:5])
    turned = (math.atan2(high[3], high[4]) - math.atan2(low[3], low[4]) + math.pi) % math.tau - math.pi
    heading = math.atan2(low[3], low[4]) + share * turned
    mixed[3:5] = speed * math.sin(heading), speed * math.cos(heading)
    return tuple(mixed), (after - 1, after)


def recording(seed):
    """The flights, tracks of nobody, and what is wrong with them by requirement."""
    rng = random.Random(seed)
    flights = [Flight(number, rng) for number in range(FLIGHTS)]
    for number, flight in enumerate(flights):
        time_s = round(rng.uniform(0.5, 4.5), 2)
        while time_s <= END_S:
            flight.updates.append(update(flight, f"T{number:03}", time_s, rng))
            time_s = round(time_s + UPDATE_S, 2)
    plant = Plant(rng, flights)
    plant.all()
    nobody = []
    for number in range(6):
        x, y = rng.uniform(0, 1e5), -LANE_M * (number + 5)
        nobody += [{"track": f"N{number}", "time": 50.0 + 5 * k, "x": x + 500 * k, "y": y, "vx": 100.0, "vy": 0.0,
                    "height": 4000.0, "address": "", "callsign": "", "mode_a": "", "mode_c_ft": ""} for k in range(20)]
        plant.of["false_tracks"].append(("", f"N{number}", 50.0))
        plant.of["false_updates"] += [("", f"N{number}", 50.0 + 5 * k) for k in range(20)]
    rows = nobody + [row for flight in flights for row in flight.updates]
    for track, share in dubious(rows).items():
        if share > 0.05:
            plant.of["dubious_tracks"].append(("", track, min(row["time"] for row in rows if row["track"] == track)))
    return flights, nobody, plant.of


def update(flight, track, time_s, rng):
    (_, x, y, vx, vy, height), _ = between(flight, time_s)
    row = {"track": track, "time": time_s, "x": x + clipped(rng, 30), "y": y + clipped(rng, 30), "vx": vx + clipped(rng, 2),
           "vy": vy + clipped(rng, 2), "height": height, "mode_c_ft": f"{round((height / 0.3048) / 25) * 25}"}
    for name in CODES:
        row[name] = flight.code(name, time_s) or ""
    return row


def dubious(rows, sizes=None):
    """The share of dubious updates of each track: without any code, with a motion that nothing has, or all of a short one that is
    whole; `sizes` has the updates of whole tracks where `rows` are those of a sector."""
    tracks, shares = defaultdict(list), {}
    for row in sorted(rows, key=lambda row: row["time"]):
        tracks[row["track"]].append(row)
    for track, of_track in tracks.items():
        is_short = len(of_track) < 10 or of_track[-1]["time"] - of_track[0]["time"] < 30
        is_short = is_short and (sizes is None or sizes[track] == len(of_track))
        count = 0
        for before, row in zip([None, *of_track], of_track):
            speed, is_odd = math.hypot(row["vx"], row["vy"]), is_short or not any(row[name] for name in CODES)
            after = row["time"] - before["time"] if before else 0
            is_odd |= speed > 685.75
            if 1 <= after <= 30:
                turned = (math.atan2(row["vx"], row["vy"]) - math.atan2(before["vx"], before["vy"]) + math.pi) % math.tau - math.pi
                is_odd |= abs(speed - math.hypot(before["vx"], before["vy"])) / after > 29.43
                is_odd |= abs(math.degrees(turned)) / after > 30 or abs(row["height"] - before["height"]) / after > 304.8
            count += is_odd
        shares[track] = count / len(of_track)
    return shares


def clipped(rng, sigma):
    return max(-3 * sigma, min(3 * sigma, rng.gauss(0, sigma)))


class Plant:
    """Each flight gets one kind of fault at most."""

    def __init__(self, rng, flights):
        self.rng, self.left, self.of = rng, flights, defaultdict(list)

    def take(self, count, are_named=False):
        taken = self.rng.sample([flight for flight in self.left if flight.is_named or not are_named], count)
        self.left = [flight for flight in self.left if flight not in taken]
        return taken

    def middle(self, flight):
        return self.rng.randrange(20, len(flight.updates) - 30)

    def all(self):
        for kind in (self.wrong_codes, self.missing_codes, self.strangers, self.heights, self.gaps, self.late, self.outliers,
                     self.velocities, self.swaps, self.breaks, self.doubles, self.afterwards):
            kind()

    def gaps(self):
        for flight in self.take(25):
            first, count = self.middle(flight), self.rng.randint(1, 6)
            from_s, to_s = flight.updates[first - 1]["time"], flight.updates[first + count]["time"]
            del flight.updates[first:first + count]
            self.gap(flight, from_s, to_s)

    def gap(self, flight, from_s, to_s):
        length = to_s - from_s
        if length - 0.99 > 5 + 1e-9:
            for name in ("updates", "address_updates", "height_updates"):
                self.of[name].append((flight.name, "", from_s))
        if length > 16.5 - 1e-9:
            self.of["long"].append((flight.name, "", from_s))

    def late(self):
        for flight in self.take(8):
            del flight.updates[:self.rng.randint(4, 12)]
            first = flight.updates[0]["time"]
            self.gap(flight, 0.0, first)
            self.of["delay"].append((flight.name, flight.updates[0]["track"], 0.0))

    def outliers(self):
        for flight in self.take(20):
            row = flight.updates[self.middle(flight)]
            distance, angle = self.rng.choice([400.0, 700.0, 2500.0, 3500.0]), self.rng.uniform(0, math.tau)
            truth = between(flight, row["time"])[0]
            row["x"], row["y"] = truth[1] + distance * math.sin(angle), truth[2] + distance * math.cos(angle)
            key = (flight.name, row["track"], row["time"])
            self.of["near"].append(key)
            seen, true = (math.atan2(a - RADAR_M[0], b - RADAR_M[1]) for a, b in ((row["x"], row["y"]), truth[1:3]))
            if not flight.is_inaccurate(between(flight, row["time"])[1]):
                self.of["near_accurate"].append(key)
            if abs(math.dist((row["x"], row["y"]), RADAR_M) - math.dist(truth[1:3], RADAR_M)) > 350:
                self.of["range"].append(key)
            if abs(math.degrees(seen - true)) > 0.3:
                self.of["azimuth"].append(key)
            if distance >= BEYOND_M:
                self.of["far"].append(key)
            heading, speed = math.atan2(truth[3], truth[4]), math.hypot(*truth[3:5])
            along, across = distance * math.cos(angle - heading), distance * math.sin(angle - heading)
            for name, error, most in (("along", along, 250), ("across", across, 250), ("latency", along / speed, 1.0)):
                if abs(error) > most:
                    self.of[name].append(key)

    def run_of(self, flight):
        first = self.middle(flight)
        return flight.updates[first:first + self.rng.randint(1, 5)], flight.updates[first - 1]["time"], first

    def wrong_codes(self):
        for flight in self.take(15, are_named=True):
            rows, _, _ = self.run_of(flight)
            for row in rows:
                row["mode_a"] = "6666"
                key = (flight.name, row["track"], row["time"])
                for name in ("all_correct", "any_false", "mode_a_false"):
                    self.of[name].append(key)

    def missing_codes(self):
        for flight in self.take(10, are_named=True):
            rows, _, _ = self.run_of(flight)
            for row in rows:
                row["mode_a"] = ""
                key = (flight.name, row["track"], row["time"])
                for name in ("all_correct", "mode_a_present"):
                    self.of[name].append(key)

    def strangers(self):
        """All codes of somebody who is not there."""
        for flight in self.take(10, are_named=True):
            rows, from_s, first = self.run_of(flight)
            for row in rows:
                row.update(address="ABCDEF", callsign="XX1", mode_a="6666")
                key = (flight.name, row["track"], row["time"])
                for name in ("any_correct", "all_correct", "any_false", "all_false", "mode_a_false"):
                    self.of[name].append(key)
            to_s = flight.updates[first + len(rows)]["time"]
            if to_s - from_s - 0.99 > 5 + 1e-9:
                self.of["address_updates"].append((flight.name, "", from_s))

    def heights(self):
        for flight in self.take(10, are_named=True):
            rows, from_s, first = self.run_of(flight)
            for row in rows:
                row["mode_c_ft"] = f"{float(row['mode_c_ft']) + 700:.0f}"
                key = (flight.name, row["track"], row["time"])
                for name in ("height_correct", "height_false"):
                    self.of[name].append(key)
            to_s = flight.updates[first + len(rows)]["time"]
            if to_s - from_s - 0.99 > 5 + 1e-9:
                self.of["height_updates"].append((flight.name, "", from_s))

    def velocities(self):
        for number, flight in enumerate(self.take(10)):
            row = flight.updates[self.middle(flight)]
            _, _, _, vx, vy, _ = between(flight, row["time"])[0]
            turn = math.radians(40) if number % 2 else 0.0
            scale = 1.0 if number % 2 else 1.6
            row["vx"], row["vy"] = (scale * (vx * math.cos(turn) + vy * math.sin(turn)), scale * (vy * math.cos(turn) - vx * math.sin(turn)))
            self.of["course" if number % 2 else "speed"].append((flight.name, row["track"], row["time"]))

    def swaps(self):
        for _ in range(8):
            pair = self.take(2)
            time_s = self.rng.uniform(150, 450)
            names = [flight.updates[0]["track"] for flight in pair]
            for flight, other in zip(pair, reversed(names)):
                later = [row for row in flight.updates if row["time"] >= time_s]
                for row in later:
                    row["track"] = other
                self.of["continuity"].append((flight.name, other, later[0]["time"]))

    def breaks(self):
        for flight in self.take(10):
            later = flight.updates[self.middle(flight):]
            for row in later:
                row["track"] += "b"
            self.of["continuity"].append((flight.name, later[0]["track"], later[0]["time"]))

    def doubles(self):
        for flight in self.take(6):
            first = self.middle(flight)
            rows = flight.updates[first:first + 21]
            second = [dict(row, track=row["track"] + "d", time=round(row["time"] + 0.25, 2)) for row in rows]
            for row in second:
                truth = between(flight, row["time"])[0]
                row.update(x=truth[1] + 10, y=truth[2] - 10)
            flight.updates = sorted(flight.updates + second, key=lambda row: row["time"])
            for row in flight.updates:
                if second[0]["time"] <= row["time"] <= second[-1]["time"]:
                    self.of["extra_track"].append((flight.name, row["track"], row["time"]))

    def afterwards(self):
        for flight in self.take(5):
            last = flight.updates[-1]
            for step in range(1, 13):
                time_s = round(last["time"] + UPDATE_S * step, 2)
                flight.updates.append(dict(last, time=time_s, x=last["x"] + last["vx"] * UPDATE_S * step, y=last["y"] + last["vy"] * UPDATE_S * step))
                if time_s > END_S:
                    self.of["extra_data"].append((flight.name, last["track"], time_s))


def write(folder, flights, nobody, is_on_earth):
    names = [*CODES, "mode_c_ft"]
    places = ["lat_deg", "lon_deg", "course_deg", "speed_mps"] if is_on_earth else ["x_m", "y_m", "vx_mps", "vy_mps"]

    def row_of(time_s, name, place, height, codes):
        return [time_s + BEGIN_S, name, *(on_earth(*place) if is_on_earth else place), height, *codes]

    with open(folder / "truth.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time_s", "truth_id", *places, "height_m", *names, "position_accuracy_m"])
        for flight in flights:
            for time_s, *place, height in flight.truth:
                codes = [*(flight.code(name, time_s) or "" for name in CODES), feet(height) if flight.is_named else "", flight.accuracy(time_s)]
                writer.writerow(row_of(time_s, flight.name, place, height, codes))
    with open(folder / "tracks.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time_s", "track_id", *places, "height_m", *names])
        rows = nobody + [row for flight in flights for row in flight.updates]
        for row in sorted(rows, key=lambda row: (row["time"], row["track"])):
            place = (row["x"], row["y"], row["vx"], row["vy"])
            writer.writerow(row_of(row["time"], row["track"], place, row["height"], [row[name] for name in names]))
    sectors = [one for one in SECTORS if not (is_on_earth and "areas" in one)]
    job = {"kind": "evaluate", "truth": {"source": "file", "path": "truth.csv"}, "tracks": {"source": "file", "path": "tracks.csv"},
           "metrics": [{"metric": "clear"}], "comparison": {"gate_m": 1000.0},
           "requirements": {"sectors": sectors, "items": items_of(is_on_earth), "gate_m": 1000.0}}
    (folder / "job.json").write_text(json.dumps(job))
    return [one["sector_id"] for one in sectors]


def items_of(is_on_earth):
    return [item for item in ITEMS if not (is_on_earth and item["name"] in OF_PLANE)]


def on_earth(x, y, vx, vy):
    lon = MIDDLE_DEG + x / DEGREE_M
    return (y - LANE_M * FLIGHTS / 2) / DEGREE_M, (lon + 180) % 360 - 180, math.degrees(math.atan2(vx, vy)) % 360, math.hypot(vx, vy)


def feet(height_m):
    return f"{round(height_m / 0.3048 / 25) * 25}"


# The judge.

class Case:
    """A flight in a sector and a phase."""

    def __init__(self, flight, sector, phase):
        self.flight = flight
        self.doings = doing(flight) if phase else None
        due = [self.holds(sector, point) and self.is_phase(phase, [i]) for i, point in enumerate(flight.truth)]
        self.periods = periods([point[0] for point in flight.truth], due)
        self.judged, self.all = [], []
        for row in flight.updates:
            found = between(flight, row["time"])
            inside = found is not None and self.holds(sector, found[0]) and self.is_phase(phase, found[1])
            self.all.append((row, inside, self.holds(sector, (row["time"], row["x"], row["y"], 0, 0, row["height"]))))
            if inside:
                self.judged.append((row, *found))

    @staticmethod
    def holds(sector, point):
        return {"all": True, "west": point[1] <= EDGE_M, "low": point[5] <= 5000.0}[sector]

    def is_phase(self, phase, points):
        if phase is None:
            return True
        return any({"turning": self.doings[i][0], "climbing": self.doings[i][1], "steady": not any(self.doings[i])}[phase] for i in points)


def doing(flight):
    points, found = flight.truth, []
    for i in range(len(points)):
        a, b = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        turned = (math.atan2(b[3], b[4]) - math.atan2(a[3], a[4]) + math.pi) % math.tau - math.pi
        found.append((abs(turned) > math.radians(1) * (b[0] - a[0]), abs(b[5] - a[5]) > 300 * MINUTE_FT * (b[0] - a[0])))
    return found


def periods(times, due):
    found = []
    for before, time_s, is_due, was_due in zip([None, *times], times, due, [False, *due]):
        if is_due and was_due and time_s - before <= REACH_S:
            found[-1][1] = time_s
        elif is_due:
            found.append([time_s, time_s])
    return [(a, b) for a, b in found if b - a >= 1.0]


def misses(item, case, counts):
    """Expected and missed intervals; `counts` says which judged updates count."""
    interval, tolerance = item["update_interval_s"], item.get("tolerance_s", 0)
    expected = missed = 0
    good = {id(row) for row, point, beside in case.judged if counts(row, point, beside)}
    for from_s, to_s in case.periods:
        expected += math.floor((to_s - from_s) / interval + 1e-9)
        times = [row["time"] for row, _, _ in case.all if id(row) in good and from_s <= row["time"] <= to_s]
        if item.get("count") == "slots":
            for slot in range(math.floor((to_s - from_s) / interval + 1e-9)):
                a = from_s + slot * interval
                missed += not any(a - 1e-9 <= time_s < a + interval - 1e-9 for time_s in times)
            continue
        edges = [from_s, *times, to_s]
        for a, b in zip(edges, edges[1:]):
            left = b - a - tolerance
            if left > interval + 1e-6 and left >= item.get("min_gap_s", 0) - 1e-6 and left <= item.get("max_gap_s", math.inf) + 1e-6:
                missed += math.floor(left / interval + 1e-9)
    return expected, min(missed, expected)


def said(flight, name, beside):
    if name == "mode_c_ft":
        return {feet(flight.truth[i][5]) for i in beside} if flight.is_named else set()
    return {flight.code(name, flight.truth[i][0]) for i in beside} - {None}


def agreements(flight, row, beside, names):
    found = []
    for name in names:
        known = said(flight, name, beside)
        if known:
            found.append("none" if not row[name] else "same" if row[name] in known else "other")
    return found


def height_error(flight, row, beside):
    known = [float(word) for word in said(flight, "mode_c_ft", beside)]
    if not known or not row["mode_c_ft"]:
        return bool(known), None
    return True, min((float(row["mode_c_ft"]) - word for word in known), key=abs)


def right(item, case, row, point, beside):
    """Whether an update is of those that are counted; None where it is not judged. And its error."""
    kind, flight = item["requirement"], case.flight
    dx, dy = row["x"] - point[1], row["y"] - point[2]
    heading, speed = math.atan2(point[3], point[4]), math.hypot(point[3], point[4])
    along, across = dx * math.sin(heading) + dy * math.cos(heading), dx * math.cos(heading) - dy * math.sin(heading)
    if kind in ("radar_range", "radar_azimuth"):
        places = (row["x"], row["y"]), tuple(point[1:3])
        if kind == "radar_range":
            seen, true = (math.dist(place, RADAR_M) for place in places)
            return abs(seen - true) <= item["max_m"], seen - true
        seen, true = (math.degrees(math.atan2(place[0] - RADAR_M[0], place[1] - RADAR_M[1])) for place in places)
        error = (seen - true + 180) % 360 - 180
        return abs(error) <= item["max_deg"], error
    if "reference_accuracy_m" in item and flight.is_inaccurate(beside):
        return None, None
    if kind.startswith("position"):
        distance = math.hypot(dx, dy)
        return {"position_within": distance <= item.get("distance_m", 0), "position_beyond": distance >= item.get("distance_m", 0)}.get(kind, True), distance
    if kind in ("along", "across"):
        error = along if kind == "along" else across
        return abs(error) <= item["max_m"], error
    if kind == "latency":
        return abs(along / speed) <= item["max_s"], -along / speed
    found = agreements(flight, row, beside, CODES)
    if kind == "identity_correct":
        return (any if item["rule"] == "any" else all)(one == "same" for one in found) if found else None, None
    if kind == "identity_false":
        both = [one for one in found if one != "none"]
        return (any if item["rule"] == "any" else all)(one == "other" for one in found) if both else None, None
    if kind in ("mode_a_false", "code_present"):
        one = agreements(flight, row, beside, ["mode_a"])
        if kind == "code_present":
            return one != ["none"] if one else None, None
        return one == ["other"] if one and one != ["none"] else None, None
    if kind in ("mode_c_correct", "mode_c_false"):
        known, error = height_error(flight, row, beside)
        if kind == "mode_c_correct":
            return (error is not None and abs(error) <= 300) if known else None, error
        return abs(error) > 300 if error is not None else None, error
    if kind == "speed":
        error = math.hypot(row["vx"], row["vy"]) - speed
        return abs(error) <= item["max_difference_mps"], error
    turned = (math.atan2(row["vx"], row["vy"]) - heading + math.pi) % math.tau - math.pi
    return abs(math.degrees(turned)) <= item["max_difference_deg"], math.degrees(turned)


def counts(item, cases, nobody, sector):
    """Numerator, denominator and value of a requirement."""
    kind = item["requirement"]
    top, under, errors, hours = 0, 0, [], 0.0
    for case in cases:
        if kind in ("detection", "long_gaps", "identity_update", "mode_c_update"):
            def is_right(row, point, beside):
                if kind == "identity_update":
                    return set(agreements(case.flight, row, beside, item["of"])) <= {"same"}
                known, error = height_error(case.flight, row, beside)
                return kind != "mode_c_update" or not known or (error is not None and abs(error) <= 300)
            expected, missed = misses(item, case, is_right)
            top, under = top + (missed if kind == "long_gaps" else expected - missed), under + expected
        elif kind == "extra_data":
            covered = [any(a <= row["time"] <= b for a, b in case.periods) for row, _, _ in case.all]
            extra = [row["time"] for (row, _, seen), is_due in zip(case.all, covered) if seen and not is_due]
            ok = sum(is_due for (_, _, seen), is_due in zip(case.all, covered) if seen)
            is_much = len(extra) >= 3 and extra[-1] - extra[0] >= 11
            top, under = top + len(extra) * is_much, under + ok + len(extra) * is_much
        elif kind == "extra_track":
            lives = defaultdict(list)
            seen = [row for row, _, is_seen in case.all if is_seen]
            for row in seen:
                lives[row["track"]].append(row["time"])
            long = {track: (times[0], times[-1]) for track, times in lives.items() if len(times) >= 10 and times[-1] - times[0] >= 60}
            for row in seen:
                if row["track"] in long:
                    under += 1
                    top += any(a <= row["time"] <= b for track, (a, b) in long.items() if track != row["track"])
        elif kind == "continuity":
            last, holder = {row["track"]: i for i, (row, _, _) in enumerate(case.judged)}, None
            for i, (row, _, _) in enumerate(case.judged):
                if holder is not None and holder != row["track"] and last[holder] < i:
                    top, holder = top + 1, row["track"]
                holder = holder or row["track"]
            hours += sum(b - a for a, b in case.periods) / 3600
        elif kind == "longest_track":
            numbers = Counter(row["track"] for row, _, _ in case.judged)
            top, under = top + max(numbers.values(), default=0), under + len(case.judged)
        elif kind == "initiation_delay":
            if case.periods:
                first = next((row["time"] for row, _, _ in case.judged if row["time"] >= case.periods[0][0]), math.inf)
                top, under = top + (first - case.periods[0][0] <= item["max_delay_s"]), under + 1
        elif kind == "false_updates":
            under += sum(is_seen for _, _, is_seen in case.all)
        elif kind not in ("false_tracks", "dubious_tracks"):
            for row, point, beside in case.judged:
                is_right, error = right(item, case, row, point, beside)
                if is_right is not None:
                    top, under = top + is_right, under + 1
                    errors.append(error)
    if kind in ("false_updates", "dubious_tracks"):
        seen = [row for row in nobody if Case.holds(sector, (0, row["x"], row["y"], 0, 0, row["height"]))]
    if kind == "false_updates":
        top, under = len(seen), under + len(seen)
    if kind == "dubious_tracks":
        everybody = nobody + [row for case in cases for row, _, _ in case.all]
        inside = seen + [row for case in cases for row, _, is_seen in case.all if is_seen]
        sizes = Counter(row["track"] for row in everybody)
        shares = dubious(inside, sizes)
        top, under = sum(share > 0.05 for share in shares.values()), len(shares)
    if kind == "false_tracks":
        holds = [row["track"] for row in nobody if Case.holds(sector, (0, row["x"], row["y"], 0, 0, row["height"]))]
        top = len(set(holds))
    return top, under, errors, hours


def value_of(item, top, under, errors, hours):
    kind = item["requirement"]
    if kind == "position_rms":
        return math.sqrt(sum(error * error for error in errors) / len(errors))
    if kind == "position_percentile":
        return sorted(errors)[math.ceil(item["percent"] * len(errors) / 100 - 1e-9) - 1]
    if kind == "continuity":
        return top / hours if hours else None
    return top / under if under else None


def judged(trackloom, seed, folder, is_on_earth):
    flights, nobody, planted = recording(seed)
    sectors = write(folder, flights, nobody, is_on_earth)
    done = subprocess.run([trackloom, "run", str(folder / "job.json"), "--out", str(folder / "out"), "--format", "json"],
                          capture_output=True, text=True, check=False)
    if done.returncode != 1:
        return [f"exit code {done.returncode}: {done.stderr[-2000:]}"]
    report = json.loads((folder / "out" / "report.json").read_text())["result"]["requirements"]
    with open(folder / "out" / "requirement_events.csv", newline="", encoding="utf-8") as file:
        events = [row for row in csv.DictReader(file) if row["sector_id"] == "all"]
    precision = 0.02 if is_on_earth else 1e-6
    return [*wrong_events(planted, events, items_of(is_on_earth)), *wrong_numbers(report["findings"], (flights, nobody), sectors, items_of(is_on_earth), precision)]


def wrong_events(planted, events, items):
    """Planted faults that were not found, and what was found and not planted; slots and phases are held by their counts alone."""
    told = []
    for item in items:
        name = item["name"]
        if name == "slots" or "phase" in item:
            continue
        wanted = Counter((target, track, round(time_s, 6)) for target, track, time_s in planted[name])
        of_name = [row for row in events if row["requirement"] == name]
        found = Counter((row["truth_id"], row["track_id"], round(float(row["time_s"]) - BEGIN_S, 6)) for row in of_name)
        told += [f"{name}: planted and not found: {one}" for one in wanted - found]
        told += [f"{name}: found and not planted: {one}" for one in found - wanted]
    return told


def wrong_numbers(findings, scene, sectors, items, precision):
    told, by_name = [], {(one["sector_id"], one["requirement"]): one for one in findings}
    if len(by_name) != len(sectors) * len(items):
        told.append(f"{len(by_name)} findings")
    flights, nobody = scene
    for sector in sectors:
        for phase in (None, "steady", "turning", "climbing"):
            cases = [Case(flight, sector, phase) for flight in flights]
            for item in (one for one in items if one.get("phase") == phase):
                told += compared(by_name[sector, item["name"]], item, counts(item, cases, nobody, sector), precision)
    return told


def compared(found, item, own, precision):
    top, under, _, _ = own
    name, told = f"{found['sector_id']} {item['name']}", []
    if found["numerator"] != top:
        told.append(f"{name}: numerator {found['numerator']}, not {top}")
    if item["requirement"] not in ("false_tracks", "continuity") and found["denominator"] != under:
        told.append(f"{name}: denominator {found['denominator']}, not {under}")
    if item["requirement"] != "false_tracks":
        value = value_of(item, *own)
        if (value is None) != (found["value"] is None) or (value is not None and abs(value - found["value"]) > precision * max(1.0, abs(value))):
            told.append(f"{name}: value {found['value']}, not {value}")
        bound = next((key, item[key]) for key in ("at_least", "at_most") if key in item)
        is_met = None if value is None else value >= bound[1] if bound[0] == "at_least" else value <= bound[1]
        if found["verdict"] != {True: "pass", False: "fail", None: None}[is_met]:
            told.append(f"{name}: verdict {found['verdict']} of {value}")
    return told


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], [int(seed) for seed in sys.argv[2:]] or [1]))
