//! Turns of antennas as they come: at the times that a radar says it passes north, else where its bearings fall by more than half
//! a turn.

use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Numbers of turns that are told by bearings alone lie below those of turns that are told by north.
const UNTOLD: i64 = i64::MIN / 2;

/// What is known of the turns of one sensor.
#[derive(Debug, Clone, Copy, Default)]
struct Turn {
    north_s: Option<f64>,
    latest_north_s: Option<f64>,
    period_s: Option<f64>,
    /// Turns so far, and the bearing before, where nothing tells north.
    counted: i64,
    before_rad: f64,
}

/// The turns of every sensor.
#[derive(Debug, Default)]
pub(super) struct Turns(BTreeMap<u32, Turn>);

impl Turns {
    /// The antenna passes north.
    pub fn north(&mut self, sensor: u32, time_s: f64) {
        let turn = self.0.entry(sensor).or_default();
        turn.north_s.get_or_insert(time_s);
        let since_s = turn
            .latest_north_s
            .map_or(0.0, |before_s| time_s - before_s);
        if since_s > 0.0 {
            turn.period_s.get_or_insert(since_s);
        }
        turn.latest_north_s = Some(time_s);
    }

    /// The radar says the time of one turn; the first word counts, so that numbers go on.
    pub fn rotates(&mut self, sensor: u32, period_s: f64) {
        if period_s > 0.0 {
            self.0
                .entry(sensor)
                .or_default()
                .period_s
                .get_or_insert(period_s);
        }
    }

    /// The number of the turn in which a bearing was measured.
    pub fn number(&mut self, sensor: u32, time_s: f64, bearing_rad: f64) -> i64 {
        let turn = self.0.entry(sensor).or_default();
        if let (Some(north_s), Some(period_s)) = (turn.north_s, turn.period_s) {
            return ((time_s - north_s) / period_s).floor() as i64;
        }
        turn.counted += i64::from(turn.before_rad - bearing_rad > PI);
        turn.before_rad = bearing_rad;
        UNTOLD + turn.counted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bearings_tell_turns_until_north_is_told() {
        let mut turns = Turns::default();
        let mut by_bearing = |bearing_rad| turns.number(3, 0.0, bearing_rad) - UNTOLD;
        assert_eq!(
            [1.0, 6.0, 0.5, 0.4, 5.0, 0.1].map(&mut by_bearing),
            [0, 0, 1, 1, 1, 2]
        );
        turns.north(3, 100.0);
        turns.rotates(3, 4.0);
        turns.rotates(3, 8.0);
        assert_eq!(
            [99.0, 100.0, 103.9, 108.0].map(|time_s| turns.number(3, time_s, 1.0)),
            [-1, 0, 0, 2]
        );
        assert_eq!(
            turns.number(4, 1.0, 1.0),
            UNTOLD,
            "sensors turn by themselves"
        );
    }

    #[test]
    fn two_passes_of_north_tell_the_period() {
        let mut turns = Turns::default();
        turns.north(1, 10.0);
        turns.north(1, 15.0);
        turns.north(1, 19.0);
        assert_eq!(turns.number(1, 24.9, 0.0), 2);
    }
}
