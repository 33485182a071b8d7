//! The speeds that new tracks allow for, where the request leaves them open: those of the scenario's targets, else those that are
//! seen in the data. What was taken is told, so that it can be written into the request.
//!
//! # Method
//! A velocity component of a target of speed v and any heading has the standard deviation v / √2. Of a scenario σ is that of all its
//! targets, and at least 2/5 of the highest speed. Of a recording σ is 0.55 of the mean speed of its fastest targets
//! ([`super::apparent_speed`]), and at least what noise alone looks like; the highest speed of a pair of points is 2.5 σ.

use super::apparent_speed::{ApparentSpeed, apparent_speed};
use super::track::ResolvedRecording;
use crate::experiment::request::methods::TrackerSpec;
use crate::filtering::AnyFilter;
use crate::model::scenario::{Scenario, TargetPlan};
use crate::simulation::fastest_mps;
use crate::tracking::{Initiation, Lifecycle, SPEED_REACH};
use serde::Serialize;
use serde_json::Value;

/// σ over the mean speed of the highest rung, which lies a little below the highest speed.
pub const SIGMA_OF_FASTEST: f64 = 0.55;
/// Targets that stand still are given this much, for nothing stands quite still.
const LEAST_SIGMA_MPS: f64 = 0.1;

/// Settings that the request left open, with the values that were taken.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "service", derive(utoipa::ToSchema), schema(as = TakenSettings))]
pub struct Taken {
    /// The filter that suits what the sensors report.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false, value_type = Object))]
    pub filter: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub initial_speed_sigma_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub max_speed_mps: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "service", schema(nullable = false))]
    pub confirm_hits: Option<u32>,
}

impl Taken {
    pub fn is_empty(&self) -> bool {
        *self == Taken::default()
    }
}

/// What speeds were taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ground {
    Scenario,
    Motion,
    Noise,
    Nothing,
}

/// The speeds of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speeds {
    sigma_mps: f64,
    highest_mps: f64,
    ground: Ground,
}

/// The life cycle of `tracker` with the speeds that it leaves open, and what was taken for them.
pub fn complete(
    tracker: &TrackerSpec,
    scenario: Option<&Scenario>,
    data: &ResolvedRecording,
    filter: &AnyFilter,
    warnings: &mut Vec<String>,
) -> (Lifecycle, Taken) {
    let (mut lifecycle, mut taken) = (tracker.lifecycle, Taken::default());
    if !filter.space().has_places() || !tracker.leaves_speed_open {
        return (lifecycle, taken);
    }
    let speeds = scenario.and_then(speeds_of_scenario).unwrap_or_else(|| {
        speeds_of_data(apparent_speed(data.recording, data.known, data.sensors))
    });
    let (name, pointer, value) = match &mut lifecycle.initiation {
        Initiation::TwoPoint { max_speed_mps, .. } => {
            *max_speed_mps = speeds.highest_mps;
            taken.max_speed_mps = Some(speeds.highest_mps);
            (
                "max_speed_mps",
                "/tracker/initiation/max_speed_mps",
                speeds.highest_mps,
            )
        }
        _ => {
            lifecycle.initial_speed_sigma_mps = speeds.sigma_mps;
            taken.initial_speed_sigma_mps = Some(speeds.sigma_mps);
            (
                "initial_speed_sigma_mps",
                "/tracker/initial_speed_sigma_mps",
                speeds.sigma_mps,
            )
        }
    };
    // Bearings say nothing of speeds.
    let names: Vec<&str> = data
        .sensors
        .iter()
        .filter(|sensor| sensor.report.locates())
        .map(|sensor| sensor.sensor_id.as_str())
        .collect();
    let how = match speeds.ground {
        Ground::Scenario => "follows from the speeds of the scenario's targets".to_owned(),
        Ground::Motion => format!("was estimated from the detections of {}", names.join(", ")),
        Ground::Noise => format!(
            "is what noise looks like: no detections of {} clearly move more",
            names.join(", ")
        ),
        Ground::Nothing if names.is_empty() => "is assumed: bearings do not tell speeds".to_owned(),
        Ground::Nothing => format!(
            "is assumed: too few scans of {}, or too much clutter in them, to tell speeds from",
            names.join(", ")
        ),
    };
    warnings.push(format!(
        "{name} {value} m/s {how}; give it in {pointer} to fix it"
    ));
    (lifecycle, taken)
}

/// `None` where targets have no speeds: they are directions.
fn speeds_of_scenario(scenario: &Scenario) -> Option<Speeds> {
    let (mean_square, highest_mps) = match &scenario.targets {
        TargetPlan::Random(plan) => {
            let (low, high) = (plan.speed_min_mps, plan.speed_max_mps);
            ((low * low + low * high + high * high) / 3.0, high)
        }
        TargetPlan::Listed { targets } => {
            let squares = || {
                targets.iter().map(|target| {
                    let climb_mps = target.vz_mps.unwrap_or(0.0);
                    target.vx_mps.powi(2) + target.vy_mps.powi(2) + climb_mps.powi(2)
                })
            };
            (
                squares().sum::<f64>() / targets.len().max(1) as f64,
                squares().fold(0.0, f64::max).sqrt(),
            )
        }
        TargetPlan::Maneuvering { targets } => {
            let fastest_mps: Vec<f64> = targets.iter().map(fastest_mps).collect();
            let squares: f64 = fastest_mps.iter().map(|speed_mps| speed_mps.powi(2)).sum();
            (
                squares / targets.len().max(1) as f64,
                fastest_mps.iter().copied().fold(0.0, f64::max),
            )
        }
        TargetPlan::Formation(plan) => (plan.speed_mps.powi(2), plan.speed_mps),
        // At the meeting, and what the noise adds until the first or the last scan.
        TargetPlan::Meeting(plan) => {
            let duration_s = f64::from(scenario.scans) * scenario.scan_period_s;
            let away_s = plan.meeting_s.max(duration_s - plan.meeting_s);
            let noise = plan.process_noise_m2ps3 * away_s.min(duration_s);
            let variance = plan.speed_sigma_mps.powi(2) + noise;
            (2.0 * variance, SPEED_REACH * variance.sqrt())
        }
        TargetPlan::Bearings(_) | TargetPlan::Recorded(_) => return None,
    };
    let sigma_mps = (mean_square / 2.0)
        .sqrt()
        .max(highest_mps / SPEED_REACH)
        .max(LEAST_SIGMA_MPS);
    Some(Speeds {
        sigma_mps: two_digits(sigma_mps),
        highest_mps: highest_mps.max(LEAST_SIGMA_MPS),
        ground: Ground::Scenario,
    })
}

fn speeds_of_data(apparent: Option<ApparentSpeed>) -> Speeds {
    let (sigma_mps, ground) = match apparent {
        Some(ApparentSpeed {
            fastest_mps: Some(fastest_mps),
            noise_mps,
            ..
        }) if SIGMA_OF_FASTEST * fastest_mps > noise_mps => {
            (SIGMA_OF_FASTEST * fastest_mps, Ground::Motion)
        }
        Some(ApparentSpeed {
            noise_mps,
            is_hidden: false,
            ..
        }) => (noise_mps.max(LEAST_SIGMA_MPS), Ground::Noise),
        Some(ApparentSpeed { noise_mps, .. }) => (
            noise_mps.max(Lifecycle::ASSUMED_SPEED_SIGMA_MPS),
            Ground::Nothing,
        ),
        None => (Lifecycle::ASSUMED_SPEED_SIGMA_MPS, Ground::Nothing),
    };
    Speeds {
        sigma_mps: two_digits(sigma_mps),
        highest_mps: two_digits(sigma_mps * SPEED_REACH),
        ground,
    }
}

/// Rounded to two digits, and within what the request allows.
pub fn two_digits(speed_mps: f64) -> f64 {
    format!("{speed_mps:.1e}")
        .parse()
        .unwrap_or(speed_mps)
        .clamp(1e-3, 1e5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scenario::{FormationMotion, FormationTargets, ListedTarget, RandomTargets};

    fn speeds_of(targets: TargetPlan) -> (f64, f64) {
        let scenario = Scenario {
            origin: None,
            scans: 1,
            scan_period_s: 1.0,
            sensors: Vec::new(),
            targets,
            coverage: None,
            record: None,
        };
        let speeds = speeds_of_scenario(&scenario).unwrap();
        (speeds.sigma_mps, speeds.highest_mps)
    }

    #[test]
    fn a_scenario_tells_the_speeds_of_its_targets() {
        // Uniform from 100 to 1 000: E v² = (1e4 + 1e5 + 1e6) / 3 = 370 000, σ = √185 000 = 430.1.
        let random = RandomTargets {
            count: 3,
            area_side_m: 1e3,
            speed_min_mps: 100.0,
            speed_max_mps: 1000.0,
        };
        assert_eq!(speeds_of(TargetPlan::Random(random)), (430.0, 1000.0));
        // One fast target among ten that stand still: √(100² / 11 / 2) = 21.3 would lose it; 100 / 2.5 does not.
        let target = |vx_mps| ListedTarget {
            z_m: None,
            vz_mps: None,
            truth_id: String::new(),
            x_m: 0.0,
            y_m: 0.0,
            vx_mps,
            vy_mps: 0.0,
        };
        let targets = (0..10)
            .map(|_| target(0.0))
            .chain([target(100.0)])
            .collect();
        assert_eq!(speeds_of(TargetPlan::Listed { targets }), (40.0, 100.0));
        let motion = FormationMotion::ConstantVelocity;
        let formation = FormationTargets {
            rows: 1,
            columns: 1,
            spacing_m: 1.0,
            displacement: 0.0,
            speed_mps: 250.0,
            motion,
        };
        assert_eq!(speeds_of(TargetPlan::Formation(formation)), (180.0, 250.0));
        assert_eq!(
            speeds_of(TargetPlan::Listed {
                targets: vec![target(0.0)]
            }),
            (0.1, 0.1)
        );
    }

    #[test]
    fn data_tell_the_fastest_targets_else_the_noise_else_nothing() {
        let of = |fastest_mps, noise_mps| {
            speeds_of_data(Some(ApparentSpeed {
                fastest_mps,
                noise_mps,
                is_hidden: false,
            }))
        };
        assert_eq!(
            of(Some(250.0), 10.0),
            Speeds {
                sigma_mps: 140.0,
                highest_mps: 340.0,
                ground: Ground::Motion
            }
        );
        assert_eq!(of(Some(8.0), 10.0).ground, Ground::Noise);
        assert_eq!(
            of(None, 3.32),
            Speeds {
                sigma_mps: 3.3,
                highest_mps: 8.3,
                ground: Ground::Noise
            }
        );
        let hidden = speeds_of_data(Some(ApparentSpeed {
            fastest_mps: None,
            noise_mps: 3.3,
            is_hidden: true,
        }));
        assert_eq!((hidden.sigma_mps, hidden.ground), (10.0, Ground::Nothing));
        assert_eq!(
            speeds_of_data(None),
            Speeds {
                sigma_mps: 10.0,
                highest_mps: 25.0,
                ground: Ground::Nothing
            }
        );
    }
}
