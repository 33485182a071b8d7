//! A bearing-time record: the level that a beamformer found in each cell of bearing at each time.

use super::fault::Fault;
use std::f64::consts::TAU;

/// Cells of a record; more do not fit a job.
pub const MAX_CELLS: usize = 20_000_000;

/// A gap of the axis wider than this many of its mean steps is left open: the record covers a sector.
const WIDEST_JOINT_STEPS: f64 = 1.5;

/// The parts of a [`BearingTimeRecord`]; its constructor checks that they fit together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BearingTimeParts {
    /// Strictly rising.
    pub times_s: Vec<f64>,
    /// Centres of the cells, strictly rising, less than a full turn from first to last.
    pub bearings_rad: Vec<f64>,
    /// One row of cells a time, in dB.
    pub levels_db: Vec<f32>,
}

/// A checked record: at least one time and two cells, axes that rise, finite levels.
#[derive(Debug, Clone, PartialEq)]
pub struct BearingTimeRecord(BearingTimeParts);

impl std::ops::Deref for BearingTimeRecord {
    type Target = BearingTimeParts;
    fn deref(&self) -> &BearingTimeParts {
        &self.0
    }
}

impl BearingTimeRecord {
    /// # Errors
    /// All faults: an empty axis, axes that do not rise, bearings more than a turn apart, a number of levels that is not that
    /// of the cells, too many of them, values that are not finite.
    pub fn new(parts: BearingTimeParts) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        axis_faults("times_s", &parts.times_s, 1, &mut faults);
        axis_faults("bearings_rad", &parts.bearings_rad, 2, &mut faults);
        if let (Some(first), Some(last)) = (parts.bearings_rad.first(), parts.bearings_rad.last())
            && last - first >= TAU - 1e-9
        {
            let detail = format!(
                "the bearings reach over {} degrees",
                (last - first).to_degrees()
            );
            faults.push(
                Fault::new("/bearings_rad", "out_of_range", detail)
                    .allowing("less than a turn from the first to the last"),
            );
        }
        let cells = parts.times_s.len().saturating_mul(parts.bearings_rad.len());
        if cells > MAX_CELLS {
            faults.push(
                Fault::new(
                    "/levels_db",
                    "too_large",
                    format!("the record has {cells} cells"),
                )
                .allowing(format!("<= {MAX_CELLS}")),
            );
        }
        if cells != parts.levels_db.len() {
            let detail = format!(
                "there are {} levels for {cells} cells",
                parts.levels_db.len()
            );
            faults.push(Fault::new("/levels_db", "malformed", detail));
        }
        if let Some(index) = parts.levels_db.iter().position(|level| !level.is_finite()) {
            faults.push(Fault::new(
                format!("/levels_db/{index}"),
                "not_finite",
                "a level is not a finite number",
            ));
        }
        if faults.is_empty() {
            Ok(BearingTimeRecord(parts))
        } else {
            Err(faults)
        }
    }

    /// Cells of a row.
    pub fn width(&self) -> usize {
        self.bearings_rad.len()
    }

    /// The levels at one time.
    pub fn row(&self, index: usize) -> &[f32] {
        &self.levels_db[index * self.width()..(index + 1) * self.width()]
    }

    /// The first times of the record, one at least.
    #[must_use]
    pub fn head(&self, times: usize) -> BearingTimeRecord {
        let times = times.clamp(1, self.times_s.len());
        BearingTimeRecord(BearingTimeParts {
            times_s: self.times_s[..times].to_vec(),
            bearings_rad: self.bearings_rad.clone(),
            levels_db: self.levels_db[..times * self.width()].to_vec(),
        })
    }

    /// Mean distance of neighbouring cells.
    pub fn cell_rad(&self) -> f64 {
        self.reach_rad() / (self.width() - 1) as f64
    }

    /// Mean distance of neighbouring times; `None` of a single one.
    pub fn time_step_s(&self) -> Option<f64> {
        let steps = self.times_s.len() - 1;
        (steps > 0).then(|| (self.times_s[steps] - self.times_s[0]) / steps as f64)
    }

    /// Whether the last cell is the first one's neighbour: the axis goes round.
    pub fn wraps(&self) -> bool {
        self.width() > 2 && TAU - self.reach_rad() <= WIDEST_JOINT_STEPS * self.cell_rad()
    }

    /// What the cells cover: the whole turn, or a cell more than from the first centre to the last.
    pub fn span_rad(&self) -> f64 {
        if self.wraps() {
            TAU
        } else {
            (self.reach_rad() + self.cell_rad()).min(TAU)
        }
    }

    fn reach_rad(&self) -> f64 {
        self.bearings_rad[self.width() - 1] - self.bearings_rad[0]
    }
}

fn axis_faults(name: &str, values: &[f64], least: usize, faults: &mut Vec<Fault>) {
    if values.len() < least {
        let detail = format!("the axis {name} has {} values", values.len());
        faults
            .push(Fault::new(format!("/{name}"), "empty", detail).allowing(format!(">= {least}")));
    }
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        faults.push(Fault::new(
            format!("/{name}/{index}"),
            "not_finite",
            format!("the axis {name} has a value that is not finite"),
        ));
    } else if let Some(index) = values.windows(2).position(|pair| pair[0] >= pair[1]) {
        faults.push(Fault::new(
            format!("/{name}/{}", index + 1),
            "unsorted",
            format!("the axis {name} does not rise strictly"),
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(times_s: &[f64], bearings_deg: &[f64]) -> BearingTimeParts {
        BearingTimeParts {
            times_s: times_s.to_vec(),
            bearings_rad: bearings_deg
                .iter()
                .map(|degrees| degrees.to_radians())
                .collect(),
            levels_db: vec![60.0; times_s.len() * bearings_deg.len()],
        }
    }

    #[test]
    fn a_full_turn_wraps_and_a_sector_does_not() {
        let turn: Vec<f64> = (0..360).map(|cell| f64::from(cell) + 0.5).collect();
        let record = BearingTimeRecord::new(parts(&[0.0, 1.0, 4.0], &turn)).unwrap();
        assert!(record.wraps() && (record.span_rad() - TAU).abs() < 1e-12);
        assert!((record.cell_rad().to_degrees() - 1.0).abs() < 1e-12);
        assert_eq!(record.time_step_s(), Some(2.0));
        let sector = BearingTimeRecord::new(parts(&[0.0], &turn[10..350])).unwrap();
        assert!(!sector.wraps() && (sector.span_rad().to_degrees() - 340.0).abs() < 1e-9);
        assert_eq!(sector.time_step_s(), None);
    }

    #[test]
    fn every_fault_is_told_at_once() {
        let mut bad = parts(&[1.0, 1.0], &[0.0, 360.0]);
        bad.levels_db.push(f32::NAN);
        let found = |parts| -> Vec<(String, String)> {
            BearingTimeRecord::new(parts)
                .unwrap_err()
                .into_iter()
                .map(|fault| (fault.pointer, fault.code))
                .collect()
        };
        let pair = |pointer: &str, code: &str| (pointer.to_owned(), code.to_owned());
        assert_eq!(
            found(bad),
            [
                pair("/times_s/1", "unsorted"),
                pair("/bearings_rad", "out_of_range"),
                pair("/levels_db", "malformed"),
                pair("/levels_db/4", "not_finite")
            ]
        );
        assert_eq!(
            found(parts(&[], &[1.0])),
            [pair("/times_s", "empty"), pair("/bearings_rad", "empty")]
        );
        assert_eq!(
            found(parts(&[f64::INFINITY], &[1.0, 2.0])),
            [pair("/times_s/0", "not_finite")]
        );
    }

    #[test]
    fn more_cells_than_fit_are_refused() {
        let times_s: Vec<f64> = (0..20_001).map(f64::from).collect();
        let bearings_rad: Vec<f64> = (0..1000).map(|cell| f64::from(cell) * 0.001).collect();
        let faults = BearingTimeRecord::new(BearingTimeParts {
            times_s,
            bearings_rad,
            levels_db: Vec::new(),
        })
        .unwrap_err();
        assert_eq!(faults[0].code, "too_large");
    }
}
