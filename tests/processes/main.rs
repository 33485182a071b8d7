//! Real processes: servers and workers that are killed, stopped and started again, on a file and on PostgreSQL.
mod campaigns;
mod children;
mod command_line;
mod database;
mod many;
mod postgres;
mod process;
mod single;
