//! How what is known of a target or a track changes over its life: who it says it is, point by point.

use super::attributes::Attributes;
use std::collections::BTreeMap;

/// Attributes whose every word is kept, not the last one alone.
pub const CHANGING: [&str; 5] = [
    "address",
    "callsign",
    "mode_a",
    "mode_c_ft",
    "position_accuracy_m",
];

/// What attributes of objects were at each time; only those that are not the same at all points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Changes {
    texts: Vec<String>,
    of: BTreeMap<String, BTreeMap<&'static str, Vec<Change>>>,
}

/// From a time on an object says a text of a list, or nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Change {
    from_s: f64,
    text: Option<u32>,
}

/// What an attribute of an object is said to be in rows that follow each other, mostly in the order of time.
#[derive(Debug, Default)]
pub struct Said {
    /// Rising and apart.
    runs: Vec<Run>,
    /// Rows that are earlier than one before them.
    late: Vec<Change>,
}

#[derive(Debug)]
struct Run {
    from_s: f64,
    to_s: f64,
    text: Option<u32>,
}

impl Said {
    pub fn note(&mut self, time_s: f64, text: Option<u32>) {
        match self.runs.last_mut() {
            Some(run) if time_s < run.to_s => self.late.push(Change {
                from_s: time_s,
                text,
            }),
            Some(run) if run.text == text => run.to_s = time_s,
            _ => self.runs.push(Run {
                from_s: time_s,
                to_s: time_s,
                text,
            }),
        }
    }

    /// In the order of time; of several words at one time the last counts.
    fn changes(mut self) -> Vec<Change> {
        self.late.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
        let mut late = self.late.into_iter().peekable();
        let mut changes: Vec<Change> = Vec::new();
        for run in self.runs {
            while let Some(before) = late.next_if(|change| change.from_s < run.from_s) {
                add(&mut changes, before);
            }
            let of_run = |from_s| Change {
                from_s,
                text: run.text,
            };
            add(&mut changes, of_run(run.from_s));
            while let Some(inside) = late.next_if(|change| change.from_s <= run.to_s) {
                if late.peek().is_some_and(|next| next.from_s == inside.from_s) {
                    continue;
                }
                add(&mut changes, inside);
                if inside.from_s < run.to_s {
                    add(&mut changes, of_run(inside.from_s.next_up()));
                }
            }
        }
        changes
    }
}

fn add(changes: &mut Vec<Change>, change: Change) {
    if changes
        .last()
        .is_some_and(|last| last.from_s == change.from_s)
    {
        changes.pop();
    }
    if changes.last().is_none_or(|last| last.text != change.text) {
        changes.push(change);
    }
}

impl Changes {
    pub fn with_texts(texts: Vec<String>) -> Self {
        Changes {
            texts,
            of: BTreeMap::new(),
        }
    }

    /// Keeps what an attribute of an object was, where that is not always the same.
    pub fn insert(&mut self, object: &str, name: &'static str, said: Said) {
        let changes = said.changes();
        if changes.len() > 1 {
            let of_object = self.of.entry(object.to_owned()).or_default();
            of_object.insert(name, changes);
        }
    }

    /// Without its texts where nothing changes.
    #[must_use]
    pub fn slim(self) -> Changes {
        if self.of.is_empty() {
            Changes::default()
        } else {
            self
        }
    }

    /// What the attribute was at the time of a point; `None` where nothing is kept of it, so that it is always the same.
    pub fn at(&self, object: &str, name: &str, time_s: f64) -> Option<Option<&str>> {
        let changes = self.of.get(object)?.get(name)?;
        let after = changes.partition_point(|change| change.from_s <= time_s);
        let change = after.checked_sub(1).and_then(|last| changes.get(last));
        let text = change.and_then(|change| change.text);
        Some(text.and_then(|text| self.texts.get(text as usize).map(String::as_str)))
    }

    /// All that an attribute of an object ever was, each once.
    pub fn words<'a>(
        &'a self,
        attributes: &'a Attributes,
        object: &str,
        name: &str,
    ) -> Vec<&'a str> {
        let changes = self.of.get(object).and_then(|of_one| of_one.get(name));
        let Some(changes) = changes else {
            let of_one = attributes.get(object);
            let word = of_one.and_then(|of_one| of_one.get(name));
            return word.map(String::as_str).into_iter().collect();
        };
        let mut numbers: Vec<u32> = changes.iter().filter_map(|change| change.text).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let text = |number: u32| self.texts.get(number as usize).map(String::as_str);
        numbers.into_iter().filter_map(text).collect()
    }

    /// What an attribute was at the time of a point, be it always the same or not.
    pub fn word<'a>(
        &'a self,
        attributes: &'a Attributes,
        (object, time_s): (&str, f64),
        name: &str,
    ) -> Option<&'a str> {
        if let Some(word) = self.at(object, name, time_s) {
            return word;
        }
        attributes.get(object)?.get(name).map(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(rows: &[(f64, Option<u32>)]) -> Changes {
        let mut said = Said::default();
        for &(time_s, text) in rows {
            said.note(time_s, text);
        }
        let mut changes = Changes::with_texts(vec!["a".to_owned(), "b".to_owned()]);
        changes.insert("T", "mode_a", said);
        changes
    }

    #[test]
    fn each_time_has_the_word_of_its_row_whatever_the_order_of_the_rows() {
        let rows = [(0.0, Some(0)), (5.0, Some(0)), (7.0, Some(1)), (9.0, None)];
        let text = |changes: &Changes, time_s| {
            changes
                .at("T", "mode_a", time_s)
                .map(|text| text.map(str::to_owned))
        };
        let wanted = ["a", "a", "b"].map(|text| Some(Some(text.to_owned())));
        for order in [[0, 1, 2, 3], [3, 2, 1, 0], [1, 0, 3, 2], [2, 0, 3, 1]] {
            let changes = kept(&order.map(|row: usize| rows[row]));
            assert_eq!([0.0, 5.0, 7.0].map(|time_s| text(&changes, time_s)), wanted);
            assert_eq!(text(&changes, 9.0), Some(None), "{order:?}");
        }
        let inside = kept(&[(0.0, Some(0)), (9.0, Some(0)), (4.0, Some(1)), (4.0, None)]);
        assert_eq!(text(&inside, 4.0), Some(None), "the last word of a time");
        assert_eq!(text(&inside, 9.0), Some(Some("a".to_owned())));
    }

    #[test]
    fn what_never_changes_is_not_kept() {
        let changes = kept(&[(0.0, Some(0)), (1.0, Some(0)), (0.5, Some(0))]);
        assert_eq!(changes.at("T", "mode_a", 1.0), None);
        assert_eq!(changes.slim(), Changes::default());
    }
}
