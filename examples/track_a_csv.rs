//! Tracks the positions of a CSV file (time_s, sensor_id, x_m, y_m; noise of 10 m, aircraft) and prints track, time and state:
//! `cargo run --release -p trackloom-domain --example track_a_csv -- DETECTIONS.csv`.

use std::{error::Error, fs::File, io::BufReader};
use trackloom_domain::association::global_nearest_neighbour::GlobalNearestNeighbour;
use trackloom_domain::filtering::AnyFilter;
use trackloom_domain::formats::{ReadOptions, csv};
use trackloom_domain::model::{dataset::Dataset, sensor::Sensor, watch::Watch};
use trackloom_domain::tracking::{History, Lifecycle, TRACKERS, TrackerParts};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which file?")?;
    let mut file = BufReader::new(File::open(path)?);
    let read = csv::read(&mut file, &ReadOptions::default()).map_err(|faults| faults[0].clone())?;
    let Dataset::Detections(recording) = read.dataset else {
        return Err("the file holds no detections".into());
    };
    let sensor = |known: &_| Sensor::of_positions(known, 10.0);
    let mut tracker = (TRACKERS[0].build)(TrackerParts {
        filter: AnyFilter::kalman(1.0),
        associator: Box::new(GlobalNearestNeighbour::default()),
        lifecycle: Lifecycle {
            initial_speed_sigma_mps: 300.0,
            ..Lifecycle::default()
        },
        sensors: recording.sensors.iter().map(sensor).collect(),
        undetected: None,
        given: Vec::new(),
    });
    let mut history = History::default();
    for scan in &recording.scans {
        tracker.step(scan, &mut history, &Watch::never())?;
    }
    for track in history.into_tracks(&recording).tracks {
        for point in &track.points {
            let (id, time_s, state) = (&track.track_id, point.time_s, point.estimate.state());
            println!("{id}\t{time_s}\t{:?}", state.as_slice());
        }
    }
    Ok(())
}
