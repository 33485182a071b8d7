//! What a build server reads: JUnit XML, Markdown, and whether all was met.

use crate::experiment::{LimitCheck, LimitsReport};
use anyhow::Context;
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Files for a build server.
#[derive(Args)]
pub(super) struct VerdictFiles {
    /// Write the verdicts as JUnit XML into this file
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write the verdicts as a Markdown table into this file
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
}

/// One thing that is met or not.
pub(super) struct Verdict {
    pub name: String,
    pub met: bool,
    /// What was found, and against what.
    pub detail: String,
}

impl VerdictFiles {
    /// Writes the files that are asked for; `suite` is what was judged.
    pub fn write(&self, suite: &str, verdicts: &[Verdict]) -> anyhow::Result<()> {
        if let Some(path) = &self.junit {
            write_text(path, &junit(suite, verdicts))?;
        }
        if let Some(path) = &self.markdown {
            write_text(path, &markdown(suite, verdicts))?;
        }
        Ok(())
    }
}

fn write_text(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

pub(super) fn verdicts_of(report: &LimitsReport) -> Vec<Verdict> {
    report.checks.iter().map(verdict_of).collect()
}

fn verdict_of(check: &LimitCheck) -> Verdict {
    let limit = &check.limit;
    let mut name = limit.quantity.clone();
    if let Some(cell) = &limit.cell {
        let _ = write!(name, " in {cell}");
    }
    let mut detail = match (check.value, &check.reason) {
        (Some(value), None) => number(value),
        (Some(value), Some(reason)) => format!("{} ({reason})", number(value)),
        (None, Some(reason)) => format!("no number: {reason}"),
        (None, None) => "no number".to_owned(),
    };
    if let Some(interval) = &check.interval {
        let _ = write!(
            detail,
            " [{}, {}]",
            number(interval.low),
            number(interval.high)
        );
    }
    for (bound, words) in [(limit.at_least, "at least"), (limit.at_most, "at most")] {
        if let Some(bound) = bound {
            let _ = write!(detail, ", {words} {}", number(bound));
        }
    }
    if let Some(margin) = check.margin {
        let _ = write!(detail, ", margin {}", number(margin));
    }
    Verdict {
        name,
        met: check.met,
        detail,
    }
}

/// Six digits.
pub(super) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    rounded.to_string()
}

fn junit(suite: &str, verdicts: &[Verdict]) -> String {
    let failures = verdicts.iter().filter(|verdict| !verdict.met).count();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
    let (tests, suite) = (verdicts.len(), escape(suite));
    let _ = writeln!(
        text,
        "  <testsuite name=\"{suite}\" tests=\"{tests}\" failures=\"{failures}\" errors=\"0\" skipped=\"0\">"
    );
    for verdict in verdicts {
        let (name, detail) = (escape(&verdict.name), escape(&verdict.detail));
        let _ = write!(text, "    <testcase classname=\"{suite}\" name=\"{name}\">");
        if verdict.met {
            let _ = write!(text, "<system-out>{detail}</system-out>");
        } else {
            let _ = write!(text, "<failure message=\"{detail}\"/>");
        }
        text.push_str("</testcase>\n");
    }
    text.push_str("  </testsuite>\n</testsuites>\n");
    text
}

/// A text in XML; what XML has no place for is left out.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for one in text.chars() {
        match one {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\t' => escaped.push(' '),
            one if one < ' ' || matches!(one, '\u{fffe}' | '\u{ffff}') => {}
            one => escaped.push(one),
        }
    }
    escaped
}

fn markdown(suite: &str, verdicts: &[Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.met).count();
    let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
    let mut text = format!(
        "### {}: {met} of {} met\n\n| | what | found |\n|---|---|---|\n",
        cell(suite),
        verdicts.len()
    );
    for verdict in verdicts {
        let word = if verdict.met { "met" } else { "**not met**" };
        let _ = writeln!(
            text,
            "| {word} | {} | {} |",
            cell(&verdict.name),
            cell(&verdict.detail)
        );
    }
    text
}

/// What is not met, a line each.
pub(super) fn failures(verdicts: &[Verdict]) -> Option<String> {
    let failed = verdicts.iter().filter(|verdict| !verdict.met);
    let lines: Vec<String> = failed
        .map(|verdict| format!("  {}: {}", verdict.name, verdict.detail))
        .collect();
    (!lines.is_empty()).then(|| {
        format!(
            "{} of {} not met\n{}",
            lines.len(),
            verdicts.len(),
            lines.join("\n")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two() -> Vec<Verdict> {
        let of = |name: &str, met, detail: &str| Verdict {
            name: name.to_owned(),
            met,
            detail: detail.to_owned(),
        };
        vec![
            of("clear.mota", true, "0.9, at least 0.8"),
            of("a<b & \"c\"|d\u{1}", false, "no number"),
        ]
    }

    #[test]
    fn hostile_names_are_escaped_in_both_files() {
        let xml = junit("job", &two());
        assert!(
            xml.contains("name=\"a&lt;b &amp; &quot;c&quot;|d\"><failure message=\"no number\"/>")
        );
        assert!(xml.contains("tests=\"2\" failures=\"1\""));
        let table = markdown("job", &two());
        assert!(table.contains("| **not met** | a<b & \"c\"\\|d\u{1} | no number |"));
        assert_eq!(
            failures(&two()).unwrap().lines().next(),
            Some("1 of 2 not met")
        );
        assert_eq!(failures(&two()[..1]), None);
    }

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!(
            [0.1 + 0.2, 1234567.0, -0.5, 1e-9].map(number),
            ["0.3", "1234570", "-0.5", "0.000000001"]
        );
    }
}
