//! `trackloom methods`, `presets` and `openapi`: what can be asked for, printed.

use super::BAD_INPUT;
use super::output;
use crate::experiment::job_shape::with_kind;
use crate::experiment::presets::ALIASES;
use crate::experiment::{catalogue, presets};
use crate::registry::{Field, Presence, Variant};
use crate::service::openapi;
use clap::Args;
use serde_json::{Value, json};
use std::process::ExitCode;

#[derive(Args)]
pub(super) struct MethodsArguments {
    /// Only this method, with its parameters
    name: Option<String>,
    /// The whole catalogue with the JSON Schema of every method's parameters, for programs
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct PresetsArguments {
    /// Only this one, as a job file for `trackloom run`
    name: Option<String>,
    /// The list as JSON, for programs
    #[arg(long)]
    json: bool,
}

pub(super) fn print_methods(arguments: &MethodsArguments) -> ExitCode {
    match &arguments.name {
        Some(name) => {
            let found = methods()
                .into_iter()
                .filter(|(_, variant)| variant.tag == name)
                .collect::<Vec<_>>();
            if found.is_empty() {
                return unknown("method", name, "methods");
            }
            let describe =
                |(family, variant): &(&str, Variant)| describe(family, variant, arguments.json);
            printed(&found.iter().map(describe).collect::<Vec<_>>().join("\n\n"))
        }
        None if arguments.json => {
            let families: Vec<Value> = catalogue::FAMILIES
                .iter()
                .map(catalogue::describe)
                .collect();
            printed(&pretty(&json!({"families": families})))
        }
        None => {
            let row = |(family, variant): (&str, Variant)| {
                vec![
                    family.to_owned(),
                    variant.tag.to_owned(),
                    variant.object.summary.to_owned(),
                ]
            };
            let rows: Vec<_> = methods().into_iter().map(row).collect();
            printed(&format!(
                "{}\n\n`trackloom methods NAME` lists the parameters of one.",
                list(&["family", "method", "summary"], &rows)
            ))
        }
    }
}

/// Every method with the name of its family.
fn methods() -> Vec<(&'static str, Variant)> {
    catalogue::FAMILIES
        .iter()
        .flat_map(|family| {
            family
                .methods()
                .into_iter()
                .map(|variant| (family.name, variant))
        })
        .collect()
}

/// A method with its parameters.
fn describe(family: &str, variant: &Variant, as_json: bool) -> String {
    let object = variant.object;
    if as_json {
        return pretty(
            &json!({"family": family, "name": variant.tag, "parameters": crate::registry::standalone_schema(object)}),
        );
    }
    let head = format!("{family} {}: {}", variant.tag, object.summary);
    if object.fields.is_empty() {
        return format!("{head}\n\nIt has no parameters.");
    }
    let row = |field: &Field| {
        vec![
            field.name.to_owned(),
            presence(&field.presence),
            field.summary.to_owned(),
        ]
    };
    format!(
        "{head}\n\n{}",
        list(
            &["parameter", "default", "meaning"],
            &object.fields.iter().map(row).collect::<Vec<_>>()
        )
    )
}

fn presence(presence: &Presence) -> String {
    match presence {
        Presence::Required => "required".to_owned(),
        Presence::Optional => "–".to_owned(),
        Presence::Default(value) => (*value).to_owned(),
    }
}

/// All presets, or one as a job file.
pub(super) fn print_presets(arguments: &PresetsArguments) -> ExitCode {
    match arguments.name.as_deref() {
        Some(name) => match presets::find(name) {
            Some(preset) => printed(&pretty(&with_kind(preset.kind, &preset.body))),
            None => unknown("preset", name, "presets"),
        },
        None if arguments.json => {
            let item = |preset: presets::Preset| json!({"name": preset.name, "kind": preset.kind, "summary": preset.summary});
            printed(&pretty(&presets::all().into_iter().map(item).collect()))
        }
        None => printed(&presets_table()),
    }
}

fn presets_table() -> String {
    let row =
        |preset: presets::Preset| vec![preset.name, preset.kind.name().to_owned(), preset.summary];
    let mut rows: Vec<_> = presets::all().into_iter().map(row).collect();
    rows.extend(ALIASES.map(|(alias, name)| {
        vec![
            alias.to_owned(),
            String::new(),
            format!("the same as {name}"),
        ]
    }));
    rows.push(vec![
        "papers".to_owned(),
        String::new(),
        format!("{}, one after the other", presets::PAPERS.join(", ")),
    ]);
    let presets = list(&["preset", "kind", "summary"], &rows);
    format!(
        "{presets}\n\n`trackloom run --preset NAME` runs one, `trackloom presets NAME` prints its job file."
    )
}

/// A table of texts: columns as wide as their widest cell, the last one as long as it is.
fn list(header: &[&str], rows: &[Vec<String>]) -> String {
    let header = header.iter().map(ToString::to_string).collect();
    let lines: Vec<&Vec<String>> = std::iter::once(&header).chain(rows).collect();
    let width = |column: usize| {
        lines
            .iter()
            .map(|line| line[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len() - 1).map(width).chain([0]).collect();
    let padded = |line: &&Vec<String>| {
        let cells = line
            .iter()
            .zip(&widths)
            .map(|(cell, &width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    lines.iter().map(padded).collect::<Vec<_>>().join("\n")
}

fn unknown(what: &str, name: &str, command: &str) -> ExitCode {
    eprintln!("trackloom: there is no {what} '{name}'; `trackloom {command}` lists them");
    ExitCode::from(BAD_INPUT)
}

pub(super) fn print_openapi(as_3_0: bool) -> ExitCode {
    printed(&pretty(&if as_3_0 {
        openapi::document_3_0()
    } else {
        openapi::document()
    }))
}

fn pretty(value: &Value) -> String {
    format!("{value:#}")
}

fn printed(text: &str) -> ExitCode {
    match output::print(text) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("trackloom: {error:#}");
            ExitCode::FAILURE
        }
    }
}
