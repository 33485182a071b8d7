//! Gates: which detections a track may be given at all.

pub mod ellipsoidal;
pub mod grid;
