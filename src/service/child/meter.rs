//! Watches a job from inside: how far it is, how long each step took, and whether it is to stop.

use crate::experiment::JobKind;
use crate::experiment::observer::{Observer, Step};
use crate::service::types::{Progress, Timing};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

pub(in crate::service) struct Meter {
    kind: JobKind,
    /// Whether it is not wanted any more.
    stop: Arc<AtomicBool>,
    news: Box<dyn FnMut(Progress)>,
    started: Instant,
    /// When the observer was last called, and in which step.
    last: (Instant, Step),
    notified: Option<Instant>,
    timing: Timing,
}

impl Meter {
    pub(in crate::service) fn new(
        kind: JobKind,
        stop: Arc<AtomicBool>,
        news: impl FnMut(Progress) + 'static,
    ) -> Self {
        let now = Instant::now();
        Meter {
            kind,
            stop,
            news: Box::new(news),
            started: now,
            last: (now, Step::Load),
            notified: None,
            timing: Timing::default(),
        }
    }

    /// What was measured until now.
    pub(in crate::service) fn timing(&self) -> Timing {
        Timing {
            total_s: self.started.elapsed().as_secs_f64(),
            ..self.timing.clone()
        }
    }

    /// The time since the last call belongs to the step that this call is about, or, when it only begins, to the one before.
    fn book(&mut self, now: Instant, step: Step, done: u64) {
        let spent_s = now.duration_since(self.last.0).as_secs_f64();
        let place = match if done == 0 { self.last.1 } else { step } {
            Step::Load => &mut self.timing.load_s,
            Step::Simulate => &mut self.timing.simulate_s,
            Step::Detect => &mut self.timing.detect_s,
            Step::Associate => &mut self.timing.associate_s,
            Step::Correlate => &mut self.timing.correlate_s,
            Step::Evaluate => &mut self.timing.evaluate_s,
            // Writing is not computing, and runs have all steps; both are in the total.
            Step::Run | Step::Write => return self.last = (now, step),
        };
        *place += spent_s;
        self.last = (now, step);
    }

    fn tell(&mut self, now: Instant, step: Step, done: u64, total: u64) {
        let elapsed = now.duration_since(self.started);
        let pause = Progress::pause_after(elapsed);
        if self
            .notified
            .is_some_and(|notified| now.duration_since(notified) < pause)
        {
            return;
        }
        self.notified = Some(now);
        let fraction = fraction(self.kind, step, done, total);
        let eta_s = Progress::left_s(elapsed, fraction);
        (self.news)(Progress {
            step,
            done,
            total,
            fraction,
            eta_s,
        });
    }
}

impl Observer for Meter {
    fn now(&self) -> Option<Duration> {
        Some(self.started.elapsed())
    }

    fn progress(&mut self, step: Step, done: u64, total: u64) -> ControlFlow<()> {
        let now = Instant::now();
        self.book(now, step, done);
        self.tell(now, step, done, total);
        if self.stop.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

/// The share of the whole job that is done. Steps count by what they usually cost; one that does not occur is skipped.
fn fraction(kind: JobKind, step: Step, done: u64, total: u64) -> f64 {
    let shares = match kind {
        JobKind::Simulate => [0.0, 0.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.2],
        JobKind::Associate => [0.1, 0.0, 0.1, 0.05, 0.65, 0.0, 0.0, 0.1],
        JobKind::Evaluate => [0.1, 0.0, 0.1, 0.05, 0.45, 0.0, 0.2, 0.1],
        JobKind::Group => [0.1, 0.0, 0.2, 0.0, 0.5, 0.0, 0.1, 0.1],
        JobKind::Correlate => [0.1, 0.0, 0.1, 0.0, 0.2, 0.4, 0.1, 0.1],
        JobKind::Campaign => [0.02, 0.96, 0.0, 0.0, 0.0, 0.0, 0.0, 0.02],
    };
    let index = step as usize;
    let before: f64 = shares[..index].iter().sum();
    let part = if total == 0 {
        0.0
    } else {
        done as f64 / total as f64
    };
    (before + shares[index] * part).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::rc::Rc;

    #[test]
    fn the_fraction_rises_through_the_steps_to_one() {
        let steps = [
            Step::Load,
            Step::Run,
            Step::Simulate,
            Step::Detect,
            Step::Associate,
            Step::Evaluate,
            Step::Write,
        ];
        for kind in JobKind::ALL {
            let fractions: Vec<f64> = steps
                .iter()
                .flat_map(|&step| [0, 5, 10].map(|done| fraction(kind, step, done, 10)))
                .collect();
            assert!(fractions.is_sorted(), "{kind:?}: {fractions:?}");
            assert!(
                (fractions[20] - 1.0).abs() < 1e-12,
                "{kind:?} ends at {}",
                fractions[20]
            );
        }
    }

    #[test]
    fn a_stop_sign_breaks_and_the_first_news_are_told_at_once() {
        let (stop, told) = (
            Arc::new(AtomicBool::new(false)),
            Rc::new(RefCell::new(Vec::new())),
        );
        let news = told.clone();
        let mut meter = Meter::new(JobKind::Associate, stop.clone(), move |progress| {
            news.borrow_mut().push(progress)
        });
        assert!(meter.progress(Step::Associate, 5, 10).is_continue());
        let first = told.borrow()[0].clone();
        assert_eq!(
            (first.step, first.done, first.total, first.eta_s),
            (Step::Associate, 5, 10, None)
        );
        assert!((first.fraction - 0.575).abs() < 1e-12);
        assert!(meter.progress(Step::Associate, 6, 10).is_continue());
        assert_eq!(
            told.borrow().len(),
            1,
            "the second comes too soon to be told"
        );
        stop.store(true, Ordering::Relaxed);
        assert!(meter.progress(Step::Associate, 7, 10).is_break());
    }

    #[test]
    fn time_is_booked_on_the_step_that_spent_it() {
        let mut meter = Meter::new(JobKind::Evaluate, Arc::default(), |_| {});
        let start = meter.started;
        let at = |seconds| start + Duration::from_secs(seconds);
        meter.book(at(1), Step::Load, 1);
        meter.book(at(3), Step::Associate, 1);
        meter.book(at(6), Step::Associate, 2);
        meter.book(at(10), Step::Evaluate, 0);
        meter.book(at(15), Step::Evaluate, 1);
        meter.book(at(16), Step::Write, 1);
        let Timing {
            load_s,
            associate_s,
            evaluate_s,
            simulate_s,
            ..
        } = meter.timing;
        assert_eq!(
            (load_s, simulate_s, associate_s, evaluate_s),
            (1.0, 0.0, 9.0, 5.0)
        );
    }
}
