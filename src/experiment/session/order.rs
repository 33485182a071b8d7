//! What becomes of scans that come after later ones.
//!
//! # Method
//! - `drop`: a scan that is not after the last one taken is dropped.
//! - `wait`: scans are kept in order until later data are `delay_s` ahead or every sensor was heard since; what then comes before
//!   the last one taken is dropped.
//! - `replay`: the scans of the last `window_s` are kept, and a copy of the tracker before every k-th of them, k the root of how
//!   many there are. A late scan takes the newest copy before it, and the scans since are taken again: exact for every tracker,
//!   at the cost of those scans. A scan before the oldest copy is dropped.

use super::book::Book;
use super::feeds::{Feed, newest_s};
use super::line::{Kept, Key, Line};
use super::picture::RecentScans;
use super::scene::Scene;
use super::spec::LatePolicy;
use super::trails::Trails;
use crate::model::fault::Fault;
use std::collections::VecDeque;

/// Scans that are kept, in order.
#[derive(Default)]
pub struct Order {
    /// Of `wait`: not yet taken.
    pub waiting: VecDeque<Kept>,
    /// Of `replay`: taken, but a late one may come before them.
    pub window: VecDeque<InWindow>,
}

/// A scan that was taken, with the tracker before it where that is kept.
pub struct InWindow {
    pub kept: Kept,
    pub before: Option<Box<Line>>,
}

/// What became of a scan.
pub enum Fate {
    /// It was taken, and so many others with it.
    Taken,
    Waiting,
    Dropped,
    /// It was put before so many scans that had been taken, after which this had been known.
    Replayed {
        again: usize,
        before: Book,
    },
}

/// Everything that a scan can change.
pub struct Course<'a> {
    pub line: &'a mut Line,
    pub trails: &'a mut Trails,
    pub recent: &'a mut RecentScans,
    pub scene: &'a Scene,
}

impl Course<'_> {
    /// Takes a scan that was not taken before.
    fn step_first(&mut self, kept: &Kept) -> Result<(), Box<Fault>> {
        self.recent.push(kept, self.scene);
        self.step(kept)
    }

    fn step(&mut self, kept: &Kept) -> Result<(), Box<Fault>> {
        self.line.step(kept, self.scene, self.trails)
    }
}

impl Order {
    /// Takes a scan.
    ///
    /// # Errors
    /// The tracker is of no use any more.
    pub fn take(
        &mut self,
        kept: Kept,
        feeds: &[Feed],
        mut course: Course,
    ) -> Result<Fate, Box<Fault>> {
        let key = kept.key();
        match course.scene.rules().late {
            LatePolicy::Replay => self.replay(kept, &mut course),
            _ if course.line.is_late(key) => Ok(Fate::Dropped),
            LatePolicy::Drop => {
                course.step_first(&kept)?;
                Ok(Fate::Taken)
            }
            LatePolicy::Wait => {
                let place = self.waiting.partition_point(|other| other.key() <= key);
                if place > 0 && self.waiting[place - 1].key() == key {
                    return Ok(Fate::Dropped);
                }
                self.waiting.insert(place, kept);
                self.release(feeds, &mut course)?;
                let is_waiting = self.waiting.iter().any(|other| other.key() == key);
                Ok(if is_waiting {
                    Fate::Waiting
                } else {
                    Fate::Taken
                })
            }
        }
    }

    /// Takes the scans that need not wait any more.
    ///
    /// # Errors
    /// As [`Order::take`].
    pub fn release(&mut self, feeds: &[Feed], course: &mut Course) -> Result<(), Box<Fault>> {
        let rules = *course.scene.rules();
        let newest_s = newest_s(feeds).unwrap_or(f64::NEG_INFINITY);
        while let Some(first) = self.waiting.front() {
            let time_s = first.scan.time_s;
            let is_heard = |feed: &Feed| feed.newest_s.is_some_and(|newest_s| newest_s >= time_s);
            let is_due = time_s + rules.delay_s <= newest_s
                || feeds.iter().all(is_heard)
                || self.waiting.len() > rules.max_window_scans;
            if !is_due {
                break;
            }
            if let Some(first) = self.waiting.pop_front() {
                course.step_first(&first)?;
            }
        }
        Ok(())
    }

    /// Takes all that wait: nothing follows.
    ///
    /// # Errors
    /// As [`Order::take`].
    pub fn flush(&mut self, course: &mut Course) -> Result<(), Box<Fault>> {
        for kept in std::mem::take(&mut self.waiting) {
            course.step_first(&kept)?;
        }
        Ok(())
    }

    /// No late scan comes before what was taken so far: people have done something about the tracks as they are.
    pub fn decide(&mut self) {
        self.window.clear();
    }

    fn replay(&mut self, kept: Kept, course: &mut Course) -> Result<Fate, Box<Fault>> {
        let key = kept.key();
        if !course.line.is_late(key) {
            course.recent.push(&kept, course.scene);
            self.append(kept, course)?;
            self.trim(course);
            return Ok(Fate::Taken);
        }
        let place = self.window.partition_point(|other| other.kept.key() < key);
        let is_there = self
            .window
            .get(place)
            .is_some_and(|other| other.kept.key() == key);
        let newest_s = course.line.last.map_or(key.time_s, |last| last.time_s);
        let is_past = newest_s - key.time_s > course.scene.rules().window_s;
        if is_there || is_past || !self.reaches(key) {
            return Ok(Fate::Dropped);
        }
        let first = self.newest_copy(place);
        let Some(copy) = self.window[first].before.take() else {
            return Ok(Fate::Dropped);
        };
        course.recent.push(&kept, course.scene);
        let before = std::mem::replace(course.line, *copy).book;
        let from_s = self.window[first].kept.scan.time_s;
        course.trails.cut(from_s.min(key.time_s));
        let count = self.window.len() - place;
        let again = self.window.split_off(first);
        let mut late = Some(kept);
        for entry in again {
            if let Some(kept) = late.take_if(|kept| kept.key() < entry.kept.key()) {
                self.append(kept, course)?;
            }
            self.append(entry.kept, course)?;
        }
        if let Some(kept) = late {
            self.append(kept, course)?;
        }
        Ok(Fate::Replayed {
            again: count,
            before,
        })
    }

    /// Whether there is a copy of the tracker before this.
    fn reaches(&self, key: Key) -> bool {
        let copy = self.window.front().and_then(|entry| entry.before.as_ref());
        copy.is_some_and(|copy| !copy.is_late(key))
    }

    /// Index of the newest scan at or before `place` before which the tracker was kept.
    fn newest_copy(&self, place: usize) -> usize {
        let last = place.min(self.window.len().saturating_sub(1));
        let has_copy = |index: &usize| self.window[*index].before.is_some();
        (0..=last).rev().find(has_copy).unwrap_or(0)
    }

    /// Takes the next scan, and keeps it.
    fn append(&mut self, kept: Kept, course: &mut Course) -> Result<(), Box<Fault>> {
        let since = self.window.iter().rev();
        let since = since.take_while(|entry| entry.before.is_none()).count();
        let spacing = self.window.len().isqrt();
        let is_due = self.window.is_empty() || since >= spacing;
        self.append_copied(kept, is_due, course)
    }

    /// The same, with the tracker before it where that is to be kept.
    ///
    /// # Errors
    /// As [`Order::take`].
    pub fn append_copied(
        &mut self,
        kept: Kept,
        is_copied: bool,
        course: &mut Course,
    ) -> Result<(), Box<Fault>> {
        let before = is_copied.then(|| Box::new(course.line.fork()));
        course.step(&kept)?;
        self.window.push_back(InWindow { kept, before });
        Ok(())
    }

    /// Forgets what no late scan can come before.
    fn trim(&mut self, course: &Course) {
        let rules = course.scene.rules();
        let newest_s = course.line.last.map_or(0.0, |last| last.time_s);
        loop {
            let next = self.window.iter().skip(1);
            let Some(next) = next.map(|entry| entry.before.is_some()).position(|is| is) else {
                return;
            };
            let next = next + 1;
            // Scans before the next copy go when it reaches back far enough by itself.
            let copied_s = self.window[next - 1].kept.scan.time_s;
            let is_old = copied_s < newest_s - rules.window_s;
            if !is_old && self.window.len() <= rules.max_window_scans {
                return;
            }
            self.window.drain(..next);
        }
    }
}
