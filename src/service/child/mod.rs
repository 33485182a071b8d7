//! Work in processes of their own. The same binary is started again as a *child*, which computes and does nothing else: it reads the files
//! that it is named, writes temporary ones, and tells how far it is. It opens no database, no store and no network, and limits its own memory.
//!
//! - `protocol`: what the two say to each other, over the child's standard input and output.
//! - `inside`: what happens in a child; `work` is what it can do, `campaign` that of campaigns.
//! - `process`: one child, seen from outside; `host` keeps the children that are ready.
//! - `meter` and `report`: how far a job is, and what it leaves.
//! - `desk`: work that somebody waits for.
//! - `limit`: how much memory one may have, and how it dies with whoever started it.

mod campaign;
mod desk;
mod failure;
mod host;
mod input;
mod inside;
mod limit;
pub(in crate::service) mod meter;
mod process;
mod protocol;
pub(in crate::service) mod report;
mod work;

pub(in crate::service) use desk::{
    Desk, all_of, crash_text, failure_of, memory_text, result_of, unexpected,
};
pub(in crate::service) use failure::Failure;
pub use host::Children;
pub use input::{FileContent, InputFile};
pub use inside::run;
pub use limit::{IS_LIMITED, SMALLEST_BYTES, default_memory, size_text};
pub use process::{Death, Heard};
pub use protocol::{CampaignOrder, Checked, Looked, Made, MadeFile, Order, Runs, Upload};
