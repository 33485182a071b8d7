//! Tables in CSV for the files of a job.

use crate::experiment::job::Artifact;
use std::borrow::Cow;

/// Rows of cells under a header, for one sequence after another; the header comes from the first.
pub struct Table {
    header: Vec<String>,
    /// The name of the sequence is the first column.
    has_names: bool,
    is_written: bool,
    has_columns: bool,
    name: String,
    bytes: Vec<u8>,
}

impl Table {
    pub fn new(has_names: bool, header: &[&str]) -> Table {
        let names = has_names.then_some("sequence");
        let header = names
            .iter()
            .chain(header)
            .map(|&name| name.to_owned())
            .collect();
        Table {
            header,
            has_names,
            is_written: false,
            has_columns: false,
            name: String::new(),
            bytes: Vec::new(),
        }
    }

    /// The rows that follow belong to this sequence.
    pub fn begin(&mut self, name: &str) {
        self.name = quoted(name).into_owned();
    }

    /// More columns behind those of [`new`](Self::new); only the first time, as all sequences have the same.
    pub fn columns(&mut self, names: impl Iterator<Item = String>) {
        if !std::mem::replace(&mut self.has_columns, true) {
            self.header.extend(names);
        }
    }

    pub fn row(&mut self, cells: &[String]) {
        self.write_header();
        if self.has_names {
            self.bytes.extend_from_slice(self.name.as_bytes());
        }
        for (index, cell) in cells.iter().enumerate() {
            if index > 0 || self.has_names {
                self.bytes.push(b',');
            }
            self.bytes.extend_from_slice(quoted(cell).as_bytes());
        }
        self.bytes.push(b'\n');
    }

    pub fn artifact(mut self, name: &'static str) -> Artifact {
        self.write_header();
        Artifact::file(name, "text/csv", self.bytes)
    }

    fn write_header(&mut self) {
        if !std::mem::replace(&mut self.is_written, true) {
            let names: Vec<Cow<str>> = self.header.iter().map(|name| quoted(name)).collect();
            self.bytes.extend(names.join(",").bytes());
            self.bytes.push(b'\n');
        }
    }
}

/// A number as a cell, the shortest text that reads back as it; zero has no sign.
pub fn number(value: f64) -> String {
    (value + 0.0).to_string()
}

/// An absent number is an empty cell.
pub fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// A CSV field, quoted where it must be.
pub fn quoted(text: &str) -> Cow<'_, str> {
    let is_special = |byte| matches!(byte, b',' | b'"' | b'\n' | b'\r');
    if text.bytes().any(is_special) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(
            [
                number(-0.0),
                number(0.0),
                number(-0.5),
                optional(Some(-0.0)),
                optional(None)
            ],
            ["0", "0", "-0.5", "0", ""]
        );
    }

    #[test]
    fn a_table_has_one_header_and_names_its_sequences_when_there_are_several() {
        let mut table = Table::new(true, &["id"]);
        for name in ["first", "a,b"] {
            table.begin(name);
            table.columns(["value".to_owned()].into_iter());
            table.row(&["1".to_owned(), "say \"x\"".to_owned()]);
        }
        let text = String::from_utf8(table.artifact("t.csv").bytes).unwrap();
        assert_eq!(
            text,
            "sequence,id,value\nfirst,1,\"say \"\"x\"\"\"\n\"a,b\",1,\"say \"\"x\"\"\"\n"
        );
        assert_eq!(Table::new(false, &["id"]).artifact("t.csv").bytes, b"id\n");
    }
}
