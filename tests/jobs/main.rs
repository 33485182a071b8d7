//! Jobs and datasets through their facade: real tables, real queue, real runs, in a directory of their own.

mod datasets;
mod life;
mod lists;
mod recovery;
mod support;
