//! `trackloom methods`, `presets` and `openapi`: what can be asked for, printed.

use super::BAD_INPUT;
use crate::experiment::catalogue;
use crate::experiment::plan::with_kind;
use crate::experiment::presets;
use crate::service::openapi;
use serde_json::{Value, json};
use std::io::Write;
use std::process::ExitCode;

pub(super) fn print_methods() -> anyhow::Result<()> {
    let families: Vec<Value> = catalogue::FAMILIES.iter().map(catalogue::describe).collect();
    print(&json!({"families": families}))
}

/// All presets, or one as a job file.
pub(super) fn print_presets(name: Option<&str>) -> ExitCode {
    let printed = match name {
        None => {
            let item = |preset: presets::Preset| json!({"name": preset.name, "kind": preset.kind, "summary": preset.summary});
            print(&presets::all().into_iter().map(item).collect())
        }
        Some(name) => match presets::find(name) {
            Some(preset) => print(&with_kind(preset.kind, &preset.body)),
            None => {
                eprintln!("trackloom: there is no preset '{name}'; `trackloom presets` lists them");
                return ExitCode::from(BAD_INPUT);
            }
        },
    };
    if printed.is_ok() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

pub(super) fn print_openapi(as_3_0: bool) -> anyhow::Result<()> {
    print(&if as_3_0 { openapi::document_3_0() } else { openapi::document() })
}

/// Prints JSON for people. A reader that closes the pipe early is no failure.
fn print(value: &Value) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
