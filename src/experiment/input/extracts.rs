//! Recordings that come with the program.

use crate::formats::{ReadOptions, read_file};
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::scenario::RECORDINGS;
use crate::model::truth::TruthSet;

/// Twenty minutes of AIS in the Solent on 2016-01-12 (MIT, Crown copyright; `docs/licenses/MIT-Stone-Soup.txt`).
const SOLENT: &[u8] = include_bytes!("solent.csv.gz");

/// The truth of a recording.
///
/// # Errors
/// There is none of that name.
pub(super) fn truth_of(name: &str) -> Result<TruthSet, Vec<Fault>> {
    let mut bytes = match name {
        "solent" => SOLENT,
        _ => {
            let detail = format!("there is no recording '{name}'");
            let fault = Fault::new("/targets/recording", "unknown_value", detail);
            return Err(vec![fault.allowing(RECORDINGS.join(", "))]);
        }
    };
    let (read, _) = read_file("solent.csv.gz", &mut bytes, None, &ReadOptions::default())?;
    match read.dataset {
        Dataset::Truth(truth) => Ok(truth),
        _ => Err(vec![Fault::new(
            "/targets/recording",
            "unsupported",
            "it is no truth",
        )]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recordings_are_there() {
        let truth = truth_of("solent").unwrap();
        // Counted by the program `sort`: 4328 rows of 79 ships; the repeated row of line 426 is among them, or not.
        let points: usize = truth
            .targets()
            .iter()
            .map(|target| target.points.len())
            .sum();
        assert!((4325..=4328).contains(&points), "{points}");
        assert!(truth.frame.is_some() && truth.targets().len() >= 79);
        assert!(truth_of("elsewhere").is_err());
    }
}
