//! What the reports of a path say of who it is, report by report, where that changes.

use super::{Attribute, Feed};
use crate::model::changes::{Changes, Said};

/// In the order of [`CHANGING`](crate::model::changes::CHANGING).
const CODES: [Attribute; 4] = [
    Attribute::Address,
    Attribute::Callsign,
    Attribute::ModeA,
    Attribute::ModeC,
];

/// The words of paths by their names.
#[derive(Default)]
pub(super) struct Codes {
    paths: Vec<(String, Vec<(Attribute, Said)>)>,
}

impl Codes {
    /// Keeps what the reports of a path say. A code that none of them says is known of the path as a whole, if at all.
    pub fn note(&mut self, feed: &Feed, name: &str, reports: &[usize]) {
        let mut kept = Vec::new();
        for code in CODES {
            let mut said = Said::default();
            let mut is_said = false;
            for &report in reports {
                let text = feed.number_said_of(report, code);
                is_said |= text.is_some();
                said.note(feed.reports[report].time_s, text);
            }
            if is_said {
                kept.push((code, said));
            }
        }
        if !kept.is_empty() {
            self.paths.push((name.to_owned(), kept));
        }
    }

    /// Those that change.
    pub fn finish(self, feed: &Feed) -> Changes {
        let mut changes = Changes::with_texts(feed.texts.names().to_vec());
        for (name, kept) in self.paths {
            for (code, said) in kept {
                changes.insert(&name, code.name(), said);
            }
        }
        changes.slim()
    }
}
