//! Messages of several sentences: parts wait for each other, in any order.

use super::sentence::Part;

/// Parts are of one message as long as they lie no further apart: in seconds, and without times in lines.
const LONGEST_S: f64 = 60.0;
const LONGEST_LINES: u64 = 100;

/// Messages that wait at a time; of more the oldest is given up.
const MAX_WAITING: usize = 256;

/// Lines of a message.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lines {
    pub first: u64,
    pub count: u32,
    pub received_s: Option<f64>,
}

/// What becomes of a part.
pub(super) enum Fate {
    /// The message is whole: its lines, the payloads in their order, and bits that fill the last one.
    Whole(Lines, Vec<Vec<u8>>, u8),
    Waits,
    /// The part is there already.
    Repeated,
}

struct Waiting {
    key: Vec<u8>,
    lines: Lines,
    last_line: u64,
    /// Empty where a part is not there; none is.
    payloads: Vec<Vec<u8>>,
    fill: u8,
}

#[derive(Default)]
pub(super) struct Parts {
    /// The oldest first.
    waiting: Vec<Waiting>,
    key: Vec<u8>,
    /// Messages given up, until somebody takes them from here.
    pub lost: Vec<Lines>,
}

impl Parts {
    pub fn take(&mut self, part: &Part<'_>, line: u64) -> Fate {
        write_key(&mut self.key, part);
        let known = self
            .waiting
            .iter()
            .position(|waiting| waiting.key == self.key);
        let known = known.filter(|&at| {
            let is_open = self.waiting[at].is_open_to(part, line);
            if !is_open {
                self.lost.push(self.waiting.remove(at).lines);
            }
            is_open
        });
        let at = known.unwrap_or_else(|| self.begin(part, line));
        let waiting = &mut self.waiting[at];
        if !waiting.add(part, line) {
            return Fate::Repeated;
        }
        if waiting.payloads.iter().any(Vec::is_empty) {
            return Fate::Waits;
        }
        let whole = self.waiting.remove(at);
        Fate::Whole(whole.lines, whole.payloads, whole.fill)
    }

    fn begin(&mut self, part: &Part<'_>, line: u64) -> usize {
        if self.waiting.len() == MAX_WAITING {
            self.lost.push(self.waiting.remove(0).lines);
        }
        let lines = Lines {
            first: line,
            count: 0,
            received_s: None,
        };
        self.waiting.push(Waiting {
            key: self.key.clone(),
            lines,
            last_line: line,
            payloads: vec![Vec::new(); part.total.into()],
            fill: 0,
        });
        self.waiting.len() - 1
    }

    /// Gives up what still waits.
    pub fn end(&mut self) {
        self.lost
            .extend(self.waiting.drain(..).map(|waiting| waiting.lines));
    }
}

impl Waiting {
    /// Whether the part may be of this message: close enough, and not another one in the place of one that is there.
    fn is_open_to(&self, part: &Part<'_>, line: u64) -> bool {
        let is_near = match (self.lines.received_s, part.received_s) {
            (Some(first_s), Some(time_s)) => (time_s - first_s).abs() <= LONGEST_S,
            _ => line - self.last_line <= LONGEST_LINES,
        };
        let there = &self.payloads[usize::from(part.number - 1)];
        is_near && (there.is_empty() || there == part.payload)
    }

    /// `false` where the part is there.
    fn add(&mut self, part: &Part<'_>, line: u64) -> bool {
        let place = &mut self.payloads[usize::from(part.number - 1)];
        if !place.is_empty() {
            return false;
        }
        *place = part.payload.to_owned();
        self.lines.count += 1;
        self.lines.received_s = self.lines.received_s.or(part.received_s);
        if part.number == part.total {
            self.fill = part.fill;
        }
        self.last_line = line;
        true
    }
}

/// What parts of one message have in common: the group of the tag block, else receiver, channel and number of the message.
fn write_key(key: &mut Vec<u8>, part: &Part<'_>) {
    key.clear();
    key.extend_from_slice(part.address);
    key.push(part.total);
    match part.group {
        Some(group) => {
            key.push(b'g');
            key.extend_from_slice(group);
        }
        None => {
            for field in [part.channel, part.sequence, part.source] {
                key.push(b',');
                key.extend_from_slice(field);
            }
        }
    }
}
