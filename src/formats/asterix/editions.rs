//! Which edition of a category a file is written in. That its records can be walked is no proof: an old edition may parse
//! as a newer one and say nonsense. So they must be plausible, too.

use super::Told;
use super::capture::payloads;
use super::framing::{Block, Framing, Piece, pieces};
use super::items::{Said, TimeSaid, said};
use super::uap::{EDITIONS, Edition, Uap, editions_of};
use super::walk::{Items, walk};
use crate::formats::feed::Spot;
use crate::model::fault::Fault;
use std::collections::BTreeMap;

/// What is looked at of a category: so many records, or blocks where they have none that can be read.
const LOOKED_AT: usize = 200;
/// Share of blocks that must be read, and of records that must be plausible.
const ENOUGH: f64 = 0.99;
const DAY_S: f64 = 86_400.0;
/// A record is captured within this time of the time that it says.
const LATE_S: f64 = 3600.0;

/// Tables for the categories of a file, and what is to be told of them.
pub struct Chosen {
    pub uaps: BTreeMap<u8, Uap>,
    pub warnings: Vec<String>,
}

/// Chooses the edition of each category of the file: the one that was told, else the newest, else the only other that fits.
///
/// # Errors
/// `unsupported_edition` where none fits, with the shares; `unknown_value` for an edition that is not known.
pub fn choose(file: &[u8], framing: Framing, told: &Told) -> Result<Chosen, Vec<Fault>> {
    let named = named(told)?;
    let samples = samples(file, framing);
    let mut chosen = Chosen {
        uaps: BTreeMap::new(),
        warnings: Vec::new(),
    };
    let mut faults = Vec::new();
    for (category, blocks) in &samples {
        let sample = Sample {
            blocks,
            is_dated: told.day_s.is_none() && !named.contains_key(category),
        };
        match of_category(*category, named.get(category).copied(), &sample) {
            Ok((edition, warning)) => {
                chosen.uaps.insert(*category, Uap::of(edition));
                chosen.warnings.extend(warning);
            }
            Err(fault) => faults.extend(fault),
        }
    }
    if faults.is_empty() {
        Ok(chosen)
    } else {
        Err(faults)
    }
}

/// The editions that were told.
///
/// # Errors
/// `unknown_value` for an edition that is not known.
pub fn named(told: &Told) -> Result<BTreeMap<u8, &'static Edition>, Vec<Fault>> {
    let mut named = BTreeMap::new();
    let mut faults = Vec::new();
    for (category, name) in &told.editions {
        let known = category.parse().ok().and_then(|category| {
            editions_of(category)
                .find(|edition| edition.name == name || edition.reads.contains(&name.as_str()))
        });
        match known {
            Some(edition) => drop(named.insert(edition.category, edition)),
            None => faults.push(unknown(category, name)),
        }
    }
    if faults.is_empty() {
        Ok(named)
    } else {
        Err(faults)
    }
}

fn unknown(category: &str, name: &str) -> Fault {
    let detail = format!("edition {name} of category {category} is not read");
    let known: Vec<String> = EDITIONS
        .iter()
        .flat_map(|edition| {
            let names = edition.reads.iter().chain([&edition.name]);
            names.map(|name| format!("{:03}: {name}", edition.category))
        })
        .collect();
    Fault::new("/editions", "unknown_value", detail).allowing(known.join(", "))
}

/// Chooses the edition of one category of a stream by its first blocks, whose day is not known.
///
/// # Errors
/// `unsupported_edition` as of [`choose`].
pub fn of_first_blocks(
    category: u8,
    named: Option<&'static Edition>,
    blocks: &[Block],
) -> Result<(Uap, Option<String>), Vec<Fault>> {
    let sample = Sample {
        blocks,
        is_dated: false,
    };
    let (edition, warning) = of_category(category, named, &sample)?;
    Ok((Uap::of(edition), warning))
}

/// The first blocks of each category that is read.
fn samples(file: &[u8], framing: Framing) -> BTreeMap<u8, Vec<Block<'_>>> {
    let mut samples: BTreeMap<u8, Vec<Block>> = BTreeMap::new();
    for piece in payloads(file).flat_map(|payload| pieces(payload, framing)) {
        if let Piece::Block(block) = piece
            && editions_of(block.category).next().is_some()
        {
            let blocks = samples.entry(block.category).or_default();
            if blocks.len() < LOOKED_AT {
                blocks.push(block);
            }
        }
    }
    samples
}

struct Sample<'s, 'a> {
    blocks: &'s [Block<'a>],
    /// Whether the time of the capture is that of its records.
    is_dated: bool,
}

/// How an edition fits.
#[derive(Default)]
struct Fit {
    blocks: usize,
    read: usize,
    records: usize,
    plausible: usize,
    /// What was wrong, by how often.
    wrong: BTreeMap<&'static str, usize>,
}

fn of_category(
    category: u8,
    named: Option<&'static Edition>,
    sample: &Sample,
) -> Result<(&'static Edition, Option<String>), Vec<Fault>> {
    if let Some(edition) = named {
        let fit = Fit::of(edition, sample);
        return match fit.is_enough() {
            true => Ok((edition, None)),
            false => Err(unsupported(category, &[(edition, fit)])),
        };
    }
    let fits: Vec<(&'static Edition, Fit)> = editions_of(category)
        .map(|edition| (edition, Fit::of(edition, sample)))
        .collect();
    let mut fitting = fits.iter().filter(|(_, fit)| fit.is_enough());
    let default = fits.first().map(|(edition, _)| edition.name);
    match (fitting.next(), fitting.next()) {
        (Some((edition, _)), _) if Some(edition.name) == default => Ok((edition, None)),
        (Some((edition, _)), None) => Ok((edition, Some(another(category, edition)))),
        _ => Err(unsupported(category, &fits)),
    }
}

fn another(category: u8, edition: &Edition) -> String {
    format!(
        "category {category:03} is read as edition {}: its records are not those of the newest one",
        edition.name
    )
}

fn unsupported(category: u8, fits: &[(&'static Edition, Fit)]) -> Vec<Fault> {
    let tried: Vec<String> = fits
        .iter()
        .map(|(edition, fit)| format!("as edition {} {}", edition.name, fit.told()))
        .collect();
    let detail = format!(
        "records of category {category:03} are of no edition that is read: {}",
        tried.join("; ")
    );
    vec![Fault::new("/file", "unsupported_edition", detail)]
}

impl Fit {
    fn of(edition: &'static Edition, sample: &Sample) -> Self {
        let uap = Uap::of(edition);
        let mut items = Items::default();
        let mut fit = Fit::default();
        for block in sample.blocks {
            if fit.records >= LOOKED_AT {
                break;
            }
            fit.blocks += 1;
            let captured_s = block.captured_s.filter(|_| sample.is_dated);
            let mut of_block = Fit::default();
            let mut rest = block.records;
            while !rest.is_empty() {
                let Ok(length) = walk(&uap, rest, &mut items) else {
                    break;
                };
                of_block.count(doubt(&said(&uap, &items), captured_s));
                rest = &rest[length..];
            }
            if rest.is_empty() {
                fit.add(of_block);
            }
        }
        fit
    }

    fn count(&mut self, doubt: Option<&'static str>) {
        self.records += 1;
        match doubt {
            Some(doubt) => *self.wrong.entry(doubt).or_default() += 1,
            None => self.plausible += 1,
        }
    }

    /// Adds a block that was read to its end.
    fn add(&mut self, block: Fit) {
        self.read += 1;
        self.records += block.records;
        self.plausible += block.plausible;
        for (doubt, count) in block.wrong {
            *self.wrong.entry(doubt).or_default() += count;
        }
    }

    fn is_enough(&self) -> bool {
        let share = |part: usize, all: usize| part as f64 >= ENOUGH * all as f64;
        share(self.read, self.blocks) && share(self.plausible, self.records)
    }

    fn told(&self) -> String {
        let wrong: Vec<String> = self
            .wrong
            .iter()
            .map(|(doubt, count)| format!("{count} {doubt}"))
            .collect();
        let why = if wrong.is_empty() {
            String::new()
        } else {
            format!(" ({})", wrong.join(", "))
        };
        format!(
            "{} of {} blocks can be read and {} of {} records are plausible{why}",
            self.read, self.blocks, self.plausible, self.records
        )
    }
}

/// Why a record is not plausible.
fn doubt(said: &Said, captured_s: Option<f64>) -> Option<&'static str> {
    let (source, of_day_s, spot) = match said {
        Said::Service(service) => (service.source, service.of_day_s, None),
        Said::Target(target) => {
            let of_day_s = match target.time {
                Some(TimeSaid::OfDay(of_day_s)) => Some(of_day_s),
                _ => None,
            };
            (target.source, of_day_s, target.spot)
        }
    };
    if source.is_none() {
        return Some("without a source");
    }
    if let Some(of_day_s) = of_day_s {
        if of_day_s >= DAY_S {
            return Some("with a time after the end of the day");
        }
        let apart_s = captured_s.map_or(0.0, |captured_s| {
            let apart_s = (captured_s - of_day_s).rem_euclid(DAY_S);
            apart_s.min(DAY_S - apart_s)
        });
        if apart_s > LATE_S {
            return Some("over an hour from the time of capture");
        }
    }
    if let Some(Spot::Geographic { lat_deg, lon_deg }) = spot
        && (lat_deg.abs() > 90.0 || lon_deg.abs() > 180.0)
    {
        return Some("outside the Earth");
    }
    None
}
