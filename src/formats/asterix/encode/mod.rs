//! Writes ASTERIX: tracks as category 062, and of what a radar or a receiver of ADS-B says as much as examples need.
//!
//! Values are rounded to the steps of their items. An item whose value is beyond its range, or no number, is left out.

mod adsb;
mod radar;
mod record;
mod tracks;

pub use adsb::{AdsbRecord, encode_adsb};
pub use radar::{
    MarkRecord, PlotRecord, encode_marks, encode_marks_002, encode_plots, encode_plots_001,
};
pub use tracks::{TrackRecord, encode_tracks};
