//! Real processes: servers and workers that are killed, stopped and started again, on a file and on PostgreSQL.
mod access;
mod campaigns;
mod children;
mod command_line;
mod comparing;
mod database;
mod disk;
mod feed;
mod inspect;
mod job_files;
mod keys;
mod many;
mod postgres;
mod process;
mod sessions;
mod single;
