//! The files that a job leaves behind, and tables for people.

pub mod datasets;
pub mod record_picture;
pub mod tables;
pub mod text;
