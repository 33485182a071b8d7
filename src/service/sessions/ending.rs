//! Sessions that are being closed. Who asks for one meanwhile must not read it from its log again: that would take it away from
//! whoever closes it.

use super::Sessions;
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};
use uuid::Uuid;

#[derive(Default)]
pub(super) struct Ending(Mutex<HashSet<Uuid>>);

/// Held while a session is closed.
pub(super) struct EndingOne<'s> {
    all: &'s Ending,
    id: Uuid,
}

impl Ending {
    fn change<T>(&self, work: impl FnOnce(&mut HashSet<Uuid>) -> T) -> T {
        work(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Sessions {
    /// `None` where somebody closes it already.
    pub(super) fn begin_ending(&self, id: Uuid) -> Option<EndingOne<'_>> {
        let all = &self.ending;
        let is_first = all.change(|ids| ids.insert(id));
        is_first.then_some(EndingOne { all, id })
    }

    pub(super) fn is_ending(&self, id: Uuid) -> bool {
        self.ending.change(|ids| ids.contains(&id))
    }
}

impl Drop for EndingOne<'_> {
    fn drop(&mut self) {
        self.all.change(|ids| ids.remove(&self.id));
    }
}
