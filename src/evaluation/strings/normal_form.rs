//! Many strings in one list, each in normal form.

use std::ops::Range;

/// What is at one scan of a string: a real symbol or ε (`None`), and the weight the tracker gave it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub symbol: Option<u32>,
    pub weight: f64,
}

impl Step {
    /// ε for want of anything said.
    pub const NOTHING: Step = Step { symbol: None, weight: 1.0 };

    pub fn certain(symbol: u32) -> Self {
        Step { symbol: Some(symbol), weight: 1.0 }
    }
}

/// One string of a [`StringSet`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackString {
    /// Index of the target or track.
    pub owner: u32,
    /// Which of its owner's strings this is, from 0.
    pub part: u32,
    /// Place of the first symbol on the axis.
    pub start: usize,
    first_step: usize,
    len: usize,
    /// How many symbols are not ε.
    pub real: usize,
}

impl TrackString {
    /// The place behind the last symbol.
    pub fn end(&self) -> usize {
        self.start + self.len
    }
}

/// The strings of all targets or of all tracks, by owner and then in order of time.
#[derive(Debug)]
pub struct StringSet {
    max_missed: usize,
    strings: Vec<TrackString>,
    steps: Vec<Step>,
    /// Where the strings of each owner begin in `strings`, and the end.
    first_of_owner: Vec<usize>,
    /// ε since the last real symbol of the open string.
    pending: Vec<Step>,
}

impl StringSet {
    pub fn new(max_missed: u32) -> Self {
        let max_missed = max_missed as usize;
        StringSet { max_missed, strings: Vec::new(), steps: Vec::new(), first_of_owner: vec![0], pending: Vec::new() }
    }

    /// Appends the strings of the next owner from its steps in order of position; places left out are ε.
    pub fn push_owner(&mut self, steps: impl IntoIterator<Item = (usize, Step)>) {
        self.pending.clear();
        let mut open = false;
        for (position, step) in steps {
            if open {
                open = self.pass_gap(position);
            }
            match step.symbol {
                None if open => self.pending.push(step),
                None => {}
                Some(_) => {
                    if !open {
                        self.open_string(position);
                        open = true;
                    }
                    self.append(step);
                }
            }
        }
        self.first_of_owner.push(self.strings.len());
    }

    /// Fills the places before `position` with ε. False when that ends the open string.
    fn pass_gap(&mut self, position: usize) -> bool {
        let last = self.strings[self.strings.len() - 1];
        let missed = position - last.end();
        if missed >= self.max_missed {
            self.pending.clear();
            return false;
        }
        self.pending.resize(missed, Step::NOTHING);
        true
    }

    fn open_string(&mut self, start: usize) {
        let owner = self.first_of_owner.len() - 1;
        let part = self.strings.len() - self.first_of_owner[owner];
        self.strings.push(TrackString { owner: owner as u32, part: part as u32, start, first_step: self.steps.len(), len: 0, real: 0 });
    }

    fn append(&mut self, step: Step) {
        let added = self.pending.len() + 1;
        self.steps.append(&mut self.pending);
        self.steps.push(step);
        if let Some(open) = self.strings.last_mut() {
            open.len += added;
            open.real += 1;
        }
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

    pub fn steps_of(&self, string: &TrackString) -> &[Step] {
        &self.steps[string.first_step..string.first_step + string.len]
    }

    /// The symbol of a string at a place of the axis; outside the string it is ε.
    pub fn symbol_at(&self, string: &TrackString, position: usize) -> Option<u32> {
        let offset = position.checked_sub(string.start)?;
        self.steps_of(string).get(offset)?.symbol
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Letters are symbols by their place in the alphabet, `.` is ε, a blank is nothing said.
    fn written(text: &str, max_missed: u32) -> Vec<(usize, String)> {
        let mut set = StringSet::new(max_missed);
        let steps = text.bytes().enumerate().filter(|&(_, byte)| byte != b' ');
        set.push_owner(steps.map(|(position, byte)| (position, if byte == b'.' { Step::NOTHING } else { Step::certain(byte.into()) })));
        let letter = |step: &Step| step.symbol.map_or('.', |symbol| symbol as u8 as char);
        set.strings().iter().map(|string| (string.start, set.steps_of(string).iter().map(letter).collect())).collect()
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
            assert_eq!(written(&format!("a{gap}b"), 5), [(0, "a".to_owned()), (6, "b".to_owned())]);
        }
        assert_eq!(written("a.b", 1), [(0, "a".to_owned()), (2, "b".to_owned())]);
    }

    #[test]
    fn weights_of_epsilon_are_kept() {
        let mut set = StringSet::new(3);
        let doubted = Step { symbol: None, weight: 0.25 };
        set.push_owner([(0, Step::certain(1)), (2, doubted), (3, Step::certain(2))]);
        assert_eq!(set.steps_of(&set.strings()[0]), [Step::certain(1), Step::NOTHING, doubted, Step::certain(2)]);
    }
}
