//! What rows say of an object beside its motion, row by row, where that changes.

use super::interner::Interner;
use super::row::RowReader;
use crate::model::changes::{CHANGING, Changes, Said};

/// The words of each object, by its number, column by column.
#[derive(Default)]
pub struct Codes {
    texts: Interner,
    said: Vec<Vec<Said>>,
}

impl Codes {
    /// Keeps the words of the current row.
    pub fn note(
        &mut self,
        reader: &RowReader,
        columns: &[(&'static str, usize)],
        (object, time_s): (u32, f64),
    ) {
        if columns.is_empty() {
            return;
        }
        let index = object as usize;
        if self.said.len() <= index {
            self.said.resize_with(index + 1, Vec::new);
        }
        let said = &mut self.said[index];
        said.resize_with(columns.len(), Said::default);
        for (&(name, column), said) in columns.iter().zip(said) {
            if CHANGING.contains(&name) {
                let text = reader.text(column).trim();
                said.note(time_s, (!text.is_empty()).then(|| self.texts.number(text)));
            }
        }
    }

    /// Those that change, by the names of their objects.
    pub fn finish(self, columns: &[(&'static str, usize)], names: &Interner) -> Changes {
        let mut changes = Changes::with_texts(self.texts.into_names());
        for (object, said) in self.said.into_iter().enumerate() {
            for (&(name, _), said) in columns.iter().zip(said) {
                changes.insert(names.name(object as u32), name, said);
            }
        }
        changes.slim()
    }
}
