"""A Stone Soup tracker with the settings of trackloom's preset, on the same detections."""

import datetime
import time

import numpy as np
from stonesoup.dataassociator.neighbour import GNNWith2DAssignment, NearestNeighbour
from stonesoup.dataassociator.probability import PDA, JPDAwithLBP
from stonesoup.dataassociator.tree import DetectionKDTreeMixIn
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


class PDAWithTree(DetectionKDTreeMixIn, PDA):
    """PDA that looks for candidates with Stone Soup's own k-d tree, its faster way."""


def scans_of(rows, measurement):
    """Stone Soup's detector output: one (time, set of detections) a scan, scans that saw nothing included."""
    scans = {}
    for row in rows:
        found = scans.setdefault(float(row["time_s"]), [])
        if row["detection_id"]:
            found.append((float(row["x_m"]), float(row["y_m"])))
    for time_s, positions in sorted(scans.items()):
        stamp = EPOCH + datetime.timedelta(seconds=time_s)
        yield stamp, {Detection(np.array([[x], [y]]), timestamp=stamp, measurement_model=measurement) for x, y in positions}


def tracker(method, settings, scans):
    """A tracker with the same models, gate, confirmation count and deletion as trackloom's."""
    measurement = LinearGaussian(4, (0, 2), np.diag([settings["sigma_x_m"] ** 2, settings["sigma_y_m"] ** 2]))
    motion = CombinedLinearGaussianTransitionModel([ConstantVelocity(settings["q"]), ConstantVelocity(settings["q"])])
    predictor, updater = KalmanPredictor(motion), KalmanUpdater(measurement)
    near = DistanceHypothesiser(predictor, updater, Mahalanobis(), missed_distance=settings["gate_distance"])
    probable = PDAHypothesiser(
        predictor, updater, settings["clutter_per_m2"], prob_detect=settings["p_d"], prob_gate=settings["gate_probability"]
    )
    associator = {
        "nearest_neighbour": lambda: NearestNeighbour(near),
        "global_nearest_neighbour": lambda: GNNWith2DAssignment(near),
        "pda": lambda: PDA(probable),
        "jpda": lambda: JPDAwithLBP(probable),
    }[method]()
    deleter = UpdateTimeStepsDeleter(settings["max_missed"])
    speed = settings["initial_speed_sigma_mps"] ** 2
    prior = GaussianState(np.zeros((4, 1)), np.diag([0.0, speed, 0.0, speed]))
    initiator = MultiMeasurementInitiator(prior, deleter, GNNWith2DAssignment(near), updater, min_points=settings["confirm_hits"])
    mixture = method in ("pda", "jpda")
    kind = MultiTargetMixtureTracker if mixture else MultiTargetTracker
    return kind(initiator, deleter, list(scans), associator, updater)


def run(method, settings, rows):
    """Seconds, and for each scan time the positions of the tracks."""
    measurement = LinearGaussian(4, (0, 2), np.diag([settings["sigma_x_m"] ** 2, settings["sigma_y_m"] ** 2]))
    scans = list(scans_of(rows, measurement))
    positions = {}
    start = time.perf_counter()
    for stamp, tracks in tracker(method, settings, scans):
        positions[(stamp - EPOCH).total_seconds()] = [track.state.mean[[0, 2], 0].astype(float) for track in tracks]
    return time.perf_counter() - start, positions
