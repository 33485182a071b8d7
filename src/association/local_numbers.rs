//! Numbers of a cluster's detections: those of the scan in the order in which the cluster names them, from 0. All memory
//! is reused from cluster to cluster.

#[derive(Debug, Clone, Default)]
pub(super) struct LocalNumbers {
    /// Number in the cluster of each detection of the scan; only those of the cluster are not [`NOBODY`].
    local_of: Vec<u32>,
    /// Detections of the scan that have a number.
    numbered: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

impl LocalNumbers {
    /// Forgets the cluster before.
    pub(super) fn clear(&mut self) {
        for detection in self.numbered.drain(..) {
            self.local_of[detection as usize] = NOBODY;
        }
    }

    /// The number of a detection of the scan; the next one where it has none yet.
    #[inline]
    pub(super) fn number_of(&mut self, detection: u32) -> u32 {
        let place = detection as usize;
        if self.local_of.len() <= place {
            self.local_of.resize(place + 1, NOBODY);
        }
        if self.local_of[place] == NOBODY {
            self.local_of[place] = self.numbered.len() as u32;
            self.numbered.push(detection);
        }
        self.local_of[place]
    }

    /// Detections that have a number.
    pub(super) fn len(&self) -> usize {
        self.numbered.len()
    }
}
