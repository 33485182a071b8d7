//! Rows that say again what an earlier one has said.

/// How many there are, and the first.
#[derive(Debug, Default)]
pub struct Repeats {
    rows: usize,
    first: u64,
}

impl Repeats {
    pub fn add(&mut self, row: u64) {
        self.first = if self.rows == 0 {
            row
        } else {
            self.first.min(row)
        };
        self.rows += 1;
    }

    pub fn count(&self) -> usize {
        self.rows
    }

    /// What a user is told; `row_word` is what a row is called.
    pub fn warning(&self, row_word: &str) -> Option<String> {
        let first = self.first;
        match self.rows {
            0 => None,
            1 => Some(format!(
                "{row_word} {first} repeats an earlier one and is taken once"
            )),
            rows => Some(format!(
                "{rows} rows repeat earlier ones and are taken once; the first is {row_word} {first}"
            )),
        }
    }
}
