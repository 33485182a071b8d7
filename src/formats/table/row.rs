//! One row at a time: cells to numbers and names, each fault with its place.

use super::{FaultLog, Repeats, Rows};
use crate::model::fault::Fault;
use crate::model::names::{name_fault, shorten};

/// Walks the rows of a table and collects what is wrong with them.
pub struct RowReader<'a> {
    rows: &'a mut dyn Rows,
    pub faults: FaultLog,
    sound: bool,
}

impl<'a> RowReader<'a> {
    pub fn new(rows: &'a mut dyn Rows) -> Self {
        RowReader {
            rows,
            faults: FaultLog::default(),
            sound: true,
        }
    }

    /// Goes to the next row; `false` at the end, or when there are too many faults.
    pub fn advance(&mut self) -> bool {
        self.sound = true;
        !self.faults.is_full() && self.rows.advance(&mut self.faults)
    }

    /// Whether nothing was wrong with the current row so far.
    pub fn is_sound(&self) -> bool {
        self.sound
    }

    pub fn row(&self) -> u64 {
        self.rows.row()
    }

    /// A row by its number, for faults that name another row: "line 12".
    pub fn called(&self, row: u64) -> String {
        format!("{} {row}", self.rows.row_word())
    }

    /// Reports a fault in a cell of the current row.
    pub fn fault(&mut self, column: usize, code: &str, detail: String) {
        self.fault_in(self.rows.row(), column, code, detail);
    }

    /// Reports a fault in a cell of an earlier row.
    pub fn fault_in(&mut self, row: u64, column: usize, code: &str, detail: String) {
        let fault = self.rows.cell_fault(row, column, code, detail);
        self.push(fault);
    }

    /// Reports a fault of the current row that names the values allowed.
    pub fn fault_allowing(&mut self, column: usize, code: &str, detail: String, allowed: &str) {
        let fault = self
            .rows
            .cell_fault(self.rows.row(), column, code, detail)
            .allowing(allowed);
        self.push(fault);
    }

    fn push(&mut self, fault: Fault) {
        self.faults.push(fault);
        self.sound = false;
    }

    pub fn text(&self, column: usize) -> &str {
        self.rows.cell(column)
    }

    /// The text of a column that the table may lack; empty where it does.
    pub fn optional_text(&self, column: Option<usize>) -> &str {
        column.map_or("", |column| self.rows.cell(column))
    }

    /// Reports a cell that is empty or no name.
    pub fn require_name(&mut self, column: usize) {
        if self.text(column).is_empty() {
            self.fault(
                column,
                "missing",
                format!("'{}' is empty", self.rows.names()[column]),
            );
        } else {
            self.check_name(column);
        }
    }

    /// Reports a cell that is no name; it may be empty.
    pub fn check_name(&mut self, column: usize) {
        if let Some(found) = name_fault(self.rows.cell(column)) {
            self.fault_allowing(column, found.code, found.detail, found.allowed);
        }
    }

    /// What a user is told of rows that say the same twice.
    pub fn repeats_warning(&self, repeats: &Repeats) -> Option<String> {
        repeats.warning(self.rows.row_word())
    }

    /// A finite number; an empty cell is a fault.
    pub fn number(&mut self, column: usize) -> Option<f64> {
        let text = self.rows.cell(column).trim_ascii();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => return Some(value),
            Ok(_) => self.fault(
                column,
                "not_finite",
                format!("'{text}' is not a finite number"),
            ),
            Err(_) if text.is_empty() => self.fault(
                column,
                "missing",
                format!("'{}' is empty", self.rows.names()[column]),
            ),
            Err(_) => self.fault(
                column,
                "malformed",
                format!("expected a number, found '{}'", shorten(text)),
            ),
        }
        None
    }

    /// A finite number, or `None` where the column or the cell is empty; what is there must be a number.
    pub fn optional_number(&mut self, column: Option<usize>) -> Option<f64> {
        let column = column?;
        if self.rows.cell(column).trim_ascii().is_empty() {
            None
        } else {
            self.number(column)
        }
    }

    /// A whole number that fits 32 bits.
    pub fn whole_number(&mut self, column: usize) -> Option<u32> {
        let text = self.rows.cell(column).trim_ascii();
        match text.parse::<u32>() {
            Ok(value) => return Some(value),
            Err(_) if text.is_empty() => self.fault(
                column,
                "missing",
                format!("'{}' is empty", self.rows.names()[column]),
            ),
            Err(_) => {
                let detail = format!(
                    "expected a whole number from 0 to {}, found '{}'",
                    u32::MAX,
                    shorten(text)
                );
                self.fault(column, "malformed", detail);
            }
        }
        None
    }

    /// Cells that are all filled or all empty; a mixture is a fault at each empty one. Whether all are filled: then `values`
    /// begins with them.
    pub fn fill(&mut self, columns: Option<&[usize]>, values: &mut [f64]) -> bool {
        let columns = columns.unwrap_or_default();
        let is_filled = |column: &usize| !self.rows.cell(*column).trim_ascii().is_empty();
        let mut complete = columns.iter().any(is_filled);
        if !complete {
            return false;
        }
        for (value, &column) in values.iter_mut().zip(columns) {
            match self.number(column) {
                Some(number) => *value = number,
                None => complete = false,
            }
        }
        complete
    }
}
