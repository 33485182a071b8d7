"""Makes values.json: reports of two targets by four sensors of different kinds, drawn once, and what one state of each target is after
every scan, on the given associations.

    python3 -m venv /tmp/ss && /tmp/ss/bin/pip install stonesoup==1.9.1
    /tmp/ss/bin/python tests/domain/mixed/stone_soup.py

`unscented` is Stone Soup 1.9.1, with its own models and α = 1, β = 2, κ = 0. Three things are arranged so that it does what the filter of
that name says:
- The state is (x, y, vx, vy), for the points of an unscented transform depend on the order of the variables. Transitions are Stone
  Soup's for (x, vx, y, vy), turned into this order.
- Its angles are atan2 of the second axis over the first; `mapping` names north first, so they are clockwise from north.
- Its mean of angles is that of unit vectors, where the filter takes the mean of differences to the centre. Both agree to the third power of
  how far points lie apart; the targets are so far away that less than 3e-11 standard deviations are left, which this program checks.

`extended` is a Kalman filter of the second order, written out below: Bar-Shalom, Li, Kirubarajan 2001, section 10.3.2.
"""

import datetime
import json
import pathlib

import numpy as np
import stonesoup
from stonesoup.models.measurement.linear import LinearGaussian
from stonesoup.models.measurement.nonlinear import (
    Cartesian2DToBearing,
    CartesianToBearingRange,
    CartesianToBearingRangeRate2D,
)
from stonesoup.models.transition.linear import (
    CombinedLinearGaussianTransitionModel,
    ConstantVelocity,
    LinearGaussianTimeInvariantTransitionModel,
)
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.types.angle import Bearing
from stonesoup.types.array import StateVector
from stonesoup.types.detection import Detection
from stonesoup.types.hypothesis import SingleHypothesis
from stonesoup.types.state import GaussianState
from stonesoup.updater.kalman import UnscentedKalmanUpdater

SEED = 18
Q_M2PS3 = 0.1
SPEED_SIGMA_MPS = 5.0
SENSORS = {
    "positions": {"sigma_x_m": 2.0, "sigma_y_m": 3.0},
    "radar": {"x_m": 0.0, "y_m": 100.0, "sigma_range_m": 10.0, "sigma_bearing_deg": 0.1},
    "doppler": {
        "x_m": -6000.0, "y_m": 1000.0,
        "sigma_range_m": 15.0, "sigma_bearing_deg": 0.2, "sigma_range_rate_mps": 0.5,
    },
    "camera": {"x_m": 7000.0, "y_m": -2000.0, "sigma_bearing_deg": 0.05},
}
# The second is seen by the radar across south, where bearings go round.
TARGETS = {"north": (2000.0, 14000.0, 8.0, -5.0), "south": (-150.0, -12000.0, 7.0, 3.0)}
# Positions first, so that speeds are known before anything is bent.
ORDER = ["positions"] * 2 + ["radar", "doppler", "camera", "positions", "camera", "doppler", "radar", "camera"] * 4
PERIODS_S = [1.0, 0.75, 1.5, 0.25, 2.0]
# Scans that do not see a target.
MISSED = {"north": (7, 15, 16), "south": (9, 20)}
# From (x, vx, y, vy) to (x, y, vx, vy).
TURN = [0, 2, 1, 3]
START = datetime.datetime(2026, 1, 1)


def reported(sensor, state):
    """What a sensor reports of a state without noise, in radians, with the noise's standard deviations."""
    x, y, vx, vy = state
    if "sigma_x_m" in sensor:
        return np.array([x, y]), np.array([sensor["sigma_x_m"], sensor["sigma_y_m"]])
    dx, dy = x - sensor["x_m"], y - sensor["y_m"]
    range_m = np.hypot(dx, dy)
    values, sigmas = [np.arctan2(dx, dy)], [np.deg2rad(sensor["sigma_bearing_deg"])]
    if "sigma_range_m" in sensor:
        values.append(range_m)
        sigmas.append(sensor["sigma_range_m"])
    if "sigma_range_rate_mps" in sensor:
        values.append((dx * vx + dy * vy) / range_m)
        sigmas.append(sensor["sigma_range_rate_mps"])
    return np.array(values), np.array(sigmas)


def columns(sensor, values):
    """The values as a file of detections has them."""
    if "sigma_x_m" in sensor:
        return {"x_m": values[0], "y_m": values[1]}
    names = ["bearing_deg", "range_m", "range_rate_mps"]
    return dict(zip(names, [float(np.rad2deg(values[0])) % 360.0, *values[1:]]))


def values_of(sensor, report):
    """The same as numbers, in radians."""
    if "sigma_x_m" in sensor:
        return np.array([report["x_m"], report["y_m"]])
    rest = [report[name] for name in ("range_m", "range_rate_mps") if name in report]
    return np.array([np.deg2rad(report["bearing_deg"]), *rest])


def draw_scans():
    draw = np.random.default_rng(SEED)
    scans, time_s = [], 0.0
    for index, name in enumerate(ORDER):
        sensor, reports = SENSORS[name], {}
        for target, (x, y, vx, vy) in TARGETS.items():
            truth, sigmas = reported(sensor, (x + vx * time_s, y + vy * time_s, vx, vy))
            errors = draw.standard_normal(len(truth))
            if index not in MISSED[target]:
                reports[target] = {key: float(value) for key, value in columns(sensor, truth + sigmas * errors).items()}
        scans.append({"time_s": time_s, "sensor_id": name, "reports": reports})
        time_s += PERIODS_S[index % len(PERIODS_S)]
    return scans


def transition(dt_s):
    """F and Q of Stone Soup, in the order (x, y, vx, vy)."""
    model = CombinedLinearGaussianTransitionModel([ConstantVelocity(Q_M2PS3), ConstantVelocity(Q_M2PS3)])
    interval = datetime.timedelta(seconds=dt_s)
    turned = np.ix_(TURN, TURN)
    return model.matrix(time_interval=interval)[turned], np.asarray(model.covar(time_interval=interval))[turned]


class Plain:
    """Makes the angles of a model plain numbers, so that their mean is the one of numbers; not for use across south."""

    def function(self, state, noise=False, **kwargs):
        return super().function(state, noise, **kwargs).astype(float)


class PlainBearing(Plain, Cartesian2DToBearing):
    pass


class PlainRange(Plain, CartesianToBearingRange):
    pass


class PlainRate(Plain, CartesianToBearingRangeRate2D):
    pass


def model_of(sensor, is_plain):
    """The sensor as a measurement model of Stone Soup."""
    _, sigmas = reported(sensor, np.ones(4))
    if "sigma_x_m" in sensor:
        return LinearGaussian(ndim_state=4, mapping=(0, 1), noise_covar=np.diag(sigmas**2))
    offset = StateVector([[sensor["y_m"]], [sensor["x_m"]]])
    shared = {"ndim_state": 4, "mapping": (1, 0), "noise_covar": np.diag(sigmas**2), "translation_offset": offset}
    if "sigma_range_rate_mps" in sensor:
        of_rates = {"velocity_mapping": (3, 2), "velocity": StateVector([[0.0], [0.0]])}
        return (PlainRate if is_plain else CartesianToBearingRangeRate2D)(**shared, **of_rates)
    if "sigma_range_m" in sensor:
        return (PlainRange if is_plain else CartesianToBearingRange)(**shared)
    return (PlainBearing if is_plain else Cartesian2DToBearing)(**shared)


def updated_by_stone_soup(state, dt_s, sensor, report, is_plain):
    matrix, noise = transition(dt_s)
    model = LinearGaussianTimeInvariantTransitionModel(transition_matrix=matrix, covariance_matrix=noise)
    time = state.timestamp + datetime.timedelta(seconds=dt_s)
    prediction = KalmanPredictor(model).predict(state, timestamp=time)
    if report is None:
        return GaussianState(prediction.state_vector, prediction.covar, time)
    values = values_of(sensor, report)
    if "sigma_x_m" not in sensor:
        values = [Bearing(values[0]), *values[1:]]
    detection = Detection(StateVector(values), timestamp=time, measurement_model=model_of(sensor, is_plain))
    updater = UnscentedKalmanUpdater(alpha=1.0, beta=2.0, kappa=0.0)
    posterior = updater.update(SingleHypothesis(prediction, detection))
    return GaussianState(posterior.state_vector.astype(float), posterior.covar, time)


def by_stone_soup(scans, target, mean, covariance, is_plain=False):
    state, states = GaussianState(StateVector(mean), covariance, START), []
    for before, scan in zip(scans, scans[1:]):
        dt_s, report = scan["time_s"] - before["time_s"], scan["reports"].get(target)
        state = updated_by_stone_soup(state, dt_s, SENSORS[scan["sensor_id"]], report, is_plain)
        states.append((np.asarray(state.state_vector, dtype=float).ravel(), np.asarray(state.covar, dtype=float)))
    return states


def derivatives(sensor, state):
    """First and second derivatives of `reported`, axis by axis."""
    x, y, vx, vy = state
    if "sigma_x_m" in sensor:
        return np.eye(2, 4), np.zeros((2, 4, 4))
    p, v = np.array([x - sensor["x_m"], y - sensor["y_m"]]), np.array([vx, vy])
    r = np.linalg.norm(p)
    turned = np.array([p[1], -p[0]])
    slopes, curves = [np.concatenate([turned, [0, 0]]) / r**2], [np.zeros((4, 4))]
    curves[0][:2, :2] = np.array([[0, 1], [-1, 0]]) / r**2 - 2 * np.outer(turned, p) / r**4
    if "sigma_range_m" in sensor:
        slopes.append(np.concatenate([p, [0, 0]]) / r)
        curves.append(np.zeros((4, 4)))
        curves[1][:2, :2] = np.eye(2) / r - np.outer(p, p) / r**3
    if "sigma_range_rate_mps" in sensor:
        pv = p @ v
        slopes.append(np.concatenate([v / r - p * pv / r**3, p / r]))
        curve = np.zeros((4, 4))
        cross = np.outer(p, v) + np.outer(v, p)
        curve[:2, :2] = -(cross + pv * np.eye(2)) / r**3 + 3 * pv * np.outer(p, p) / r**5
        curve[:2, 2:] = np.eye(2) / r - np.outer(p, p) / r**3
        curve[2:, :2] = curve[:2, 2:].T
        curves.append(curve)
    return np.array(slopes), np.array(curves)


def by_second_order(scans, target, mean, covariance):
    states = []
    for before, scan in zip(scans, scans[1:]):
        matrix, noise = transition(scan["time_s"] - before["time_s"])
        mean, covariance = matrix @ mean, matrix @ covariance @ matrix.T + noise
        sensor, report = SENSORS[scan["sensor_id"]], scan["reports"].get(target)
        if report is not None:
            expected, sigmas = reported(sensor, mean)
            slope, curves = derivatives(sensor, mean)
            bent = [curve @ covariance for curve in curves]
            expected = expected + [0.5 * np.trace(one) for one in bent]
            spread = [[0.5 * np.trace(one @ other) for other in bent] for one in bent]
            s = slope @ covariance @ slope.T + np.diag(sigmas**2) + spread
            gain = covariance @ slope.T @ np.linalg.inv(s)
            innovation = values_of(sensor, report) - expected
            if "sigma_x_m" not in sensor:
                innovation[0] = (innovation[0] + np.pi) % (2 * np.pi) - np.pi
            mean, covariance = mean + gain @ innovation, covariance - gain @ s @ gain.T
        states.append((mean, covariance))
    return states


def started(scans, target):
    """The first report is a position; its target may have any speed."""
    report, sensor = scans[0]["reports"][target], SENSORS[scans[0]["sensor_id"]]
    sigmas = np.array([sensor["sigma_x_m"], sensor["sigma_y_m"], SPEED_SIGMA_MPS, SPEED_SIGMA_MPS])
    return np.array([report["x_m"], report["y_m"], 0.0, 0.0]), np.diag(sigmas**2)


def check_means_of_angles(scans):
    """How many standard deviations the two means of angles lie apart; without a target that is seen across south."""
    target, most = "north", 0.0
    pairs = zip(*(by_stone_soup(scans, target, *started(scans, target), is_plain) for is_plain in (False, True)))
    for (one, covariance), (other, other_covariance) in pairs:
        scale = np.sqrt(np.diag(covariance))
        most = max(most, np.max(np.abs(one - other) / scale))
        most = max(most, np.max(np.abs(covariance - other_covariance) / np.outer(scale, scale)))
    print(f"means of angles: {most:.1e} standard deviations apart")
    assert most < 3e-11


def written(first, states):
    upper = np.triu_indices(4)
    return [[*mean.tolist(), *covariance[upper].tolist()] for mean, covariance in [first, *states]]


def main():
    scans = draw_scans()
    check_means_of_angles(scans)
    states = {"unscented": {}, "extended": {}}
    for target in TARGETS:
        first = started(scans, target)
        states["unscented"][target] = written(first, by_stone_soup(scans, target, *first))
        states["extended"][target] = written(first, by_second_order(scans, target, *first))
    document = {
        "stone_soup": stonesoup.__version__,
        "process_noise_m2ps3": Q_M2PS3,
        "initial_speed_sigma_mps": SPEED_SIGMA_MPS,
        "sensors": [{"sensor_id": name, **sensor} for name, sensor in SENSORS.items()],
        "scans": scans,
        "states": states,
    }
    # One scan, or one state of one target, a line.
    text = json.dumps(document).replace('{"time_s"', '\n{"time_s"').replace("[[", "[\n[").replace("], [", "],\n[")
    pathlib.Path(__file__).with_name("values.json").write_text(text + "\n")


main()
