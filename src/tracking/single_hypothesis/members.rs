//! Which tracks live, and which of them are confirmed.

use super::SingleHypothesis;
use crate::filtering::Filter;
use crate::tracking::recorder::Recorder;

impl<F: Filter<K>, const K: usize> SingleHypothesis<F, K> {
    /// Forgets the tracks that are over, and counts those that are confirmed.
    pub(super) fn sweep(&mut self, recorder: &mut dyn Recorder) -> u32 {
        let (mut confirmed, mut kept) = (0, 0);
        let recycles = self.undetected.is_some();
        let super::Memory {
            tracks,
            beliefs,
            intensity,
            ..
        } = &mut self.memory;
        for index in 0..tracks.len() {
            if tracks[index].life.is_over() {
                recorder.end(tracks[index].serial);
                if recycles {
                    intensity.push(tracks[index].life.existence(), beliefs[index]);
                }
                continue;
            }
            confirmed += u32::from(tracks[index].life.is_confirmed());
            tracks[kept] = tracks[index];
            beliefs[kept] = beliefs[index];
            kept += 1;
        }
        tracks.truncate(kept);
        beliefs.truncate(kept);
        confirmed
    }

    /// Lets the targets of all tracks last or cease.
    pub(super) fn survive(&mut self, dt_s: f64) {
        if let Some(rule) = self.lifecycle.existence_rule() {
            for track in &mut self.memory.tracks {
                track.life.survive(rule, dt_s);
            }
        }
    }

    /// Tracks with a probability of existence choose all at once.
    pub(super) fn sort_members(&mut self) {
        let together = self.lifecycle.existence_rule().is_some();
        let [confirmed, others] = &mut self.scratch.members;
        confirmed.clear();
        others.clear();
        for (index, track) in self.memory.tracks.iter().enumerate() {
            if together || track.life.is_confirmed() {
                confirmed.push(index as u32);
            } else {
                others.push(index as u32);
            }
        }
    }
}
