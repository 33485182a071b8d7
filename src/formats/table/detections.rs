//! Detections: rows in order of time become scans. A row with neither detection nor measurement declares a scan that
//! saw nothing.

mod write;

pub use write::write;

use super::Rows;
use super::header::Header;
use super::interner::Interner;
use super::row::RowReader;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::scan::{Detection, Measurement, Recording, RecordingParts, Scan};
use crate::model::sensor::SensorSettings;

/// Where the columns of detections are.
struct Columns {
    time: usize,
    scan: usize,
    sensor: usize,
    id: usize,
    x: Option<usize>,
    y: Option<usize>,
    range: Option<usize>,
    bearing: Option<usize>,
    range_rate: Option<usize>,
    amplitude: Option<usize>,
    truth: Option<usize>,
    z: Option<usize>,
}

impl Columns {
    fn from_header(header: &Header) -> Self {
        Columns {
            time: header.required("time_s"),
            scan: header.required("scan"),
            sensor: header.required("sensor_id"),
            id: header.required("detection_id"),
            x: header.find("x_m"),
            y: header.find("y_m"),
            range: header.find("range_m"),
            bearing: header.find("bearing_deg"),
            range_rate: header.find("range_rate_mps"),
            amplitude: header.find("amplitude"),
            truth: header.find("truth_id"),
            z: header.find("z_m"),
        }
    }
}

/// A scan as its rows show it; its sensor is numbered in the order the file names them.
#[derive(Default)]
struct OpenScan {
    sensor: u32,
    number: u32,
    time_s: f64,
    row: u64,
    detections: Vec<Detection>,
}

/// What the rows have shown so far; one entry a detection in the last four lists, or none at all in `z_m`.
#[derive(Default)]
struct Builder {
    sensors: Interner,
    targets: Interner,
    scans: Vec<OpenScan>,
    /// The latest scan of each sensor.
    latest: Vec<Option<usize>>,
    /// Time and number of the row before.
    last_row: Option<(f64, u64)>,
    /// Whether a row had both a position and a range or bearing.
    ambiguous: bool,
    z_m: Vec<Option<f64>>,
    ids: Vec<String>,
    scan_of: Vec<u32>,
    rows: Vec<u64>,
}

/// Reads detections; also whether there was no row at all.
///
/// # Errors
/// Every fault of the rows.
pub fn read(
    rows: &mut dyn Rows,
    header: &Header,
    sensors: Vec<SensorSettings>,
    warnings: &mut Vec<String>,
) -> Result<(Dataset, bool), Vec<Fault>> {
    let columns = Columns::from_header(header);
    let mut reader = RowReader::new(rows);
    let mut builder = Builder::default();
    while reader.advance() {
        builder.read_row(&mut reader, &columns);
    }
    builder.sort_scans(&mut reader, &columns);
    reader.faults.finish()?;
    if builder.ambiguous {
        warnings.push(
            "rows have x_m, y_m and also range_m or bearing_deg: the position is used".to_owned(),
        );
    }
    let empty = builder.scans.is_empty();
    let recording = builder.finish(sensors, columns.truth.is_some())?;
    Ok((Dataset::Detections(recording), empty))
}

impl Builder {
    fn read_row(&mut self, reader: &mut RowReader, columns: &Columns) {
        let time_s = reader.number(columns.time);
        let number = reader.whole_number(columns.scan);
        reader.require_name(columns.sensor);
        columns
            .truth
            .into_iter()
            .for_each(|column| reader.check_name(column));
        reader.check_name(columns.id);
        let measurement = self.measurement(reader, columns);
        let amplitude = reader.optional_number(columns.amplitude);
        let z_m = reader.optional_number(columns.z);
        if let Some(time_s) = time_s {
            self.check_order(reader, columns, time_s);
        }
        let (Some(time_s), Some(number), true) = (time_s, number, reader.is_sound()) else {
            return;
        };
        let sensor = self.sensors.number(reader.text(columns.sensor));
        let Some(scan) = self.scan(
            reader,
            columns,
            OpenScan {
                sensor,
                number,
                time_s,
                row: reader.row(),
                detections: Vec::new(),
            },
        ) else {
            return;
        };
        let Some(measurement) = measurement else {
            return;
        };
        let truth = reader.optional_text(columns.truth);
        let origin = (!truth.is_empty()).then(|| self.targets.number(truth));
        self.scans[scan].detections.push(Detection {
            measurement,
            origin,
            amplitude,
        });
        self.z_m.extend(columns.z.map(|_| z_m));
        self.ids.push(reader.text(columns.id).to_owned());
        self.scan_of.push(scan as u32);
        self.rows.push(reader.row());
    }

    /// The row's measurement; `None` for a row that declares an empty scan, and for faults.
    fn measurement(&mut self, reader: &mut RowReader, columns: &Columns) -> Option<Measurement> {
        let mut place_m = [0.0; 2];
        let places = columns.x.zip(columns.y).map(|(x, y)| [x, y]);
        let is_placed = reader.fill(places.as_ref().map(<[_; 2]>::as_slice), &mut place_m);
        let position = is_placed.then_some(place_m);
        let range_m = reader.optional_number(columns.range);
        if let (Some(column), Some(range_m)) =
            (columns.range, range_m.filter(|range_m| *range_m < 0.0))
        {
            reader.fault_allowing(
                column,
                "out_of_range",
                format!("a range of {range_m} m is below zero"),
                ">= 0 m",
            );
        }
        let bearing = reader.optional_number(columns.bearing);
        let range_rate_mps = reader.optional_number(columns.range_rate);
        if !reader.is_sound() {
            return None;
        }
        self.ambiguous |= position.is_some() && (range_m.is_some() || bearing.is_some());
        let measurement = match (position, range_m, bearing.map(f64::to_radians)) {
            (Some([x_m, y_m]), _, _) => Measurement::Position { x_m, y_m },
            (None, Some(range_m), Some(bearing_rad)) => Measurement::RangeBearing {
                range_m,
                bearing_rad,
                range_rate_mps,
            },
            (None, None, Some(bearing_rad)) => Measurement::Bearing { bearing_rad },
            (None, range_m, None) => {
                let column = range_m
                    .and(columns.bearing)
                    .or(columns.x)
                    .or(columns.bearing)?;
                if range_m.is_some() {
                    reader.fault(column, "missing", "a range needs a bearing".to_owned());
                } else if !reader.text(columns.id).is_empty() {
                    let detail =
                        format!("detection '{}' has no measurement", reader.text(columns.id));
                    reader.fault(column, "missing", detail);
                }
                return None;
            }
        };
        reader.require_name(columns.id);
        Some(measurement)
    }

    fn check_order(&mut self, reader: &mut RowReader, columns: &Columns, time_s: f64) {
        if let Some((before_s, row)) = self.last_row.replace((time_s, reader.row()))
            && time_s < before_s
        {
            let detail = format!(
                "time {time_s} s comes after {before_s} s on {}",
                reader.called(row)
            );
            reader.fault(columns.time, "unsorted", detail);
        }
    }

    /// The scan of a row: the sensor's latest one, or a new one.
    fn scan(&mut self, reader: &mut RowReader, columns: &Columns, scan: OpenScan) -> Option<usize> {
        let sensor = scan.sensor as usize;
        if self.latest.len() <= sensor {
            self.latest.resize(sensor + 1, None);
        }
        if let Some(index) = self.latest[sensor] {
            let latest = &self.scans[index];
            if scan.number == latest.number && scan.time_s == latest.time_s {
                return Some(index);
            }
            if let Some((column, code, what)) = misfit(latest, &scan, columns) {
                let detail = format!(
                    "sensor '{}': {what} ({})",
                    self.sensors.name(scan.sensor),
                    reader.called(latest.row)
                );
                reader.fault(column, code, detail);
                return None;
            }
            self.scans[index].detections.shrink_to_fit();
        }
        self.latest[sensor] = Some(self.scans.len());
        self.scans.push(scan);
        self.latest[sensor]
    }

    /// Brings scans into the order of time and sensor, ids and rows into that of scans, and finds ids used twice.
    fn sort_scans(&mut self, reader: &mut RowReader, columns: &Columns) {
        let mut order: Vec<u32> = (0..self.scan_of.len() as u32).collect();
        let key = |scan: &OpenScan| (scan.time_s, self.sensors.name(scan.sensor));
        let mut scan_order: Vec<usize> = (0..self.scans.len()).collect();
        scan_order.sort_by(|&a, &b| {
            let ((time_a, name_a), (time_b, name_b)) = (key(&self.scans[a]), key(&self.scans[b]));
            time_a
                .total_cmp(&time_b)
                .then_with(|| natural_order(name_a, name_b))
        });
        let mut place = vec![0; scan_order.len()];
        for (new, &old) in scan_order.iter().enumerate() {
            place[old] = new as u32;
        }
        self.scans = scan_order
            .iter()
            .map(|&old| std::mem::take(&mut self.scans[old]))
            .collect();
        self.scan_of
            .iter_mut()
            .for_each(|scan| *scan = place[*scan as usize]);
        if !self.scan_of.is_sorted() {
            order.sort_by_key(|&index| self.scan_of[index as usize]);
            self.ids = order
                .iter()
                .map(|&old| std::mem::take(&mut self.ids[old as usize]))
                .collect();
            self.rows = order.iter().map(|&old| self.rows[old as usize]).collect();
            self.z_m = order
                .iter()
                .filter_map(|&old| self.z_m.get(old as usize).copied())
                .collect();
            self.scan_of.sort_unstable();
        }
        self.check_ids(reader, columns);
    }

    fn check_ids(&self, reader: &mut RowReader, columns: &Columns) {
        let mut first = 0;
        let mut sorted: Vec<usize> = Vec::new();
        for group in self.scan_of.chunk_by(|a, b| a == b) {
            sorted.clear();
            sorted.extend(first..first + group.len());
            first += group.len();
            sorted.sort_by(|&a, &b| self.ids[a].cmp(&self.ids[b]));
            for pair in sorted
                .windows(2)
                .filter(|pair| self.ids[pair[0]] == self.ids[pair[1]])
            {
                let scan = &self.scans[group[0] as usize];
                let detail = format!(
                    "detection '{}' occurs twice in scan {} of sensor '{}': also on {}",
                    self.ids[pair[1]],
                    scan.number,
                    self.sensors.name(scan.sensor),
                    reader.called(self.rows[pair[0]])
                );
                reader.fault_in(self.rows[pair[1]], columns.id, "duplicate", detail);
            }
        }
    }

    fn finish(
        mut self,
        declared: Vec<SensorSettings>,
        origins_known: bool,
    ) -> Result<Recording, Vec<Fault>> {
        for settings in &declared {
            self.sensors.number(&settings.sensor_id);
        }
        let (names, sensor_place) = self.sensors.sorted();
        let (targets, target_place) = self.targets.sorted();
        let mut scans: Vec<Scan> = Vec::with_capacity(self.scans.len());
        for mut scan in self.scans {
            for detection in &mut scan.detections {
                detection.origin = detection.origin.map(|origin| target_place[origin as usize]);
            }
            scan.detections.shrink_to_fit();
            scans.push(Scan {
                number: scan.number,
                time_s: scan.time_s,
                sensor: sensor_place[scan.sensor as usize] as usize,
                pose: None,
                detections: scan.detections,
            });
        }
        let settings = |name: String| {
            declared
                .iter()
                .find(|known| known.sensor_id == name)
                .cloned()
                .unwrap_or(SensorSettings::named(name))
        };
        let sensors = names.into_iter().map(settings).collect();
        Recording::new(RecordingParts {
            frame: None,
            sensors,
            scans,
            detection_ids: self.ids,
            z_m: self.z_m,
            targets,
            origins_known,
        })
    }
}

/// Why `scan` cannot follow the sensor's `latest` one: column, code and words.
fn misfit(
    latest: &OpenScan,
    scan: &OpenScan,
    columns: &Columns,
) -> Option<(usize, &'static str, String)> {
    let (number, time_s) = (scan.number, scan.time_s);
    if number == latest.number {
        Some((
            columns.time,
            "conflict",
            format!(
                "scan {number} is at {time_s} s here and at {} s before",
                latest.time_s
            ),
        ))
    } else if number < latest.number {
        Some((
            columns.scan,
            "unsorted",
            format!(
                "scan {number} comes after scan {}; scan numbers rise with time",
                latest.number
            ),
        ))
    } else if time_s == latest.time_s {
        Some((
            columns.time,
            "conflict",
            format!(
                "scans {} and {number} are both at {time_s} s",
                latest.number
            ),
        ))
    } else {
        None
    }
}
