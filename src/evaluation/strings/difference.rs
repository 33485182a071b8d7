//! Two strings laid beside each other on the axis.

use super::normal_form::{StringSet, TrackString};
use super::step::EPSILON;
use std::ops::Range;

/// A string and the set it belongs to.
type Of<'s> = (&'s StringSet, &'s TrackString);

/// The places at which a truth string has a symbol that the output string cannot have been; outside a string is ε.
pub fn differences<'s>(
    (truths, truth): Of<'s>,
    (outputs, output): Of<'s>,
    places: Range<usize>,
) -> impl Iterator<Item = usize> + 's {
    let symbols = truths.symbols_of(truth);
    let decided = if outputs.has_choices() {
        None
    } else {
        Some(outputs.symbols_of(output))
    };
    let (truth_start, output_start) = (truth.start, output.start);
    places.filter(move |&position| {
        let symbol = symbols
            .get(position.wrapping_sub(truth_start))
            .copied()
            .unwrap_or(EPSILON);
        match decided {
            Some(decided) => {
                decided
                    .get(position.wrapping_sub(output_start))
                    .copied()
                    .unwrap_or(EPSILON)
                    != symbol
            }
            None => outputs.weight_at(output, position, symbol).is_none(),
        }
    })
}
