//! Formats of what sensors and receivers send: each is a decoder of its own and one entry here; what becomes of its reports is
//! decided once, in [`super::feed`].

use super::asterix::{self, Decoded};
use super::feed::Manner;
use super::{Format, ReadOptions, ReadOutcome, Reading, TABLES, ais, gpx, mode_s, refuse_columns};
use crate::model::fault::Fault;
use crate::model::time::TimeBase;
use std::io::BufRead;

pub const AIS: Format = Format {
    name: "ais",
    summary: "AIS as NMEA 0183 sentences (AIVDM, AIVDO), with or without tag blocks or times behind them",
    media_type: "text/plain",
    kinds: TABLES,
    options: &[],
    read: read_ais,
};

pub const MODE_S: Format = Format {
    name: "mode_s",
    summary: "Mode S and ADS-B as raw frames (Beast, AVR, rs1090) or as BaseStation lines (SBS)",
    media_type: "application/octet-stream",
    kinds: TABLES,
    options: &[],
    read: read_mode_s,
};

pub const GPX: Format = Format {
    name: "gpx",
    summary: "Tracks of GPS receivers (GPX 1.0 and 1.1)",
    media_type: "application/gpx+xml",
    kinds: TABLES,
    options: &[],
    read: read_gpx,
};

pub const ASTERIX: Format = Format {
    name: "asterix",
    summary: "ASTERIX blocks as they are or in pcap, pcapng, ORADIS, final, RFF and GPS recordings: categories 001, 002, 020, 021, 034, 048, 062, 065",
    media_type: "application/octet-stream",
    kinds: TABLES,
    options: &[],
    read: read_asterix,
};

/// Share of what comes by a network that may be wrong.
const NETWORK: f64 = 0.01;

fn read_ais(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let reading = Reading::of(&options.options)?;
    let told = ais::Told {
        start_s: reading.start_s().ok().flatten(),
        utc_offset_s: reading.utc_offset_s,
    };
    ais::decode(input, &told)?.finish(TimeBase::Utc, &Manner::SHIPS, options)
}

fn read_mode_s(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let reading = Reading::of(&options.options)?;
    let told = mode_s::Told {
        start_s: reading.start_s().ok().flatten(),
        receiver: reading.receiver.map(|frame| mode_s::Receiver {
            lat_deg: frame.latitude_deg(),
            lon_deg: frame.longitude_deg(),
        }),
        utc_offset_s: reading.utc_offset_s,
        ..mode_s::Told::default()
    };
    mode_s::decode(input, &told)?.finish(TimeBase::Utc, &Manner::AIRCRAFT, options)
}

fn read_gpx(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let reading = Reading::of(&options.options)?;
    let told = gpx::Told {
        utc_offset_s: reading.utc_offset_s,
    };
    let manner = Manner {
        max_rejected: NETWORK,
        splits_by_callsign: false,
        ..Manner::AIRCRAFT
    };
    gpx::decode(input, &told)?.finish(TimeBase::Utc, &manner, options)
}

fn read_asterix(input: &mut dyn BufRead, options: &ReadOptions) -> Result<ReadOutcome, Vec<Fault>> {
    refuse_columns(options)?;
    let reading = Reading::of(&options.options)?;
    let told = asterix::Told {
        kind: options.kind,
        day_s: reading.day_s().ok().flatten(),
        with_test_targets: reading.test_targets,
        editions: reading.editions,
    };
    let decoded = asterix::decode(input, &told)?;
    let manner = Manner {
        kind: decoded.kind,
        max_rejected: NETWORK,
        splits_by_callsign: false,
        ..Manner::AIRCRAFT
    };
    let others = others_held(&decoded);
    let mut read = decoded.feed.finish(decoded.time_base, &manner, options)?;
    read.warnings.extend(others);
    Ok(read)
}

/// What a file holds besides the kind that is read.
fn others_held(decoded: &Decoded) -> Option<String> {
    let others = decoded
        .held
        .iter()
        .filter(|(kind, _)| **kind != decoded.kind);
    let list: Vec<String> = others
        .filter(|(_, count)| **count > 0)
        .map(|(kind, count)| format!("{count} records of {}", kind.name()))
        .collect();
    (!list.is_empty()).then(|| {
        format!(
            "the file is read as {}; it holds {}, too, which `kind` reads",
            decoded.kind.name(),
            list.join(" and ")
        )
    })
}
