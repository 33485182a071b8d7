//! Brings the tracks of all sensors to common times.

use super::check::{MAX_ESTIMATES, too_many_estimates};
use super::spec::{AlignmentSettings, Spec};
use crate::correlation::alignment::{self, Alignment, Node};
use crate::correlation::estimates::Estimates;
use crate::experiment::job::RunError;
use crate::model::fault::Fault;

/// All tracks at the common times.
///
/// # Errors
/// There are none, or too many.
pub fn align_tracks(
    nodes: &[Node],
    spec: &Spec,
    warnings: &mut Vec<String>,
) -> Result<Estimates, RunError> {
    let (settings, place) = (&spec.alignment, spec.place());
    let times_s = common_times(nodes, settings)?;
    let tracks: usize = nodes.iter().map(|node| node.tracks.tracks.len()).sum();
    if tracks * times_s.len() > MAX_ESTIMATES {
        let points = (tracks * times_s.len()) as f64;
        return Err(too_many_estimates(place, points, points * 2e-6).into());
    }
    let alignment = Alignment {
        process_noise_m2ps3: settings.process_noise_m2ps3,
        max_gap_s: settings.max_gap_s,
        assumed: settings.assumed(),
    };
    let (estimates, left_out) = alignment::align(nodes, &times_s, &alignment);
    if estimates.times() == 0 {
        let detail = "there is no common time at which two sensors have a track";
        return Err(Fault::new(place, "disjoint", detail)
            .allowing("tracks that overlap in time, or a longer alignment/max_gap_s")
            .into());
    }
    if left_out > 0 {
        warnings.push(format!(
            "{left_out} estimates are left out: their covariance is not positive definite"
        ));
    }
    if !estimates.has_velocity {
        warnings.push(
            "not all tracks have velocities with covariances: positions alone are compared, at the times of the tracks' own points"
                .to_owned(),
        );
    }
    Ok(estimates)
}

fn common_times(nodes: &[Node], settings: &AlignmentSettings) -> Result<Vec<f64>, RunError> {
    if let Some(period_s) = settings.period_s {
        let times_s: Vec<f64> = nodes
            .iter()
            .flat_map(|node| alignment::times_of(&node.tracks))
            .collect();
        let first_s = times_s.iter().copied().fold(f64::INFINITY, f64::min);
        let last_s = times_s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let count = ((last_s - first_s) / period_s + 1e-9).floor().max(0.0);
        if count > MAX_ESTIMATES as f64 {
            let detail = format!("{last_s} s − {first_s} s make {count:.0} common times");
            let fault = Fault::new("/alignment/period_s", "too_large", detail);
            let allowed = format!("at most {MAX_ESTIMATES} tracks × common times");
            return Err(fault.allowing(allowed).into());
        }
        return Ok((0..=count as u64)
            .map(|number| first_s + number as f64 * period_s)
            .collect());
    }
    let reference = match &settings.reference {
        None => nodes.first(),
        Some(name) => nodes.iter().find(|node| node.sensor_id == *name),
    };
    let reference = reference.ok_or_else(|| {
        let names: Vec<&str> = nodes.iter().map(|node| node.sensor_id.as_str()).collect();
        let detail = "there is no sensor of this name";
        Fault::new("/alignment/reference", "unknown_value", detail).allowing(names.join(", "))
    })?;
    Ok(alignment::times_of(&reference.tracks))
}
