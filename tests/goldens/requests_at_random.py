"""Requests drawn from a seed: methods and their parameters from the program's catalogue, metrics and
rules from its API document, scenes and trackers from tables below.

One in eight is spoilt in one place, and now and then a filter is drawn that does not fit what the sensors
report: such a request is refused, with the same words by both programs.
"""

import random

from jobs import CAMPAIGN_RUNS, told, written

GROUP = "random"
SEED = 41
REQUESTS = 50
# Of these; with fewer the drawing says little.
MIN_ACCEPTED = 35

KINDS = ["evaluate", "correlate", "associate", "group", "evaluate", "campaign", "simulate"]

# Integers that bound work: without this a search takes minutes.
CAPS = {"population": 30, "iterations": 20, "generations": 30, "max_evaluations": 5000, "rounds": 50,
        "max_nodes": 100000, "max_events": 1000000, "max_states": 65536, "max_iterations": 200}

FILTERS = {
    "position": ["kalman", "auto"],
    "polar": ["extended", "unscented", "converted", "auto"],
    "range_rate": ["extended", "unscented", "converted", "auto"],
    "bearing": ["bearing_only", "auto"],
    "direction": ["bearing_only", "auto"],
    "record": ["bearing_only", "auto"],
}

# Bearings of places, bearings of directions, directions found in a bearing-time record.
ANGULAR = ["bearing", "direction", "record"]

METRICS = ["Ospa", "Gospa", "TGospa", "Siap", "Clear", "Identity", "Hota", "AssignmentMetrics",
           "Kinematics", "TrackKeeping"]

STATISTICS = ["ChainStatistic", "AllPairsStatistic", "FusedStatistic", "LikelihoodRatioStatistic"]

FUSIONS = ["WeightedFusion", "CovarianceIntersectionFusion", "BestSensorFusion", "ModifiedFusion"]

OUTCOMES = {
    "evaluate": ["association.counts.tracks", "association.counts.associated_detections",
                 "tfa.counts.correct", "tfa.counts.missed", "events.counts.match",
                 "events.counts.switch"],
    "correlate": ["cost", "gap", "truth.share_right", "truth.pairwise_recall"],
    "group": ["grouping.accuracy", "grouping.precision", "grouping.recall"],
}


def jobs(program, folder):
    draw = Draw(program)
    return [written(folder, GROUP, f"{number:02}-{request['kind']}", request)
            for number, request in enumerate(draw.requests(), 1)]


class Draw:
    """The catalogue and the generator."""

    def __init__(self, program):
        self.random = random.Random(SEED)
        self.schemas = told(program, "openapi")["components"]["schemas"]
        self.families = {family["family"]: family["methods"]
                         for family in told(program, "methods", "--json")["families"]}

    def requests(self):
        for number in range(REQUESTS):
            kind = KINDS[number % len(KINDS)]
            request = {"kind": kind, "seed": self.random.randrange(2**32), **getattr(self, kind)()}
            if self.chance(1 / 8):
                self.spoil(request)
            yield request

    def chance(self, probability):
        return self.random.random() < probability

    def between(self, low, high):
        return round(self.random.uniform(low, high), 3)

    # Kinds of jobs.

    def simulate(self):
        return {"scenario": self.scenario(self.report_kind(), 1)}

    def associate(self):
        return self.tracked(self.report_kind(), 1)

    def evaluate(self):
        reports = self.report_kind()
        request = self.tracked(reports, 1)
        if self.chance(0.8):
            request["metrics"] = self.metrics(reports)
        if self.chance(0.3):
            request["profile"] = self.random.choice(["tracking", "vision", "tfa"])
        if self.chance(0.7):
            request["tfa"] = self.automaton(reports)
        if self.chance(0.5):
            gate = "gate_deg" if reports in ANGULAR else "gate_m"
            low, high = (1, 8) if reports in ANGULAR else (50, 1000)
            request["comparison"] = {gate: self.between(low, high)}
        return request

    def metrics(self, reports):
        names = self.random.sample(METRICS, self.random.randint(1, 4))
        if reports in ANGULAR and self.chance(0.95):
            names = ["TrackKeeping"]
        return [self.from_schema(self.schemas[name]) for name in names]

    def group(self):
        grouper = self.method("grouper")
        if grouper["method"] == "fuzzy_c_means":
            grouper["initial"] = self.initial_centres()
        predictions = {"start": self.random.choice(["truth", "groups"]),
                       "loop": self.random.choice(["open", "closed"]),
                       "process_noise_m2ps3": self.between(0, 200)}
        scenario = self.scenario("position", self.random.randint(2, 5))
        return {"input": {"source": "scenario", "scenario": scenario}, "grouper": grouper,
                "predictions": predictions}

    def correlate(self):
        if self.chance(0.6):
            request = {"input": {"source": "local_tracks", "tracks": self.local_tracks()}}
        else:
            request = self.tracked("position", self.random.randint(2, 3))
            request["alignment"] = {"process_noise_m2ps3": self.between(0, 5)}
        request["correlator"] = self.method("correlator")
        if self.chance(0.7):
            request["statistic"] = self.from_schema(
                self.schemas[self.random.choice(STATISTICS)])
        if self.chance(0.4):
            request["cross_covariance"] = {"kind": "coefficient", "coefficient": self.between(0, 0.8)}
        if self.chance(0.6):
            request["fusion"] = self.from_schema(self.schemas[self.random.choice(FUSIONS)])
        if self.chance(0.4):
            request["keep_unassociated"] = self.chance(0.5)
        return request

    def campaign(self):
        kind = self.random.choice(list(OUTCOMES))
        base = {"kind": kind, **getattr(self, kind)()}
        paths = self.random.sample(OUTCOMES[kind], 2)
        request = {"base": base, "grid": self.grid(base), "runs": CAMPAIGN_RUNS + 1,
                   "outcomes": [{"path": path, "name": f"outcome {number}"}
                                for number, path in enumerate(paths)]}
        if self.chance(0.5):
            axis = request["grid"][0]
            request["compare"] = {"axis": axis["name"], "to": axis["variants"][0]["name"]}
        return request

    def grid(self, base):
        """The base's own method beside others, and sometimes a number of its scene."""
        family = {"evaluate": "associator", "correlate": "correlator", "group": "grouper"}[base["kind"]]
        variants = [{"name": "as it is", "set": []}]
        for number in range(self.random.randint(1, 2)):
            variants.append({"name": f"other {number}",
                             "set": [{"path": f"/{family}", "value": self.method(family)}]})
        grid = [{"by": "variants", "name": family, "variants": variants}]
        if base["input"]["source"] == "scenario" and self.chance(0.5):
            grid.append({"by": "values", "name": "p_d", "path": "/input/scenario/sensors/0/p_d",
                         "values": [self.between(0.5, 0.9), 0.95]})
        return grid

    # Parts of requests.

    def report_kind(self):
        return self.random.choice(["position", "position", *FILTERS])

    def tracked(self, reports, sensors):
        """Input, associator, filter and tracker."""
        scenario = self.scenario(reports, sensors)
        if self.chance(0.05):
            reports = self.random.choice(list(FILTERS))
        name = self.random.choice(FILTERS[reports])
        request = {"input": {"source": "scenario", "scenario": scenario},
                   "associator": self.method("associator"),
                   "filter": self.method("filter", name),
                   "tracker": self.tracker(reports)}
        if reports == "record":
            request["detector"] = self.random.choice(
                [{}, {"threshold": {"kind": "constant", "level_db": self.between(4, 9)}}])
        elif request["associator"]["method"] == "strongest_neighbour" and self.chance(0.8):
            request["associator"] = self.method("associator", "pda")
        return request

    def tracker(self, reports):
        window = self.random.randint(2, 8)
        tracker = {"gate_probability": self.random.choice([0.9, 0.99, 0.999, 0.999999]),
                   "confirm_hits": self.random.randint(1, window), "confirm_window": window,
                   "max_missed": self.random.randint(1, 8)}
        if reports == "bearing":
            initiations = [{"method": "one_point"}]
        elif reports in ANGULAR:
            initiations = [{"method": "one_point"}, {"method": "truth", "rate_sigma_degps": 0.1}]
        else:
            initiations = [{"method": "one_point"}, {"method": "two_point"},
                           {"method": "two_point", "max_speed_mps": 400, "max_wait_scans": 2},
                           {"method": "truth", "speed_sigma_mps": self.between(0.5, 20)}]
            if self.chance(0.5):
                tracker["initial_speed_sigma_mps"] = self.between(20, 400)
        tracker["initiation"] = self.random.choice(initiations)
        if self.chance(0.3):
            tracker["confirmation"] = {"rule": "score", "max_score_drop": self.between(4, 20)}
            del tracker["confirm_hits"], tracker["confirm_window"]
        return tracker

    def automaton(self, reports):
        symbols = [{"kind": "detection_id"}]
        if reports not in ANGULAR:
            symbols += [{"kind": kind, "gate_m": self.between(50, 1000)}
                        for kind in ("nearest_detection", "nearest_truth")]
        symbols = self.random.choice(symbols)
        automaton = {"symbols": symbols, "max_missed": self.random.randint(1, 8),
                     "tolerance": self.random.randint(0, 6),
                     "search": self.random.choice(["breadth_first", "depth_first"]),
                     "minimise": self.chance(0.5)}
        if symbols["kind"] == "detection_id":
            automaton["decision"] = self.random.choice(
                [{"policy": "most_probable"}, {"policy": "all_gated", "min_weight": 0.1}])
        return automaton

    def initial_centres(self):
        clusters = self.random.choice([{"by": "count", "count": self.random.randint(2, 6)},
                                       {"by": "validity", "max": self.random.randint(3, 6)}])
        return self.random.choice([{"from": "predictions"}, {"from": "sensor", "clusters": clusters},
                                   {"from": "random", "clusters": clusters},
                                   {"from": "genetic", "clusters": clusters, "generations": 10}])

    def local_tracks(self):
        return {"sensors": self.random.randint(2, 4), "targets": self.random.randint(2, 12),
                "spacing_m": self.between(150, 1000), "jitter": self.between(0, 0.5),
                "p_d": self.between(0.7, 1), "false_tracks": self.between(0, 2),
                "bias_m": self.random.choice([0, self.between(0, 100)]),
                "times": self.random.randint(1, 5)}

    # Scenes.

    def scenario(self, reports, sensors):
        scenario = {"scans": self.random.randint(8, 40),
                    "scan_period_s": self.random.choice([1, 2, 5.5, 10]),
                    "sensors": [self.sensor(reports, number) for number in range(sensors)],
                    "targets": self.targets(reports)}
        if sensors > 1 and self.chance(0.3):
            scenario["coverage"] = {"kind": "duplicates", "count": 1}
        if reports == "record":
            scenario["record"] = {"noise_averages": self.random.randint(2, 8),
                                  "levels_db": [self.between(6, 12)],
                                  "fluctuation_db": self.between(0, 3)}
        return scenario

    def sensor(self, reports, number):
        if reports == "record":
            return {"sensor_id": "sonar", "p_d": self.between(0.6, 1)}
        if reports == "direction":
            return {"sensor_id": "sonar", "p_d": self.between(0.6, 1),
                    "sigma_bearing_deg": self.between(0.1, 1),
                    "clutter_per_deg": self.between(0, 0.1), "clutter_within_deg": 20}
        sensor = {"sensor_id": f"S{number}", "max_range_m": 60000, "p_d": self.between(0.6, 1),
                  "clutter_per_scan": self.random.choice([0, 1, self.between(0, 12)])}
        if reports == "position":
            sensor |= {"sigma_x_m": self.between(3, 60), "sigma_y_m": self.between(3, 60)}
        elif reports == "bearing":
            sensor |= {"sigma_bearing_deg": self.between(0.1, 1)}
        else:
            sensor |= {"sigma_range_m": self.between(3, 40), "sigma_bearing_deg": self.between(0.05, 0.4)}
            if reports == "range_rate":
                sensor["sigma_range_rate_mps"] = self.between(0.2, 5)
        if number and reports == "position":
            sensor |= {"x_m": self.between(-5000, 5000), "y_m": self.between(-5000, 5000)}
        return sensor

    def targets(self, reports):
        if reports in ("direction", "record"):
            return self.directions()
        listed = [{"truth_id": f"T{number}", "x_m": self.between(-9000, 9000),
                   "y_m": self.between(-9000, 9000), "vx_mps": self.between(-80, 80),
                   "vy_mps": self.between(-80, 80)} for number in range(self.random.randint(1, 6))]
        at_random = {"kind": "random", "count": self.random.randint(2, 25), "area_side_m": 40000,
                     "speed_min_mps": self.between(0, 50), "speed_max_mps": self.between(50, 400)}
        formation = {"kind": "formation", "rows": self.random.randint(1, 4),
                     "columns": self.random.randint(2, 4), "spacing_m": self.between(200, 2000),
                     "speed_mps": self.between(20, 250),
                     "motion": self.random.choice([{"kind": "constant_velocity"}, {"kind": "weaving"}])}
        kinds = [{"kind": "listed", "targets": listed}, at_random]
        kinds += [] if reports in ANGULAR else [formation]
        return self.random.choice(kinds)

    def directions(self):
        crossings = [{"centre_deg": self.between(0, 180), "half_width_deg": self.between(5, 30),
                      "crossing_time_s": self.between(10, 100), "power": self.between(0.8, 2)}]
        lines = [{"truth_id": f"L{number}", "bearing_deg": self.between(200, 350),
                  "rate_degps": self.between(-0.2, 0.2)} for number in range(2)]
        return {"kind": "bearings", "crossings": crossings, "lines": lines}

    # What the tables say.

    def method(self, family, name=None):
        """A method of the catalogue with some of its parameters."""
        if name == "auto":
            return {"method": "auto"}
        methods = {method["name"]: method for method in self.families[family]}
        name = name or self.random.choice(list(methods))
        return {"method": name, **self.from_schema(methods[name]["parameters"])}

    def from_schema(self, schema):
        """What is required, and half of what may be given."""
        drawn = {}
        for name, field in schema["properties"].items():
            if "$ref" in field or "oneOf" in field:
                continue
            if "const" in field or len(field.get("enum", "..")) == 1:
                drawn[name] = field.get("const", field.get("enum", [None])[0])
            elif name in schema.get("required", []) or self.chance(0.5):
                drawn[name] = self.value(name, field)
        return drawn

    def value(self, name, field):
        if "enum" in field:
            return self.random.choice(field["enum"])
        if field["type"] == "boolean":
            return self.chance(0.5)
        low = field.get("minimum", field.get("exclusiveMinimum", 0))
        high = min(field.get("maximum", field.get("exclusiveMaximum", 1e12)), CAPS.get(name, 1e12))
        usual = field.get("default") or min(max(1, low), high) / 2
        value = usual * 2 ** self.random.uniform(-1, 1)
        if field["type"] == "integer":
            return int(max(low, min(high, round(value))))
        # Open ends are not met.
        return max(low + (high - low) * 1e-6, min(high - (high - low) * 1e-6, value))

    def spoil(self, request):
        """One value that no program should take."""
        places = [place for place in self.places(request) if place[1] not in ("kind", "seed")]
        container, key = self.random.choice(places)
        container[key] = self.random.choice([-1, 1e300, "no such thing", None, [], True])

    def places(self, value):
        if isinstance(value, (dict, list)):
            for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
                yield value, key
                yield from self.places(inner)
