//! Angles are in degrees in files and in radians inside.

const RADIANS: f64 = std::f64::consts::PI / 180.0;

/// Degrees that read back as the same radians: the rounding of two conversions may miss by one step.
pub fn degrees(radians: f64) -> f64 {
    reading_back(radians.to_degrees(), |degrees| {
        degrees.to_radians() == radians
    })
}

pub fn radians_of_square_degrees(square_degrees: f64) -> f64 {
    square_degrees * (RADIANS * RADIANS)
}

/// The inverse of [`radians_of_square_degrees`], for variances.
pub fn square_degrees(square_radians: f64) -> f64 {
    reading_back(square_radians / (RADIANS * RADIANS), |degrees| {
        radians_of_square_degrees(degrees) == square_radians
    })
}

fn reading_back(nearest: f64, is_right: impl Fn(f64) -> bool) -> f64 {
    let (down, up) = (nearest.next_down(), nearest.next_up());
    let candidates = [nearest, down, up, down.next_down(), up.next_up()];
    candidates
        .into_iter()
        .find(|&candidate| is_right(candidate))
        .unwrap_or(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_was_read_once_is_written_so_that_it_reads_back(value in -1e6..1e6f64) {
            let radians = value.to_radians();
            prop_assert_eq!(degrees(radians).to_radians(), radians);
            let variance = radians_of_square_degrees(value);
            prop_assert_eq!(radians_of_square_degrees(square_degrees(variance)), variance);
        }
    }
}
