//! How much a comparison may hold: points and pairs are counted while they are found, so that what is too much is refused
//! before memory is, and a job that is to stop does.

use crate::model::allowance::{MAX_IDS, MAX_PAIRS, MAX_PAIRS_OF_STEP, MAX_POINTS, too_large};
use crate::model::watch::{Halt, Watch};

/// What the comparisons of one job hold so far.
#[derive(Debug)]
pub struct Extent<'a> {
    watch: &'a Watch<'a>,
    bounds: Bounds,
    pairs: usize,
    points: usize,
    ids: usize,
    halt: Option<Halt>,
}

#[derive(Debug, Clone, Copy)]
struct Bounds {
    pairs: usize,
    pairs_of_step: usize,
    points: usize,
    ids: usize,
}

const OF_JOBS: Bounds = Bounds {
    pairs: MAX_PAIRS,
    pairs_of_step: MAX_PAIRS_OF_STEP,
    points: MAX_POINTS,
    ids: MAX_IDS,
};
const NONE: Bounds = Bounds {
    pairs: usize::MAX,
    pairs_of_step: usize::MAX,
    points: usize::MAX,
    ids: usize::MAX,
};

const FEWER_PAIRS: &str =
    "a smaller gate or cutoff, fewer objects at one place, or fewer steps in a job";
const FEWER_POINTS: &str = "a part of the steps in each job";
const FEWER_IDS: &str = "a part of the targets and tracks in each job";

impl<'a> Extent<'a> {
    /// Of the comparisons of a job.
    pub fn new(watch: &'a Watch<'a>) -> Self {
        Extent {
            watch,
            bounds: OF_JOBS,
            pairs: 0,
            points: 0,
            ids: 0,
            halt: None,
        }
    }

    /// Without bounds, for whoever knows how large a comparison is.
    pub fn unbounded(watch: &'a Watch<'a>) -> Self {
        Extent {
            bounds: NONE,
            ..Extent::new(watch)
        }
    }

    /// Counts targets and tracks.
    pub fn add_ids(&mut self, ids: usize) {
        self.ids += ids;
        if self.ids > self.bounds.ids {
            self.refuse("targets and tracks", self.ids, self.bounds.ids, FEWER_IDS);
        }
    }

    /// Counts points of truth or of tracks at the steps; whether to go on.
    pub fn add_points(&mut self, points: usize) -> bool {
        self.points += points;
        if self.points > self.bounds.points {
            self.refuse(
                "points of truth and tracks at the steps",
                self.points,
                self.bounds.points,
                FEWER_POINTS,
            );
        }
        self.goes_on(points)
    }

    /// Counts work in so many pieces; whether to go on.
    pub fn goes_on(&mut self, pieces: usize) -> bool {
        if self.halt.is_none() && self.watch.stops_after(pieces as u64) {
            self.halt = Some(Halt::Stopped);
        }
        self.halt.is_none()
    }

    /// Looks at the pairs that a step has so far, found by looking at so many; whether to go on.
    pub fn goes_on_with(&mut self, pairs: usize, looked_at: usize) -> bool {
        if pairs > self.bounds.pairs_of_step {
            self.refuse(
                "pairs within reach of each other in one step",
                pairs,
                self.bounds.pairs_of_step,
                FEWER_PAIRS,
            );
        } else if self.pairs + pairs > self.bounds.pairs {
            self.refuse(
                "pairs within reach of each other",
                self.pairs + pairs,
                self.bounds.pairs,
                FEWER_PAIRS,
            );
        }
        self.goes_on(looked_at)
    }

    /// Counts the pairs of a whole step; whether to go on.
    pub fn end_step(&mut self, pairs: usize) -> bool {
        self.pairs += pairs;
        self.halt.is_none()
    }

    fn refuse(&mut self, what: &str, found: usize, most: usize, remedy: &str) {
        self.halt.get_or_insert_with(|| {
            Halt::TooLarge(Box::new(too_large(
                "/comparison",
                what,
                found,
                most,
                remedy,
            )))
        });
    }

    /// # Errors
    /// Why the comparisons are not whole.
    pub fn finish(self) -> Result<(), Halt> {
        self.halt.map_or(Ok(()), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    /// Why a comparison is not whole, told by code, detail and bound.
    fn refusal(use_up: impl FnOnce(&mut Extent)) -> Option<(String, String)> {
        let watch = Watch::never();
        let mut extent = Extent::new(&watch);
        use_up(&mut extent);
        match extent.finish() {
            Err(Halt::TooLarge(fault)) => {
                Some((fault.detail, fault.allowed.unwrap_or_default().into()))
            }
            Err(halt) => panic!("nobody asked for {halt:?}"),
            Ok(()) => None,
        }
    }

    #[test]
    fn the_first_bound_that_is_broken_is_told() {
        let whole = |extent: &mut Extent| {
            extent.add_ids(MAX_IDS);
            assert!(
                extent.add_points(MAX_POINTS)
                    && extent.goes_on_with(MAX_PAIRS_OF_STEP, 0)
                    && extent.end_step(MAX_PAIRS)
            );
        };
        assert_eq!(refusal(whole), None);
        let points = |extent: &mut Extent| {
            assert!(
                extent.add_points(MAX_POINTS)
                    && !extent.add_points(1)
                    && !extent.goes_on_with(MAX_PAIRS_OF_STEP + 1, 0)
            );
        };
        let told = (
            "there are 10000001 points of truth and tracks at the steps or more",
            "at most 10000000; a part of the steps in each job",
        );
        assert_eq!(
            refusal(points),
            Some((told.0.to_owned(), told.1.to_owned()))
        );
        let pairs =
            |extent: &mut Extent| assert!(extent.end_step(MAX_PAIRS) && !extent.goes_on_with(1, 0));
        assert_eq!(
            refusal(pairs).map(|told| told.0),
            Some("there are 20000001 pairs within reach of each other or more".to_owned())
        );
        let ids = |extent: &mut Extent| extent.add_ids(MAX_IDS + 1);
        assert_eq!(
            refusal(ids).map(|told| told.0),
            Some("there are 1000001 targets and tracks or more".to_owned())
        );
    }

    #[test]
    fn it_has_no_bounds_unless_it_is_of_a_job_and_stops_when_asked_to() {
        let question = || ControlFlow::Break(());
        let watch = Watch::new(&question);
        let mut extent = Extent::unbounded(&watch);
        extent.add_ids(usize::MAX / 2);
        assert!(extent.goes_on_with(usize::MAX / 2, 0));
        assert!(!extent.goes_on(usize::MAX));
        assert_eq!(extent.finish(), Err(Halt::Stopped));
    }
}
