//! A stream: read on a thread of its own, gathered in scans, pushed as it comes. Scans are numbered on from what the session has.

use super::arrivals::{Head, Kind};
use super::inlets::{self, Datagrams};
use super::pusher::MOST_SCANS;
use super::queue::{Queue, now_s};
use super::ready::Ready;
use super::teller::{Teller, Told};
use super::{Feeding, Source};
use crate::experiment::session::{PushedDetection, PushedScan};
use crate::formats::Reading;
use crate::formats::live::{FRAME_S, GatheredScan, Gatherer};
use crate::model::fault::Fault;
use crate::model::units::Units;
use crate::service::cli::run::Trouble;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::mpsc;

/// What comes within this time goes together.
const TOGETHER: Duration = Duration::from_millis(50);
/// Reports that may wait for a session that is slow.
const WAITING: usize = 10_000;
/// Times that are this near to the clock are taken as its times (s).
const NEAR_S: f64 = 1e6;

/// Feeds a stream until it ends, or somebody asks to stop.
pub(super) async fn feed(feeding: &mut Feeding<'_>, source: &Source) -> Result<(), Trouble> {
    let (format, options) = feeding.arguments.told(&feeding.session)?;
    let said = match (feeding.arguments.is_of_scans(), format) {
        (true, _) => Some(Kind::Scans),
        (false, format) => format.map(Kind::Of),
    };
    let reading = Reading::of(&options.options)?;
    let queue = Queue::default();
    let datagrams = open(source, &queue)?;
    let (sender, told) = mpsc::channel(WAITING);
    let units = Arc::new(Mutex::new(Units::called("unit")));
    let teller = Teller {
        sender,
        units: units.clone(),
    };
    let head = Head::of(queue.clone());
    std::thread::spawn(move || teller.read(head, said, &options));
    let mut stream = Streaming {
        next: next_numbers(feeding),
        gatherer: Gatherer::new(
            reading.frame_s.unwrap_or(FRAME_S),
            feeding.arguments.settle_s,
        ),
        ready: Vec::new(),
        queue,
        datagrams,
        units,
        superseded: 0,
        unknown: BTreeMap::new(),
    };
    let done = stream.run(feeding, told).await;
    // Whatever happened, nobody reads any more.
    stream.queue.close();
    stream.note_counts(feeding);
    done
}

fn open(source: &Source, queue: &Queue) -> anyhow::Result<Option<Datagrams>> {
    match source {
        Source::Udp(address) => return inlets::udp(address, queue.clone()).map(Some),
        Source::Tcp(address) => inlets::tcp(address, queue.clone()),
        Source::Stdin | Source::File(_) => inlets::stdin(queue.clone()),
    }
    Ok(None)
}

/// The number of the next scan of each sensor.
fn next_numbers(feeding: &Feeding) -> BTreeMap<String, u64> {
    let heard = feeding.session.heard.iter();
    let next = heard.filter_map(|heard| Some((heard.sensor_id.clone(), heard.last_sequence? + 1)));
    next.collect()
}

struct Streaming {
    /// Of each sensor.
    next: BTreeMap<String, u64>,
    gatherer: Gatherer,
    ready: Vec<Ready>,
    queue: Queue,
    datagrams: Option<Datagrams>,
    /// As the reader counts them.
    units: Arc<Mutex<Units>>,
    superseded: u64,
    /// Units of sensors that are none of the session's.
    unknown: BTreeMap<String, u64>,
}

impl Streaming {
    async fn run(
        &mut self,
        feeding: &mut Feeding<'_>,
        mut told: mpsc::Receiver<Told>,
    ) -> Result<(), Trouble> {
        let mut is_open = true;
        while is_open {
            let until = tokio::time::Instant::now() + TOGETHER;
            while is_open && self.ready.len() < MOST_SCANS {
                tokio::select! {
                    () = feeding.stop.asked(), if !self.queue.is_closed() => self.queue.stop(),
                    next = told.recv() => is_open = self.hear(feeding, next)?,
                    () = tokio::time::sleep_until(until) => break,
                }
                if tokio::time::Instant::now() >= until {
                    break;
                }
            }
            let gathered = self.gather(feeding, is_open);
            self.push(feeding).await?;
            gathered?;
        }
        match self.queue.failure() {
            Some(error) => Err(Trouble::Failed(error)),
            None => Ok(()),
        }
    }

    /// Takes what the reader tells; `false` at the end.
    fn hear(&mut self, feeding: &mut Feeding, next: Option<Told>) -> Result<bool, Trouble> {
        match next {
            None => return Ok(false),
            Some(Told::Report(report)) => self.gatherer.take(report, now_s()),
            Some(Told::Scan(ready)) => self.number(*ready),
            Some(Told::Warning(warning)) => eprintln!("warning: {warning}"),
            Some(Told::Faults(faults)) if feeding.arguments.skip_faults => drop(faults),
            Some(Told::Faults(faults)) => return Err(refused(&faults)),
            Some(Told::End(Ok(units))) => {
                *self.units.lock().unwrap_or_else(PoisonError::into_inner) = units;
                return Ok(false);
            }
            Some(Told::End(Err(faults))) => return Err(Trouble::Faults(faults)),
        }
        Ok(true)
    }

    /// # Errors
    /// There is a second sensor, while the first was taken for the only one.
    fn gather(&mut self, feeding: &mut Feeding, is_open: bool) -> Result<(), Vec<Fault>> {
        let whole = if is_open {
            self.gatherer.whole(now_s())
        } else {
            self.gatherer.end()
        };
        for scan in whole {
            self.superseded += scan.superseded;
            match feeding.mapping.of(&scan.sensor).map(str::to_owned) {
                Some(sensor_id) => self.number(ready_of(scan, sensor_id)),
                None if feeding.mapping.guessed_wrong() => {
                    return Err(vec![feeding.mapping.unknown(&scan.sensor)]);
                }
                None => {
                    let units = scan.detections.len() as u64;
                    let known = self.unknown.contains_key(&*scan.sensor);
                    if !known && self.unknown.len() < 100 {
                        eprintln!("warning: {}", feeding.mapping.unknown(&scan.sensor).detail);
                        self.unknown.insert(scan.sensor.to_string(), units);
                    } else {
                        *self.unknown.entry(String::new()).or_default() += units;
                    }
                }
            }
        }
        Ok(())
    }

    /// Gives a scan its number, where its sender has none.
    fn number(&mut self, mut ready: Ready) {
        let scan = &mut ready.scan;
        let next = self.next.entry(scan.sensor_id.clone()).or_insert(1);
        let sequence = *scan.sequence.get_or_insert(*next);
        *next = (*next).max(sequence + 1);
        self.ready.push(ready);
    }

    async fn push(&mut self, feeding: &mut Feeding<'_>) -> Result<(), Trouble> {
        self.note_counts(feeding);
        if self.ready.is_empty() {
            feeding.pusher.progress.show();
            return Ok(());
        }
        let ready = std::mem::take(&mut self.ready);
        feeding.pusher.push(&ready).await?;
        let newest_s = ready.iter().map(|ready| ready.scan.time_s);
        let lag_s = now_s() - newest_s.fold(f64::NEG_INFINITY, f64::max);
        feeding.pusher.progress.lag_s = (lag_s.abs() < NEAR_S).then_some(lag_s);
        Ok(())
    }

    fn note_counts(&self, feeding: &mut Feeding) {
        let progress = &mut feeding.pusher.progress;
        let mut units = self
            .units
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let unknown: u64 = self.unknown.values().sum();
        // The reader counts them as used.
        units.ignore_used("superseded", self.superseded);
        units.ignore_used("sensor unknown", unknown);
        progress.units = units;
        if let Some(datagrams) = &self.datagrams {
            progress.lost = datagrams.lost();
            progress.lost_in_kernel = datagrams.lost_in_kernel();
        }
    }
}

fn ready_of(scan: GatheredScan, sensor_id: String) -> Ready {
    let detections = scan.detections.into_iter();
    let scan_of = PushedScan {
        sensor_id,
        sequence: None,
        time_s: scan.time_s,
        heartbeat: false,
        pose: None,
        detections: detections
            .map(|(id, detection)| PushedDetection::of(id, &detection))
            .collect(),
    };
    Ready {
        scan: scan_of,
        unit: scan.unit,
    }
}

/// Lines that are no scans end the feed as what a session refuses does.
fn refused(faults: &[Fault]) -> Trouble {
    let told = faults.iter().map(|fault| {
        let line = fault.line.unwrap_or_default();
        format!("\n  line {line}: {}: {}", fault.pointer, fault.detail)
    });
    let told: String = told.collect();
    Trouble::Failed(anyhow::anyhow!("what comes is no scan{told}"))
}
