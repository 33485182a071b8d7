//! `trackloom convert`: a file in another format, without a server.

use super::reading::ReadArguments;
use super::run::{Trouble, end};
use crate::formats::{WRITERS, WriteError, Writer, writer_named};
use crate::model::dataset::Dataset;
use anyhow::Context;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Args)]
pub(super) struct ConvertArguments {
    #[command(flatten)]
    read: ReadArguments,
    /// The format to write
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(WRITERS.iter().map(|writer| writer.name)))]
    to: String,
    /// Where to write; standard output when absent
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(super) fn convert(arguments: &ConvertArguments) -> ExitCode {
    end(finish(arguments), "the file cannot be converted")
}

fn finish(arguments: &ConvertArguments) -> Result<(), Trouble> {
    // The parser of arguments lets no other name through.
    let Some(writer) = writer_named(&arguments.to) else {
        return Ok(());
    };
    let dataset = arguments.read.dataset()?;
    match &arguments.output {
        None => write(writer, &dataset, std::io::stdout().lock()),
        Some(path) => write_file(writer, &dataset, path),
    }
}

/// Writes under another name first, so that the file is never half written.
fn write_file(writer: &Writer, dataset: &Dataset, path: &Path) -> Result<(), Trouble> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let part = path.with_file_name(format!(".{name}.part"));
    let cannot = || format!("cannot write {}", path.display());
    let file = File::create(&part).with_context(cannot)?;
    let written = write(writer, dataset, file).and_then(|()| {
        let renamed = std::fs::rename(&part, path).with_context(cannot);
        renamed.map_err(Trouble::Failed)
    });
    if written.is_err() {
        // What is left of it is of no use, and its loss no news.
        let _ = std::fs::remove_file(&part);
    }
    written
}

fn write(writer: &Writer, dataset: &Dataset, out: impl Write) -> Result<(), Trouble> {
    let mut out = BufWriter::with_capacity(1 << 16, out);
    match writer.put(dataset, &mut out) {
        Err(WriteError::Faults(faults)) => Err(faults.into()),
        Err(WriteError::Output(error)) => Err(Trouble::Failed(error.into())),
        Ok(()) => out.flush().map_err(|error| Trouble::Failed(error.into())),
    }
}
