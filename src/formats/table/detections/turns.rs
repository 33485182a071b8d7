//! Whether a sensor turns, told from the times and bearings of what it saw: a sector that is swept again and again at one rate. Plots of
//! one target that drifts, and plots in no order, are no turns.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// The longest turn of an antenna (s).
const LONGEST_TURN_S: f64 = 60.0;
/// Share of the steps that agree with the rate.
const MOST: f64 = 0.9;

/// The rate of an antenna (rad/s), from times (s) and bearings clockwise (rad) in order of time. `None` where the sensor does not turn as
/// far as they tell: they span less than a turn, most steps are of half a turn and more, or the steps do not agree on the rate.
pub(super) fn rate_radps(seen: &[(f64, f64)]) -> Option<f64> {
    let steps: Vec<(f64, f64)> = seen
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1))
        .collect();
    let forward = steps
        .iter()
        .filter(|(time_s, step_rad)| *time_s > 0.0 && step_rad.rem_euclid(TAU) <= PI);
    let mut rates: Vec<f64> = forward
        .map(|(time_s, step_rad)| step_rad.rem_euclid(TAU) / time_s)
        .collect();
    if rates.len() * 2 < steps.len() || rates.len() < 2 {
        return None;
    }
    rates.sort_by(f64::total_cmp);
    let rate_radps = mean_rate_radps(&steps, rates[rates.len() / 2]);
    let span_s = seen[seen.len() - 1].0 - seen[0].0;
    let agree = steps.iter().filter(|step| agrees(**step, rate_radps));
    let is_turn = TAU / rate_radps <= LONGEST_TURN_S
        && span_s * rate_radps > TAU
        && agree.count() as f64 >= MOST * steps.len() as f64;
    is_turn.then_some(rate_radps)
}

/// How often the antenna passes north between two times and bearings.
pub(super) fn passes_of_north(before: (f64, f64), after: (f64, f64), rate_radps: f64) -> f64 {
    let swept_rad = (after.0 - before.0) * rate_radps;
    ((swept_rad - (after.1 - before.1)) / TAU).round()
}

/// That of all steps together whose own is about the middle one: single ones suffer from times that are rounded.
fn mean_rate_radps(steps: &[(f64, f64)], middle_radps: f64) -> f64 {
    let (mut swept_rad, mut swept_s) = (0.0, 0.0);
    for &(time_s, step_rad) in steps {
        let forward_rad = step_rad.rem_euclid(TAU);
        if forward_rad <= PI && (0.5..2.0).contains(&(forward_rad / time_s / middle_radps)) {
            swept_rad += forward_rad;
            swept_s += time_s;
        }
    }
    swept_rad / swept_s
}

/// Whether a step is what the antenna sweeps in its time, by an eighth of a turn.
fn agrees((time_s, step_rad): (f64, f64), rate_radps: f64) -> bool {
    let off_rad = (step_rad - time_s * rate_radps).rem_euclid(TAU);
    time_s > 0.0 && off_rad.min(TAU - off_rad) < FRAC_PI_4
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an antenna with this turn sees at these bearings, turn after turn.
    fn swept(turn_s: f64, turns: u32, bearings_deg: &[f64]) -> Vec<(f64, f64)> {
        let mut seen = Vec::new();
        for turn in 0..turns {
            for &bearing_deg in bearings_deg {
                let time_s = (f64::from(turn) + bearing_deg / 360.0) * turn_s;
                seen.push((time_s, bearing_deg.to_radians()));
            }
        }
        seen
    }

    fn turn_s(seen: &[(f64, f64)]) -> Option<f64> {
        rate_radps(seen).map(|rate_radps| TAU / rate_radps)
    }

    #[test]
    fn the_turn_of_an_antenna_is_found_also_in_a_sector() {
        for bearings_deg in [
            vec![10.0, 95.0, 200.0, 300.0],
            vec![10.0, 30.0, 50.0, 80.0],
            vec![1.0, 120.0, 350.0],
        ] {
            let seen = swept(4.0, 5, &bearings_deg);
            let found_s = turn_s(&seen).unwrap_or_default();
            assert!((found_s - 4.0).abs() < 1e-9, "{bearings_deg:?}: {found_s}");
            let passes = seen
                .windows(2)
                .map(|pair| passes_of_north(pair[0], pair[1], TAU / 4.0));
            assert_eq!(passes.sum::<f64>(), 4.0, "{bearings_deg:?}");
        }
    }

    #[test]
    fn rounded_times_and_plots_out_of_order_do_not_hide_it() {
        let bearings_deg: Vec<f64> = (0..180).map(|at| 2.0 * f64::from(at) + 0.5).collect();
        let mut seen = swept(4.0, 3, &bearings_deg);
        for (index, one) in seen.iter_mut().enumerate() {
            one.0 = (one.0 * 128.0).floor() / 128.0;
            one.1 -= if index % 20 == 7 { 0.05 } else { 0.0 };
        }
        let found_s = turn_s(&seen).unwrap_or_default();
        assert!((found_s - 4.0).abs() < 0.1, "{found_s}");
    }

    #[test]
    fn what_drifts_or_has_no_order_is_no_turn() {
        let every = |period_s: f64, bearings_deg: &[f64]| -> Vec<(f64, f64)> {
            let times_s = (0..bearings_deg.len()).map(|at| at as f64 * period_s);
            let bearings = bearings_deg.iter().map(|bearing| bearing.to_radians());
            times_s.zip(bearings).collect()
        };
        let clockwise: Vec<f64> = (0..100).map(|at| f64::from(300 + at) % 360.0).collect();
        assert_eq!(turn_s(&every(4.0, &clockwise)), None, "across north");
        let other_way: Vec<f64> = clockwise.iter().rev().copied().collect();
        assert_eq!(turn_s(&every(4.0, &other_way)), None);
        let beside_north = [359.9, 0.1].repeat(20);
        assert_eq!(
            turn_s(&every(4.0, &beside_north)),
            None,
            "noise about north"
        );
        let random: Vec<f64> = (0..200).map(|at| f64::from(at * at * 37 % 360)).collect();
        assert_eq!(turn_s(&every(0.5, &random)), None);
        assert_eq!(
            turn_s(&swept(4.0, 1, &[10.0, 95.0, 200.0, 300.0])),
            None,
            "one turn"
        );
        assert_eq!(turn_s(&every(4.0, &[f64::NAN; 9])), None);
    }
}
