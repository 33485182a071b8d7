//! Many strings in one list, each in normal form.
//!
//! Symbols lie one behind the other, every string closed by [`END`], so that a place in the list is a state of the
//! automaton: what was read so far, and what may come next.

use super::choices::Choices;
use super::step::{EPSILON, StringStep};
use std::ops::Range;

/// What stands behind the last symbol of a string.
pub const END: u32 = u32::MAX - 1;

/// One string of a [`StringSet`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackString {
    /// Index of the target or track.
    pub owner: u32,
    /// Which of its owner's strings this is, from 0.
    pub part: u32,
    /// Place of the first symbol on the axis.
    pub start: usize,
    /// Place of the first symbol in the list of all symbols.
    pub first_step: usize,
    len: usize,
    /// How many symbols are not ε.
    pub real: usize,
}

impl TrackString {
    /// The place behind the last symbol.
    pub fn end(&self) -> usize {
        self.start + self.len
    }

    pub fn steps(&self) -> Range<usize> {
        self.first_step..self.first_step + self.len
    }
}

/// The strings of all targets or of all tracks, by owner and then in order of time.
#[derive(Debug)]
pub struct StringSet {
    max_missed: usize,
    strings: Vec<TrackString>,
    symbols: Vec<u32>,
    /// Of each symbol; empty where every weight is 1.
    weights: Vec<f64>,
    /// What else each step may have been; `None` where every track decided.
    choices: Option<Choices>,
    /// Where the strings of each owner begin in `strings`, and the end.
    first_of_owner: Vec<usize>,
    /// ε since the last real symbol of the open string.
    pending: Vec<StringStep>,
    /// The string at hand, which is not among `strings` yet.
    open: Option<TrackString>,
}

impl StringSet {
    /// Strings whose symbols are all certain.
    pub fn new(max_missed: u32) -> Self {
        StringSet {
            max_missed: max_missed as usize,
            strings: Vec::new(),
            // State 0 of the automaton is its start, so no string begins there.
            symbols: vec![END],
            weights: Vec::new(),
            choices: None,
            first_of_owner: vec![0],
            pending: Vec::new(),
            open: None,
        }
    }

    /// Strings with a weight for each symbol, and with choices at each step if asked for.
    pub fn weighted(max_missed: u32, with_choices: bool) -> Self {
        let choices = with_choices.then(Choices::default);
        StringSet {
            weights: vec![0.0],
            choices,
            ..StringSet::new(max_missed)
        }
    }

    /// Makes room for so many more symbols of so many more strings.
    pub fn reserve(&mut self, symbols: usize, strings: usize) {
        self.symbols.reserve(symbols + strings);
        self.strings.reserve(strings);
        self.first_of_owner.reserve(strings);
        if !self.weights.is_empty() {
            self.weights.reserve(symbols + strings);
        }
    }

    /// Appends the strings of the next owner from its steps in order of position; places left out are ε.
    pub fn push_owner(&mut self, steps: impl IntoIterator<Item = (usize, StringStep)>) {
        for (position, step) in steps {
            self.push_step(position, step, &[]);
        }
        self.end_owner();
    }

    /// Takes the next step of the owner that [`end_owner`](Self::end_owner) closes, with what else it may have been. A scan
    /// where it may have been real does not count as missed.
    #[inline]
    pub fn push_step(&mut self, position: usize, step: StringStep, choices: &[StringStep]) {
        if let Some(end) = self.open.as_ref().map(TrackString::end) {
            self.pass_gap(position - end);
        }
        if step.symbol.is_some() || choices.iter().any(|choice| choice.symbol.is_some()) {
            self.append(position, step, choices);
        } else if self.open.is_some() {
            self.pending.push(step);
        }
    }

    pub fn end_owner(&mut self) {
        self.close_string();
        self.first_of_owner.push(self.strings.len());
    }

    /// Fills so many places since the last real symbol with ε, or ends the open string when they are too many.
    #[inline]
    fn pass_gap(&mut self, missed: usize) {
        if missed >= self.max_missed {
            self.close_string();
        } else if missed > self.pending.len() {
            self.pending.resize(missed, StringStep::NOTHING);
        }
    }

    fn open_string(&self, start: usize) -> TrackString {
        let owner = self.first_of_owner.len() - 1;
        let part = self.strings.len() - self.first_of_owner[owner];
        TrackString {
            owner: owner as u32,
            part: part as u32,
            start,
            first_step: self.symbols.len(),
            len: 0,
            real: 0,
        }
    }

    fn close_string(&mut self) {
        self.pending.clear();
        if let Some(string) = self.open.take() {
            self.strings.push(string);
            self.write(
                StringStep {
                    symbol: Some(END),
                    weight: 0.0,
                },
                &[],
            );
        }
    }

    /// Adds a step and what is pending to the open string, or opens one.
    #[inline]
    fn append(&mut self, position: usize, step: StringStep, choices: &[StringStep]) {
        let mut open = self
            .open
            .take()
            .unwrap_or_else(|| self.open_string(position));
        open.len += self.pending.len() + 1;
        open.real += usize::from(step.symbol.is_some());
        self.open = Some(open);
        if !self.pending.is_empty() {
            for index in 0..self.pending.len() {
                self.write(self.pending[index], &[]);
            }
            self.pending.clear();
        }
        self.write(step, choices);
    }

    #[inline]
    fn write(&mut self, step: StringStep, choices: &[StringStep]) {
        self.symbols.push(step.symbol.unwrap_or(EPSILON));
        if !self.weights.is_empty() {
            self.weights.push(step.weight);
        }
        if let Some(all) = &mut self.choices {
            all.push(step, choices);
        }
    }

    pub fn max_missed(&self) -> usize {
        self.max_missed
    }

    pub fn strings(&self) -> &[TrackString] {
        &self.strings
    }

    pub fn owners(&self) -> usize {
        self.first_of_owner.len() - 1
    }

    /// Indices of the strings of one owner.
    pub fn of_owner(&self, owner: usize) -> Range<usize> {
        self.first_of_owner[owner]..self.first_of_owner[owner + 1]
    }

    /// Index of the string that a place in the list of symbols belongs to.
    pub fn string_of_step(&self, step: usize) -> usize {
        self.strings
            .partition_point(|string| string.first_step <= step)
            - 1
    }

    /// The list of all symbols, strings closed by [`END`].
    pub fn symbols(&self) -> &[u32] {
        &self.symbols
    }

    pub fn symbols_of(&self, string: &TrackString) -> &[u32] {
        &self.symbols[string.steps()]
    }

    /// The weight of a place in the list of symbols.
    #[inline]
    pub fn weight(&self, step: usize) -> f64 {
        self.weights.get(step).copied().unwrap_or(1.0)
    }

    /// Whether tracks kept several choices a scan.
    pub fn has_choices(&self) -> bool {
        self.choices.is_some()
    }

    /// Everything that a place in the list of symbols may be, by symbol.
    pub fn choices_at(&self, step: usize) -> impl Iterator<Item = (u32, f64)> {
        let several = self
            .choices
            .as_ref()
            .map_or(&[][..], |choices| choices.at(step));
        let alone = several
            .is_empty()
            .then(|| (self.symbols[step], self.weight(step)));
        several.iter().copied().chain(alone)
    }

    /// The weight with which a place in the list of symbols may be this symbol.
    pub fn weight_of(&self, step: usize, symbol: u32) -> Option<f64> {
        self.choices_at(step)
            .find(|&(choice, _)| choice == symbol)
            .map(|(_, weight)| weight)
    }

    /// The symbol of a string at a place of the axis; outside the string it is ε.
    pub fn symbol_at(&self, string: &TrackString, position: usize) -> Option<u32> {
        let offset = position.checked_sub(string.start)?;
        self.symbols_of(string)
            .get(offset)
            .copied()
            .filter(|&symbol| symbol != EPSILON)
    }

    /// The weight with which a string is `symbol` at a place of the axis; outside the string it is surely ε.
    pub fn weight_at(&self, string: &TrackString, position: usize, symbol: u32) -> Option<f64> {
        if position < string.start || position >= string.end() {
            return (symbol == EPSILON).then_some(1.0);
        }
        self.weight_of(string.first_step + position - string.start, symbol)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Letters are symbols by their place in the alphabet, `.` is ε, a blank is nothing said.
    fn written(text: &str, max_missed: u32) -> Vec<(usize, String)> {
        let mut set = StringSet::new(max_missed);
        let steps = text.bytes().enumerate().filter(|&(_, byte)| byte != b' ');
        set.push_owner(steps.map(|(position, byte)| {
            (
                position,
                if byte == b'.' {
                    StringStep::NOTHING
                } else {
                    StringStep::certain(byte.into())
                },
            )
        }));
        let letter = |&symbol: &u32| {
            if symbol == EPSILON {
                '.'
            } else {
                symbol as u8 as char
            }
        };
        set.strings()
            .iter()
            .map(|string| {
                (
                    string.start,
                    set.symbols_of(string).iter().map(letter).collect(),
                )
            })
            .collect()
    }

    #[test]
    fn leading_and_trailing_epsilon_are_dropped() {
        assert_eq!(written("..ab...", 5), [(2, "ab".to_owned())]);
        assert_eq!(written("....", 5), []);
        assert_eq!(written("", 5), []);
    }

    #[test]
    fn four_epsilon_stay_and_five_split_however_they_are_said() {
        for gap in ["....", "    ", ". . ", " .. "] {
            assert_eq!(written(&format!("a{gap}b"), 5), [(0, "a....b".to_owned())]);
        }
        for gap in [".....", "     ", ". . .", " ..  "] {
            assert_eq!(
                written(&format!("a{gap}b"), 5),
                [(0, "a".to_owned()), (6, "b".to_owned())]
            );
        }
        assert_eq!(
            written("a.b", 1),
            [(0, "a".to_owned()), (2, "b".to_owned())]
        );
    }

    #[test]
    fn weights_of_epsilon_are_kept() {
        let mut set = StringSet::weighted(3, false);
        let doubted = StringStep {
            symbol: None,
            weight: 0.25,
        };
        set.push_owner([
            (0, StringStep::certain(1)),
            (2, doubted),
            (3, StringStep::certain(2)),
        ]);
        let string = set.strings()[0];
        assert_eq!(set.symbols_of(&string), [1, EPSILON, EPSILON, 2]);
        assert_eq!(
            string
                .steps()
                .map(|step| set.weight(step))
                .collect::<Vec<_>>(),
            [1.0, 1.0, 0.25, 1.0]
        );
        assert_eq!(set.symbols()[string.steps().end], END);
    }

    #[test]
    fn a_scan_that_may_have_been_real_is_not_missed() {
        let mut set = StringSet::weighted(1, true);
        let (nothing, maybe) = (
            StringStep {
                symbol: None,
                weight: 0.6,
            },
            StringStep {
                symbol: Some(7),
                weight: 0.4,
            },
        );
        set.push_step(0, StringStep::certain(1), &[StringStep::certain(1)]);
        set.push_step(1, nothing, &[nothing, maybe]);
        set.push_step(2, StringStep::certain(2), &[StringStep::certain(2)]);
        set.push_step(3, StringStep::NOTHING, &[StringStep::NOTHING]);
        set.end_owner();
        let string = set.strings()[0];
        assert_eq!(
            (set.strings().len(), string.start, string.end(), string.real),
            (1, 0, 3, 2)
        );
        assert_eq!(
            set.choices_at(string.first_step + 1).collect::<Vec<_>>(),
            [(EPSILON, 0.6), (7, 0.4)]
        );
        assert_eq!(
            (set.weight_at(&string, 1, 7), set.weight_at(&string, 2, 7)),
            (Some(0.4), None)
        );
        assert_eq!(
            (
                set.weight_at(&string, 3, EPSILON),
                set.weight_at(&string, 3, 2)
            ),
            (Some(1.0), None)
        );
    }
}
