//! Real processes: servers and workers that are killed, stopped and started again, on a file and on PostgreSQL.
mod campaigns;
mod database;
mod disk;
mod many;
mod postgres;
mod process;
mod single;
