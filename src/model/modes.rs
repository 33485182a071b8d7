//! How probable each motion model of a filter was at each point of its tracks: a table beside the tracks, with rows that points name.

use std::num::NonZeroU32;

/// Models of a filter at the most.
pub const MAX_MODES: usize = 6;

/// A row of a [`ModeTable`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModeRow(NonZeroU32);

/// Rows of probabilities, one for each model; rows of all tracks of a set are equally long.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModeTable {
    modes: usize,
    values: Vec<f64>,
}

impl ModeTable {
    /// Models; 0 where nothing is told of them.
    pub fn modes(&self) -> usize {
        self.modes
    }

    /// One more row; `None` of no model, and of another number of models than the first row has.
    pub fn push(&mut self, probabilities: &[f64]) -> Option<ModeRow> {
        if self.values.is_empty() {
            self.modes = probabilities.len();
        }
        if probabilities.len() != self.modes || self.modes == 0 {
            return None;
        }
        self.values.extend_from_slice(probabilities);
        let rows = u32::try_from(self.values.len() / self.modes).ok()?;
        NonZeroU32::new(rows).map(ModeRow)
    }

    /// The probabilities of a row, if it is one of this table.
    pub fn row(&self, row: ModeRow) -> Option<&[f64]> {
        self.values
            .chunks(self.modes.max(1))
            .nth(row.0.get() as usize - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_as_they_were_pushed() {
        let mut table = ModeTable::default();
        assert_eq!((table.push(&[]), table.modes()), (None, 0));
        let first = table.push(&[0.75, 0.25]).unwrap();
        let second = table.push(&[0.5, 0.5]).unwrap();
        assert_eq!(table.push(&[1.0]), None, "of one model beside two");
        assert_eq!(table.row(second), Some(&[0.5, 0.5][..]));
        assert_eq!(table.row(first), Some(&[0.75, 0.25][..]));
        assert_eq!(ModeTable::default().row(first), None);
    }
}
