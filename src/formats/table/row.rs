//! One row at a time: cells to numbers and names, each fault with its place.

use super::header::{Header, TIME_BASE};
use super::rejects::Rejects;
use super::{FaultLog, Repeats, Rows};
use crate::formats::clock::{Clock, NoTime};
use crate::formats::{Reading, Units};
use crate::model::attributes::Attributes;
use crate::model::fault::Fault;
use crate::model::names::{name_fault, shorten};
use crate::model::time::TimeBase;

/// What a time may be.
const TIMES: &str =
    "a number of seconds, ISO 8601, or what `time_format` says, the same in all rows";

/// Walks the rows of a table and collects what is wrong with them.
pub struct RowReader<'a> {
    rows: &'a mut dyn Rows,
    pub faults: FaultLog,
    sound: bool,
    count: u64,
    scales: &'a [f64],
    clock: Clock,
    base_column: Option<usize>,
    /// What the rows say that their times are counted from.
    base: Option<TimeBase>,
    /// Where rows may be wrong.
    rejects: Option<Rejects>,
    /// Those that were read before they were rejected.
    rejected: u64,
}

impl<'a> RowReader<'a> {
    pub fn new(rows: &'a mut dyn Rows, header: &'a Header, reading: &Reading) -> Self {
        let time_scale = header
            .find("time_s")
            .map_or(1.0, |column| header.scales()[column]);
        let word = rows.row_word();
        RowReader {
            rows,
            faults: FaultLog::default(),
            sound: true,
            count: 0,
            scales: header.scales(),
            clock: Clock::new(reading, time_scale),
            base_column: header.find(TIME_BASE),
            base: None,
            rejects: Rejects::allowed_by(reading, word),
            rejected: 0,
        }
    }

    /// How the rows fared, of which some said something again.
    ///
    /// # Errors
    /// Every fault, unless so many rows may be wrong.
    pub fn finish(self, repeated: u64) -> Result<Units, Vec<Fault>> {
        self.faults.finish()?;
        let mut units = Units::called(self.rows.row_word());
        units.use_up(self.count - self.rejected - repeated);
        if repeated > 0 {
            units.ignore("duplicate", repeated);
        }
        if let Some(rejects) = self.rejects {
            rejects.settle(&mut units)?;
        }
        Ok(units)
    }

    /// How the rows fared so far, the current one not counted.
    pub fn units(&self) -> Units {
        let mut units = Units::called(self.rows.row_word());
        let is_wrong = !self.faults.is_empty();
        units.use_up(self.count - self.rejected - u64::from(is_wrong));
        if let Some(rejects) = &self.rejects {
            rejects.add_to(&mut units);
        }
        units
    }

    /// Whether the current row is the header again.
    pub fn is_header(&self) -> bool {
        let mut names = self.rows.names().iter().enumerate();
        names.all(|(column, name)| self.rows.cell(column) == name)
    }

    pub fn time_base(&self) -> TimeBase {
        self.clock.base()
    }

    /// What a user is told of the times.
    pub fn told(&self) -> Option<String> {
        let assumed = self.clock.assumed_utc;
        assumed.then(|| {
            "times without a zone are taken as UTC; `utc_offset_s` says otherwise".to_owned()
        })
    }

    /// Goes to the next row; `false` at the end, or when there are too many faults.
    pub fn advance(&mut self) -> bool {
        self.reject_row();
        self.sound = true;
        let is_there = !self.faults.is_full() && self.rows.advance(&mut self.faults);
        self.count += u64::from(is_there);
        if let Some(rejects) = &mut self.rejects {
            // Rows that were passed over, each for one fault.
            for fault in self.faults.take() {
                rejects.add_row(fault.line.unwrap_or_default(), vec![fault]);
            }
        }
        is_there
    }

    /// Leaves out the row that was read last, where it is wrong and may be.
    fn reject_row(&mut self) {
        if let Some(rejects) = &mut self.rejects
            && !self.faults.is_empty()
        {
            let before = rejects.count();
            rejects.add_row(self.rows.row(), self.faults.take());
            self.rejected += rejects.count() - before;
        }
    }

    /// Whether nothing was wrong with the current row so far.
    pub fn is_sound(&self) -> bool {
        self.sound
    }

    /// Whether the current row is wrong, and may be.
    pub fn is_rejected(&self) -> bool {
        self.rejects.is_some() && !self.sound
    }

    pub fn row(&self) -> u64 {
        self.rows.row()
    }

    /// A row by its number, for faults that name another row: "line 12".
    pub fn called(&self, row: u64) -> String {
        format!("{} {row}", self.rows.row_word())
    }

    /// What a row is called: "line" or "row".
    pub fn row_word(&self) -> &'static str {
        self.rows.row_word()
    }

    /// Keeps the attributes of the object that a row names; the last word counts.
    pub fn note_attributes(
        &self,
        object: usize,
        columns: &[(&'static str, usize)],
        attributes: &mut Attributes,
    ) {
        for &(name, column) in columns {
            let text = self.text(column).trim();
            if text.is_empty() {
                continue;
            }
            let object = self.text(object);
            let known = match attributes.get_mut(object) {
                Some(known) => known,
                None => attributes.entry(object.to_owned()).or_default(),
            };
            if known.get(name).is_none_or(|known| known != text) {
                known.insert(name, text.to_owned());
            }
        }
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

    /// Notes what the row says that its time is counted from.
    fn note_base(&mut self) {
        let Some(column) = self.base_column else {
            return;
        };
        let text = self.rows.cell(column).trim_ascii();
        if text.is_empty() || self.base.is_some_and(|base| base.name() == text) {
            return;
        }
        match (TimeBase::named(text), self.base) {
            (Some(base), None) => {
                self.base = Some(base);
                self.clock.note_base(base);
            }
            (Some(base), Some(before)) => {
                let (base, before) = (base.name(), before.name());
                let detail = format!("times are '{base}' here and '{before}' before");
                self.fault(column, "conflict", detail);
            }
            (None, _) => {
                let detail = format!("'{}' is nothing that times are counted from", shorten(text));
                let allowed = TimeBase::ALL.map(TimeBase::name).join(", ");
                self.fault_allowing(column, "unknown_value", detail, &allowed);
            }
        }
    }

    /// The time of a cell (s).
    pub fn time(&mut self, column: usize) -> Option<f64> {
        self.note_base();
        let text = self.rows.cell(column).trim_ascii();
        match self.clock.read(text) {
            Ok(time_s) => return Some(time_s),
            Err(NoTime::NotFinite) => {
                self.fault(
                    column,
                    "not_finite",
                    format!("'{text}' is not a finite number"),
                );
            }
            Err(_) if text.is_empty() => self.fault(
                column,
                "missing",
                format!("'{}' is empty", self.rows.names()[column]),
            ),
            Err(NoTime::Unreadable) => {
                let detail = format!("expected a time, found '{}'", shorten(text));
                self.fault_allowing(column, "malformed", detail, TIMES);
            }
            Err(NoTime::OtherWay) => {
                let detail = format!(
                    "'{}' is written in another way than the times before",
                    shorten(text)
                );
                self.fault_allowing(column, "malformed", detail, TIMES);
            }
        }
        None
    }

    /// Reports a latitude and a longitude that are not on the Earth.
    pub fn fault_off_earth(&mut self, [lon, lat]: [usize; 2], lat_deg: f64, lon_deg: f64) {
        if lat_deg.abs() > 90.0 {
            let detail = format!("{lat_deg} is no latitude");
            self.fault_allowing(lat, "out_of_range", detail, "-90 to 90 degrees");
        }
        if lon_deg.abs() > 180.0 {
            let detail = format!("{lon_deg} is no longitude");
            self.fault_allowing(lon, "out_of_range", detail, "-180 to 180 degrees");
        }
    }

    /// A finite number; an empty cell is a fault.
    pub fn number(&mut self, column: usize) -> Option<f64> {
        let text = self.rows.cell(column).trim_ascii();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => return Some(value * self.scales[column]),
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
