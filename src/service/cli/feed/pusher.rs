//! Batches of scans on their way to a session, and what becomes of them.

use super::client::{Client, Reply};
use super::places::Places;
use super::progress::Progress;
use super::ready::Ready;
use crate::model::fault::Fault;
use anyhow::{Context, bail};

/// Scans and bytes of a batch; a session takes 1000 and 8 MiB.
pub(super) const MOST_SCANS: usize = 1000;
const MOST_BYTES: usize = 7 << 20;

pub(super) struct Pusher {
    pub client: Client,
    pub scans_url: String,
    pub skips_faults: bool,
    /// Of scans that do not say where they come from.
    pub places: Option<Places>,
    pub progress: Progress,
}

impl Pusher {
    /// Pushes scans in their order. When it returns the session has them, or has refused them.
    ///
    /// # Errors
    /// A service that does not answer; what the session refuses, unless that is to be counted.
    pub async fn push(&mut self, scans: &[Ready]) -> anyhow::Result<()> {
        let mut rest = scans;
        while !rest.is_empty() {
            let (lines, count) = batch(rest)?;
            let (first, others) = rest.split_at(count);
            self.push_batch(first, lines).await?;
            rest = others;
            self.progress.show();
        }
        Ok(())
    }

    async fn push_batch(&mut self, scans: &[Ready], lines: String) -> anyhow::Result<()> {
        let (mut lines, mut left) = (lines, scans.iter().collect::<Vec<_>>());
        loop {
            let faults = match self.client.push(&self.scans_url, lines).await? {
                Reply::Taken(fates) => {
                    for (ready, fate) in left.iter().zip(fates) {
                        let scan = &ready.scan;
                        self.progress.note(fate, scan.detections.len(), scan.time_s);
                    }
                    return Ok(());
                }
                Reply::Refused(faults) => faults,
            };
            let refused = refused_lines(&faults, left.len());
            if !self.skips_faults || refused.is_empty() {
                let places = (self.places.as_ref(), self.progress.units.called.as_str());
                let told = faults.iter().map(|fault| told(fault, &left, places));
                let told: Vec<String> = told.collect();
                bail!(
                    "the session refuses what it was given\n  {}",
                    told.join("\n  ")
                );
            }
            self.progress.refused += refused.len() as u64;
            let mut number = 0;
            left.retain(|_| {
                number += 1;
                !refused.contains(&number)
            });
            if left.is_empty() {
                return Ok(());
            }
            lines = String::new();
            for ready in &left {
                add(&mut lines, ready)?;
            }
        }
    }
}

/// The lines of a batch that have faults, from 1.
fn refused_lines(faults: &[Fault], scans: usize) -> Vec<u64> {
    let mut lines: Vec<u64> = faults.iter().filter_map(|fault| fault.line).collect();
    lines.retain(|line| (1..=scans as u64).contains(line));
    lines.sort_unstable();
    lines.dedup();
    lines
}

/// A fault with its place in the file, `line 17, sensor 'radar' at 2.5 s: /detections/0: …`.
fn told(fault: &Fault, scans: &[&Ready], places: (Option<&Places>, &str)) -> String {
    let index = fault.line.and_then(|line| line.checked_sub(1));
    let ready = index.and_then(|index| scans.get(index as usize));
    let allowed = match &fault.allowed {
        Some(allowed) => format!(" (allowed: {allowed})"),
        None => String::new(),
    };
    let place = ready.map_or(String::new(), |ready| {
        let scan = &ready.scan;
        let unit = unit_told(ready, &fault.pointer, places);
        format!("{unit}sensor '{}' at {} s: ", scan.sensor_id, scan.time_s)
    });
    format!("{place}{}: {}{allowed}", fault.pointer, fault.detail)
}

/// `line 17, `; nothing where nobody knows.
fn unit_told(ready: &Ready, pointer: &str, (places, called): (Option<&Places>, &str)) -> String {
    if ready.unit > 0 {
        return format!("{called} {}, ", ready.unit);
    }
    let in_list = pointer.strip_prefix("/detections/");
    let index = in_list.and_then(|rest| rest.split('/').next()?.parse().ok());
    let detection = ready.scan.detections.get(index.unwrap_or(0_usize));
    let (Some(places), Some(detection)) = (places, detection) else {
        return String::new();
    };
    match places.unit_of(detection) {
        Some(unit) => format!("{called} {unit}, "),
        None => String::new(),
    }
}

/// As many scans as go into a batch, and how many these are.
fn batch(scans: &[Ready]) -> anyhow::Result<(String, usize)> {
    let (mut lines, mut count) = (String::new(), 0);
    for ready in scans.iter().take(MOST_SCANS) {
        let before = lines.len();
        add(&mut lines, ready)?;
        if lines.len() > MOST_BYTES && count > 0 {
            lines.truncate(before);
            break;
        }
        count += 1;
    }
    Ok((lines, count))
}

fn add(lines: &mut String, ready: &Ready) -> anyhow::Result<()> {
    lines.push_str(&serde_json::to_string(&ready.scan).context("a scan is no JSON")?);
    lines.push('\n');
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::session::{PushedDetection, PushedScan};

    fn ready(detections: usize) -> Ready {
        let scan = PushedScan {
            sensor_id: "r".to_owned(),
            sequence: Some(1),
            time_s: 2.0,
            heartbeat: false,
            pose: None,
            detections: vec![PushedDetection::default(); detections],
        };
        Ready { scan, unit: 17 }
    }

    #[test]
    fn batches_are_bounded_by_scans_and_by_bytes() {
        let (lines, count) = batch(&vec![ready(1); 2500]).unwrap_or_default();
        assert_eq!((count, lines.lines().count()), (MOST_SCANS, MOST_SCANS));
        // A detection of no values takes three bytes.
        let (lines, count) = batch(&vec![ready(1_000_000); 4]).unwrap_or_default();
        assert_eq!((count, lines.len() <= MOST_BYTES), (2, true));
        let (_, count) = batch(&vec![ready(4_000_000); 2]).unwrap_or_default();
        assert_eq!(
            count, 1,
            "one that is too large is for the service to refuse"
        );
    }

    #[test]
    fn faults_name_the_line_of_the_file() {
        let fault = Fault {
            line: Some(1),
            ..Fault::new("/time_s", "out_of_range", "too late")
        };
        assert_eq!(refused_lines(&[fault.clone(), fault.clone()], 3), [1]);
        let (scan, allowed) = (ready(0), fault.allowing("less"));
        let wanted = "line 17, sensor 'r' at 2 s: /time_s: too late (allowed: less)";
        assert_eq!(told(&allowed, &[&scan], (None, "line")), wanted);
    }
}
