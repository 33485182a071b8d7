//! The rules of the house, checked over the sources: layers, banned calls, sizes of functions and files.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Each part of `src` with the parts it may name. Steps never name each other; `tracking` composes them.
const MAY_USE: &[(&str, &[&str])] = &[
    ("model", &[]),
    ("math", &["model"]),
    ("registry", &["model"]),
    ("geodesy", &["model"]),
    ("simulation", BASE),
    ("detection", BASE),
    ("filtering", BASE),
    ("gating", BASE),
    ("association", BASE),
    ("correlation", BASE),
    ("evaluation", BASE),
    ("formats", BASE),
    (
        "hypotheses",
        &["model", "math", "filtering", "gating", "association"],
    ),
    (
        "tracking",
        &[
            "model",
            "math",
            "registry",
            "filtering",
            "gating",
            "association",
            "hypotheses",
        ],
    ),
    ("experiment", PURE),
    (
        "service",
        &[
            "model",
            "math",
            "registry",
            "geodesy",
            "simulation",
            "evaluation",
            "formats",
            "tracking",
            "experiment",
        ],
    ),
];
const BASE: &[&str] = &["model", "math", "registry", "geodesy"];
const PURE: &[&str] = &[
    "model",
    "math",
    "registry",
    "geodesy",
    "simulation",
    "detection",
    "filtering",
    "gating",
    "association",
    "correlation",
    "evaluation",
    "formats",
    "hypotheses",
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

/// Where a request is JSON, and what of the other JSON is read elsewhere: presets are requests, the others read results.
const READS_JSON: &[&str] = &[
    "experiment/request/",
    "experiment/presets/",
    "experiment/files/text.rs",
    "experiment/result_numbers.rs",
];

/// Rooms of a part (folders, and files beside them) that name each other in a circle. These lists only get shorter.
const CIRCLES: &[(&str, &[&str])] = &[("experiment", &[]), ("service", &[])];

/// Functions of a file that bind more than one closure by `let`. The numbers only get smaller.
const MANY_CLOSURES: &str = include_str!("many_closures.txt");

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
    line.split("crate::")
        .skip(1)
        .flat_map(first_words)
        .collect()
}

/// The word with which a path goes on, or those of a list in braces.
fn first_words(path: &str) -> Vec<String> {
    let word = |text: &str| {
        text.trim_start()
            .chars()
            .take_while(|letter| letter.is_alphanumeric() || *letter == '_')
            .collect::<String>()
    };
    match path.strip_prefix('{') {
        Some(list) => list_entries(list)
            .iter()
            .map(|entry| word(entry))
            .filter(|word| !word.is_empty())
            .collect(),
        None => vec![word(path)],
    }
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
        .filter(|source| !source.is_test())
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
fn requests_are_json_in_one_folder_alone() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| {
        let path = source.path.display().to_string();
        source.part == "experiment"
            && !source.is_test()
            && !READS_JSON.iter().any(|place| path.starts_with(place))
    }) {
        for (number, line) in source.code_lines().filter(|(_, line)| reads_json(line)) {
            let line = line.trim();
            faults.push(format!("{}:{number}: {line}", source.path.display()));
        }
    }
    assert_none("JSON is read by name", &faults);
}

/// Whether something is looked up by a name in quotes, or by a pointer.
fn reads_json(line: &str) -> bool {
    let is_indexed = line.match_indices("[\"").any(|(place, _)| {
        let before = line[..place].chars().next_back();
        before.is_some_and(|letter| letter.is_alphanumeric() || "_)]".contains(letter))
    });
    is_indexed
        || [".pointer(", ".pointer_mut(", ".get(\"", ".get_mut(\""]
            .iter()
            .any(|word| line.contains(word))
}

/// What is generic over the number of values of a measurement: sensing models, the filters that go through them, and hypotheses.
#[test]
fn trackers_know_no_measurement_dimension() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| source.part == "tracking") {
        for (number, line) in source.code_lines() {
            if line.contains("const D:") || line.contains("Corrector<") {
                faults.push(format!(
                    "{}:{number}: {}",
                    source.path.display(),
                    line.trim()
                ));
            }
        }
    }
    assert_none("a measurement's dimension in tracking", &faults);
}

#[test]
fn rooms_of_a_part_form_no_circle() {
    let sources = sources();
    for (part, known) in CIRCLES {
        let found = in_circles(&rooms(part, &sources));
        assert_eq!(
            found, *known,
            "rooms of {part} that name each other in a circle"
        );
    }
}

/// The rooms of a part, each with those that it names; the module at its top, which names them all, is ``.
fn rooms(part: &str, sources: &[Source]) -> BTreeMap<String, BTreeSet<String>> {
    let inside: Vec<(Vec<String>, &Source)> = sources
        .iter()
        .filter(|source| source.part == part)
        .map(|source| (module_of(&source.path), source))
        .collect();
    let room_of = |module: &[String]| module.first().cloned().unwrap_or_default();
    let mut rooms: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, _) in &inside {
        rooms.entry(room_of(module)).or_default();
    }
    let names: BTreeSet<String> = rooms.keys().cloned().collect();
    for (module, source) in &inside {
        let own = room_of(module);
        for name in named_in_part(part, module, source) {
            // What is no room is a name that the top gives on.
            let room = if names.contains(&name) {
                name
            } else {
                String::new()
            };
            if room != own {
                rooms.entry(own.clone()).or_default().insert(room);
            }
        }
    }
    rooms
}

/// `http/jobs/create.rs` is the module `http::jobs::create` of its part.
fn module_of(path: &Path) -> Vec<String> {
    let mut module: Vec<String> = path
        .components()
        .skip(1)
        .map(|component| component.as_os_str().to_string_lossy().into_owned())
        .collect();
    let file = module.pop().unwrap();
    match file.as_str() {
        "mod.rs" => {}
        file => module.push(file.trim_end_matches(".rs").to_owned()),
    }
    module
}

/// What a file names just below the top of its part.
fn named_in_part(part: &str, module: &[String], source: &Source) -> Vec<String> {
    let code: Vec<&str> = source.code_lines().map(|(_, line)| line).collect();
    let code = code.join("\n");
    let mut names = Vec::new();
    for after in code.split(&format!("crate::{part}::")).skip(1) {
        names.extend(first_words(after));
    }
    let to_the_top = "super::".repeat(module.len());
    if !module.is_empty() {
        for (place, _) in code.match_indices(&to_the_top) {
            let after = &code[place + to_the_top.len()..];
            let is_deeper = after.starts_with("super::") || code[..place].ends_with("super::");
            if !is_deeper {
                names.extend(first_words(after));
            }
        }
    }
    names
}

/// The rooms from which a way leads back to them.
fn in_circles(rooms: &BTreeMap<String, BTreeSet<String>>) -> Vec<String> {
    let is_in_circle = |start: &&String| {
        let mut reached = BTreeSet::new();
        let mut open: Vec<&String> = rooms[*start].iter().collect();
        while let Some(room) = open.pop() {
            if reached.insert(room) {
                open.extend(&rooms[room]);
            }
        }
        reached.contains(start)
    };
    rooms.keys().filter(is_in_circle).cloned().collect()
}

#[test]
fn functions_bind_one_closure_at_most() {
    let mut found = Vec::new();
    for source in sources().iter().filter(|source| !source.is_test()) {
        let lines: Vec<&str> = source.shipped().lines().collect();
        let many = functions(source.shipped())
            .into_iter()
            .filter(|(_, first, length)| closures(&lines[first - 1..first - 1 + length]) > 1)
            .count();
        if many > 0 {
            found.push(format!("{} {many}", source.path.display()));
        }
    }
    let known: Vec<&str> = MANY_CLOSURES.lines().collect();
    let news: Vec<String> = found
        .iter()
        .filter(|line| !known.contains(&line.as_str()))
        .cloned()
        .collect();
    assert_none("functions with several closures, by file", &news);
    let gone: Vec<String> = known
        .iter()
        .filter(|line| !found.iter().any(|found| found == *line))
        .map(|line| (*line).to_owned())
        .collect();
    assert_none("no more so, take it off tests/many_closures.txt", &gone);
}

/// How many closures are bound to a name in these lines.
fn closures(lines: &[&str]) -> usize {
    let is_closure = |text: &str| {
        let text = text.trim_start();
        text.starts_with('|') || text.starts_with("move |")
    };
    let mut count = 0;
    for (index, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let Some((name, value)) = code
            .strip_prefix("let ")
            .and_then(|rest| rest.split_once('='))
        else {
            continue;
        };
        let is_name = name
            .trim_start_matches("mut ")
            .trim()
            .chars()
            .all(|letter| letter.is_alphanumeric() || letter == '_');
        let value = if value.trim().is_empty() {
            lines.get(index + 1).copied().unwrap_or_default()
        } else {
            value
        };
        count += usize::from(is_name && is_closure(value));
    }
    count
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
        let head = lines[index..]
            .iter()
            .find(|line| line.ends_with(['{', '}', ';']))
            .unwrap_or(line);
        let has_no_body = head.ends_with(';');
        if let Some(end) = end.filter(|_| !has_no_body && !line.ends_with('}')) {
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
    fn reading_json_by_name_is_told_from_lists_of_names() {
        assert!(reads_json(r#"spec["seed"].as_u64()"#));
        assert!(reads_json(r#"job()["a"]"#) && reads_json(r#"body.pointer("/a")"#));
        assert!(!reads_json(r#"for name in ["a", "b"] {"#) && !reads_json(r#"&["a"]"#));
    }

    #[test]
    fn circles_are_found_and_ways_without_return_are_none() {
        let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let rooms = [
            ("a", named(&["b"])),
            ("b", named(&["c"])),
            ("c", named(&["b"])),
        ];
        let rooms = rooms.map(|(room, names)| (room.to_owned(), names)).into();
        assert_eq!(in_circles(&rooms), ["b", "c"]);
    }

    #[test]
    fn closures_bound_by_let_are_counted_and_others_are_not() {
        let text = [
            "let f = |x| x;",
            "let g =",
            "    move |y| y;",
            "let h = list.map(|z| z);",
        ];
        assert_eq!(closures(&text), 2);
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
