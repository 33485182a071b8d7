//! The rules of the house, checked over the sources: layers, banned calls, sizes of functions and files.

use std::fs;
use std::path::{Path, PathBuf};

/// Each part of `src` with the parts it may name. Steps never name each other; `tracking` composes them.
const MAY_USE: &[(&str, &[&str])] = &[
    ("model", &[]),
    ("math", &["model"]),
    ("registry", &["model"]),
    ("simulation", BASE),
    ("detection", BASE),
    ("filtering", BASE),
    ("gating", BASE),
    ("association", BASE),
    ("correlation", BASE),
    ("evaluation", BASE),
    ("formats", BASE),
    (
        "tracking",
        &[
            "model",
            "math",
            "registry",
            "filtering",
            "gating",
            "association",
        ],
    ),
    ("experiment", PURE),
    (
        "service",
        &[
            "model",
            "math",
            "registry",
            "simulation",
            "evaluation",
            "formats",
            "tracking",
            "experiment",
        ],
    ),
];
const BASE: &[&str] = &["model", "math", "registry"];
const PURE: &[&str] = &[
    "model",
    "math",
    "registry",
    "simulation",
    "detection",
    "filtering",
    "gating",
    "association",
    "correlation",
    "evaluation",
    "formats",
    "tracking",
];

/// What no layer below the service may contain.
const IMPURE: &[&str] = &[
    "tokio",
    "axum",
    "sqlx",
    "Instant::now",
    "SystemTime",
    "std::fs",
    "std::net",
    "std::thread",
    "std::env",
    "println!",
    "print!",
    "static mut",
    "thread_local!",
    "OnceLock",
    "LazyLock",
    "rand::rng()",
    "from_entropy",
    "from_os_rng",
];

/// What shipped code may not contain anywhere.
const BANNED: &[&str] = &[
    ".unwrap()",
    "panic!(",
    "todo!(",
    "unimplemented!(",
    "dbg!(",
    "#[allow(",
];

const MAX_FUNCTION_LINES: usize = 70;
const MAX_FILE_LINES: usize = 500;

struct Source {
    path: PathBuf,
    /// The part of `src` it belongs to; empty for `domain.rs`, `lib.rs` and `main.rs`.
    part: String,
    text: String,
}

impl Source {
    /// The text up to its unit tests.
    fn shipped(&self) -> &str {
        self.text
            .split("#[cfg(test)]\nmod ")
            .next()
            .unwrap_or_default()
    }

    /// Shipped lines without comments, numbered from 1.
    fn code_lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let is_code = |(_, line): &(usize, &str)| !line.trim_start().starts_with("//");
        self.shipped()
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line))
            .filter(is_code)
    }

    fn is_test(&self) -> bool {
        self.path.file_name().is_some_and(|name| name == "tests.rs")
    }
}

fn sources() -> Vec<Source> {
    // The manifest of the domain lies in `src`.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).to_owned();
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let read = |path: PathBuf| {
        let inside = path.strip_prefix(&root).unwrap();
        let first = inside
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_string_lossy()
            .into_owned();
        // `domain.rs`, `lib.rs` and `main.rs` belong to no part.
        let part = if first.ends_with(".rs") {
            String::new()
        } else {
            first
        };
        Source {
            text: fs::read_to_string(&path).unwrap(),
            part,
            path: inside.to_owned(),
        }
    };
    files.into_iter().map(read).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

fn assert_none(what: &str, faults: &[String]) {
    assert!(faults.is_empty(), "{what}:\n{}", faults.join("\n"));
}

/// The parts named in `crate::part` paths of a line, `use crate::{a::…, b::…}` included.
fn named_parts(line: &str) -> Vec<String> {
    let word = |text: &str| {
        text.trim_start()
            .chars()
            .take_while(|letter| letter.is_alphanumeric() || *letter == '_')
            .collect::<String>()
    };
    let mut parts = Vec::new();
    for after in line.split("crate::").skip(1) {
        match after.strip_prefix('{') {
            Some(list) => parts.extend(list_entries(list).iter().map(|entry| word(entry))),
            None => parts.push(word(after)),
        }
    }
    parts
}

/// The entries of a list in braces, commas inside deeper braces not counted, up to the brace that closes it.
fn list_entries(list: &str) -> Vec<String> {
    let mut entries = vec![String::new()];
    let mut depth = 0;
    for letter in list.chars() {
        match letter {
            '}' if depth == 0 => break,
            ',' if depth == 0 => entries.push(String::new()),
            _ => {
                depth += i32::from(letter == '{') - i32::from(letter == '}');
                let last = entries.len() - 1;
                entries[last].push(letter);
            }
        }
    }
    entries
}

#[test]
fn arrows_between_layers_only_point_down() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| !source.part.is_empty()) {
        let allowed = MAY_USE.iter().find(|(part, _)| *part == source.part);
        let Some((_, allowed)) = allowed else {
            faults.push(format!(
                "{}: the part '{}' has no place in the layers",
                source.path.display(),
                source.part
            ));
            continue;
        };
        for (number, line) in source.code_lines() {
            for part in named_parts(line).into_iter().filter(|part| {
                *part != source.part && MAY_USE.iter().any(|(known, _)| known == part)
            }) {
                if !allowed.contains(&part.as_str()) {
                    faults.push(format!(
                        "{}:{number}: {} may not use {part}",
                        source.path.display(),
                        source.part
                    ));
                }
            }
        }
    }
    assert_none("wrong arrows", &faults);
}

#[test]
fn below_the_service_there_is_no_clock_file_thread_or_global() {
    let mut faults = Vec::new();
    for source in sources()
        .iter()
        .filter(|source| source.part != "service" && !source.path.ends_with("main.rs"))
    {
        for (number, line) in source.code_lines() {
            for word in IMPURE.iter().filter(|word| line.contains(**word)) {
                faults.push(format!("{}:{number}: {word}", source.path.display()));
            }
        }
    }
    assert_none("not pure", &faults);
}

#[test]
fn shipped_code_does_not_give_up() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| !source.is_test()) {
        for (number, line) in source.code_lines() {
            for word in BANNED.iter().filter(|word| line.contains(**word)) {
                faults.push(format!("{}:{number}: {word}", source.path.display()));
            }
        }
    }
    assert_none("banned", &faults);
}

#[test]
fn every_module_says_what_it_is_for() {
    let is_silent = |source: &&Source| !source.text.starts_with("//!");
    let faults: Vec<String> = sources()
        .iter()
        .filter(is_silent)
        .map(|source| source.path.display().to_string())
        .collect();
    assert_none("no module documentation", &faults);
}

#[test]
fn files_and_functions_stay_small() {
    let mut faults = Vec::new();
    for source in &sources() {
        let lines = source.text.lines().count();
        if lines > MAX_FILE_LINES {
            faults.push(format!("{}: {lines} lines", source.path.display()));
        }
        for (name, number, length) in functions(&source.text) {
            if length > MAX_FUNCTION_LINES {
                faults.push(format!(
                    "{}:{number}: fn {name} has {length} lines",
                    source.path.display()
                ));
            }
        }
    }
    assert_none("too long", &faults);
}

/// Name, first line and length of every function; formatted code closes one at the indentation that opened it.
fn functions(text: &str) -> Vec<(String, usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let Some(name) = code.split("fn ").nth(1).filter(|_| is_function_head(code)) else {
            continue;
        };
        let indent = &line[..line.len() - code.len()];
        let end = lines[index..]
            .iter()
            .position(|line| *line == format!("{indent}}}"));
        let is_one_line = line.ends_with('}') || line.ends_with(';');
        if let Some(end) = end.filter(|_| !is_one_line) {
            found.push((
                name.chars()
                    .take_while(|letter| letter.is_alphanumeric() || *letter == '_')
                    .collect(),
                index + 1,
                end + 1,
            ));
        }
    }
    found
}

fn is_function_head(code: &str) -> bool {
    let words = [
        "fn ",
        "pub fn ",
        "pub(crate) fn ",
        "pub(super) fn ",
        "async fn ",
        "pub async fn ",
        "const fn ",
        "pub const fn ",
        "pub(super) async fn ",
        "pub(crate) async fn ",
    ];
    words.iter().any(|word| code.starts_with(word))
}

mod the_checks_themselves {
    use super::*;

    #[test]
    fn paths_are_found_in_every_form() {
        assert_eq!(named_parts("use crate::model::scan::Scan;"), ["model"]);
        assert_eq!(
            named_parts("use crate::{gating::grid::Grid, math};"),
            ["gating", "math"]
        );
        assert_eq!(
            named_parts("let x = crate::formats::read(crate::model::y);"),
            ["formats", "model"]
        );
    }

    #[test]
    fn the_length_of_a_function_counts_its_lines() {
        let text = "fn one() {\n    two();\n}\n\nimpl X {\n    pub fn three(\n        a: u8,\n    ) {\n        if a {\n        }\n    }\n}\n";
        assert_eq!(
            functions(text),
            [("one".to_owned(), 1, 3), ("three".to_owned(), 6, 6)]
        );
    }
}
