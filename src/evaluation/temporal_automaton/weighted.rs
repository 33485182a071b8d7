//! How probable each target's truth string is under the automaton, scan by scan.
//!
//! At each scan of a truth string: the weight that the track which speaks for it gave to the very symbol of the truth,
//! 0 where it took something else or where no track speaks; and the logarithm of the product of these weights up to the scan,
//! which ends where a weight is 0.

use super::verdict::Sides;
use crate::evaluation::strings::Strings;
use crate::evaluation::strings::step::EPSILON;

/// One scan of a truth string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScanProbability {
    /// Index of the target.
    pub target: u32,
    pub position: usize,
    pub symbol: Option<u32>,
    /// Index of the track that speaks.
    pub track: Option<u32>,
    pub probability: f64,
    /// `None` once a probability was 0.
    pub log_probability: Option<f64>,
}

/// Every scan of every truth string, by target and scan.
pub fn scan_probabilities(strings: &Strings, sides: Sides) -> Vec<ScanProbability> {
    let truth = &strings.truth;
    let mut all = Vec::new();
    let mut log_probability = Some(0.0);
    for string in truth.strings() {
        if string.part == 0 {
            log_probability = Some(0.0);
        }
        let speaker = sides
            .speaker(string)
            .map(|speaker| &sides.outputs.strings()[speaker.output]);
        for (offset, &symbol) in truth.symbols_of(string).iter().enumerate() {
            let position = string.start + offset;
            let weight = speaker.and_then(|track| sides.outputs.weight_at(track, position, symbol));
            let probability = weight.unwrap_or(0.0);
            log_probability = log_probability
                .filter(|_| probability > 0.0)
                .map(|so_far| so_far + probability.ln());
            all.push(ScanProbability {
                target: string.owner,
                position,
                symbol: Some(symbol).filter(|&symbol| symbol != EPSILON),
                track: speaker.map(|track| track.owner),
                probability,
                log_probability,
            });
        }
    }
    all
}
