"""Stone Soup trackers with the settings of trackloom's preset, on the same detections."""

import csv
import datetime
import math
import time

import numpy as np
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment, NearestNeighbour
from stonesoup.dataassociator.probability import PDA, JPDAwithEHM2, JPDAwithLBP
from stonesoup.dataassociator.tree import DetectionKDTreeGNN2D, DetectionKDTreeMixIn, DetectionKDTreeNN, KDTreePDA
from stonesoup.deleter.time import UpdateTimeStepsDeleter
from stonesoup.hypothesiser.distance import DistanceHypothesiser
from stonesoup.hypothesiser.probability import PDAHypothesiser
from stonesoup.initiator.simple import MultiMeasurementInitiator
from stonesoup.measures import Mahalanobis
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.tracker.simple import MultiTargetMixtureTracker, MultiTargetTracker
from stonesoup.types.detection import Detection
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import KalmanUpdater

EPOCH = datetime.datetime(2026, 1, 1)


class KDTreeJPDAwithLBP(DetectionKDTreeMixIn, JPDAwithLBP):
    """JPDA by belief propagation whose candidates come from Stone Soup's own k-d tree."""


class KDTreeJPDAwithEHM2(DetectionKDTreeMixIn, JPDAwithEHM2):
    """Exact JPDA by EHM 2 whose candidates come from Stone Soup's own k-d tree."""


# For each of trackloom's methods, every way in which Stone Soup does it, and whether that way needs a k-d tree.
VARIANTS = {
    "nearest_neighbour": [(NearestNeighbour, False), (DetectionKDTreeNN, True)],
    "global_nearest_neighbour": [(GNNWith2DAssignment, False), (DetectionKDTreeGNN2D, True)],
    "pda": [(PDA, False), (KDTreePDA, True)],
    "jpda": [(JPDAwithLBP, False), (JPDAwithEHM2, False), (KDTreeJPDAwithLBP, True), (KDTreeJPDAwithEHM2, True)],
}


def settings_of(ours):
    """What both sides use, from what trackloom said of its run."""
    spec, sensor = ours["spec"], ours["spec"]["input"]["scenario"]["sensors"][0]
    gate_probability = spec["tracker"]["gate_probability"]
    return {
        "noise": np.diag([sensor["sigma_x_m"] ** 2, sensor["sigma_y_m"] ** 2]),
        "p_d": sensor["p_d"],
        "max_range_m": sensor["max_range_m"],
        "clutter_per_m2": ours["clutter_per_m2"],
        "q": spec["filter"]["process_noise_m2ps3"],
        "gate_probability": gate_probability,
        "gate_distance": math.sqrt(-2 * math.log(1 - gate_probability)),
        **spec["tracker"],
    }


def scans_of(path, settings):
    """Stone Soup's detector output: one (time, set of detections) a scan, scans that saw nothing included."""
    measurement = LinearGaussian(4, (0, 2), settings["noise"])
    scans = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            found = scans.setdefault(float(row["time_s"]), [])
            if row["detection_id"]:
                found.append((float(row["x_m"]), float(row["y_m"])))
    stamped = [(EPOCH + datetime.timedelta(seconds=time_s), positions) for time_s, positions in sorted(scans.items())]
    return [
        (stamp, {Detection(np.array([[x], [y]]), timestamp=stamp, measurement_model=measurement) for x, y in positions})
        for stamp, positions in stamped
    ]


def tracker(method, variant, settings, scans):
    """A tracker with the same models, gate, confirmation count and deletion as trackloom's."""
    kind, has_tree = variant
    measurement = LinearGaussian(4, (0, 2), settings["noise"])
    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(settings["q"]), ConstantVelocity(settings["q"])])
    predictor, updater = KalmanPredictor(motion), KalmanUpdater(measurement)
    near = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=settings["gate_distance"])
    probable = PDAHypothesiser(
        predictor, updater, settings["clutter_per_m2"], prob_detect=settings["p_d"], prob_gate=settings["gate_probability"]
    )
    # The tree looks as far as this times the largest variance; no gate reaches further, since no variance is below the noise.
    reach = settings["gate_distance"] / math.sqrt(settings["noise"].max())
    tree = {"predictor": predictor, "updater": updater, "max_distance_covariance_multiplier": reach} if has_tree else {}
    is_soft = method in ("pda", "jpda")
    associator = kind(probable if is_soft else near, **tree)
    # As in trackloom: nearest neighbour serves unconfirmed tracks, too; under all others global nearest neighbour does.
    beginner = kind if method == "nearest_neighbour" else DetectionKDTreeGNN2D if has_tree else GNNWith2DAssignment
    deleter = UpdateTimeStepsDeleter(settings["max_missed"])
    speed = settings["initial_speed_sigma_mps"] ** 2
    prior = GaussianState(np.zeros((4, 1)), np.diag([0.0, speed, 0.0, speed]))
    initiator = MultiMeasurementInitiator(prior, deleter, beginner(near, **tree), updater, min_points=settings["confirm_hits"])
    whole = MultiTargetMixtureTracker if is_soft else MultiTargetTracker
    return whole(initiator, deleter, scans, associator, updater)


def run(method, variant, settings, scans):
    """Seconds of one core from detections to tracks, other programs not counted, and the positions of the tracks at each time."""
    positions = {}
    start = time.process_time()
    for stamp, tracks in tracker(method, variant, settings, scans):
        positions[stamp] = [track.state.mean[[0, 2], 0].astype(float) for track in tracks]
    return time.process_time() - start, positions
