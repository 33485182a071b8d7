//! What a recording knows of its detections beside their measurements.

use std::collections::BTreeMap;
use std::ops::Range;

/// One entry a detection in each list that is not empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Beside {
    /// When the detection was made, of a sensor that does not see everything at once (s).
    pub times_s: Vec<f64>,
    /// How high the target was, where that is known. No distance reads it.
    pub heights_m: Vec<Option<f64>>,
    /// By the names of [`super::attributes::ATTRIBUTES`].
    pub attributes: BTreeMap<&'static str, Labels>,
}

/// Texts of which many are the same: their number for each detection; `None` where there is none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Labels {
    pub texts: Vec<String>,
    pub of: Vec<Option<u32>>,
}

impl Labels {
    pub fn get(&self, index: usize) -> Option<&str> {
        let number = (*self.of.get(index)?)?;
        Some(self.texts[number as usize].as_str())
    }
}

impl Beside {
    /// Adds what `other` knows of a range of its detections.
    pub fn extend(&mut self, other: &Beside, range: Range<usize>) {
        if !other.times_s.is_empty() {
            self.times_s
                .extend_from_slice(&other.times_s[range.clone()]);
        }
        if !other.heights_m.is_empty() {
            self.heights_m
                .extend_from_slice(&other.heights_m[range.clone()]);
        }
        for (name, labels) in &other.attributes {
            let kept = self.attributes.entry(name).or_default();
            if kept.texts.is_empty() {
                kept.texts.clone_from(&labels.texts);
            }
            kept.of.extend_from_slice(&labels.of[range.clone()]);
        }
    }

    /// Whether every list is empty or has an entry for each of so many detections.
    pub fn fits(&self, detections: usize) -> bool {
        let fits = |entries: usize| entries == 0 || entries == detections;
        fits(self.times_s.len())
            && fits(self.heights_m.len())
            && self.attributes.values().all(|labels| fits(labels.of.len()))
    }
}
