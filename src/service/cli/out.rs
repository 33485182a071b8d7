//! The directory of `trackloom run --out`: it holds one run. A list beside the report says which files are of that run, so that
//! nobody takes those of another for them.

use crate::experiment::Artifact;
use anyhow::Context;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The names of the files of the run, a line each.
pub(super) const LIST: &str = "files.txt";
pub(super) const REPORT: &str = "report.json";

/// Writes each file under another name first, so that none is ever half written; the report last. What an earlier run
/// listed is gone, unless this one reads it.
pub(super) fn write(
    folder: &Path,
    report: &[u8],
    artifacts: &[Artifact],
    inputs: impl Iterator<Item = PathBuf>,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    remove_earlier(folder, inputs)?;
    let artifacts = artifacts
        .iter()
        .map(|artifact| (artifact.name, artifact.bytes.as_slice()));
    let names: Vec<&str> = artifacts.clone().map(|(name, _)| name).collect();
    let list = names.iter().map(|name| format!("{name}\n"));
    let list = list.collect::<String>().into_bytes();
    for (name, bytes) in artifacts.chain([(LIST, list.as_slice()), (REPORT, report)]) {
        let (part, path) = (folder.join(format!(".{name}.part")), folder.join(name));
        let written = std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, &path));
        written.with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(())
}

/// The files that belong to the report of a directory; `None` where nobody lists them.
pub(super) fn listed(folder: &Path) -> Option<BTreeSet<String>> {
    let text = std::fs::read_to_string(folder.join(LIST)).ok()?;
    folder
        .join(REPORT)
        .is_file()
        .then(|| text.lines().map(str::to_owned).collect())
}

/// Only what its list names: other files in the directory are not of a run.
fn remove_earlier(folder: &Path, inputs: impl Iterator<Item = PathBuf>) -> anyhow::Result<()> {
    let kept: Vec<PathBuf> = inputs.filter_map(|path| path.canonicalize().ok()).collect();
    let is_plain = |name: &String| {
        Path::new(name)
            .file_name()
            .is_some_and(|plain| plain == name.as_str())
    };
    let listed = listed(folder)
        .unwrap_or_default()
        .into_iter()
        .filter(is_plain);
    // Without its report the rest is of nobody, should this end halfway.
    let with_report = [REPORT.to_owned()].into_iter().chain(listed);
    for name in with_report {
        let path = folder.join(name);
        if path.canonicalize().is_ok_and(|path| kept.contains(&path)) {
            continue;
        }
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(error).with_context(|| format!("cannot remove {}", path.display()));
            }
            _ => {}
        }
    }
    Ok(())
}
