//! The API: one file a resource, and the layers that every answer goes through. Handlers read a request, call the
//! facade, and write an answer; they decide nothing else.

mod body;
mod catalogue;
mod compare;
pub(super) mod conditional;
pub mod dashboard;
mod datasets;
mod error;
mod extract;
mod headers;
mod hosts;
mod jobs;
mod layers;
mod problems;
mod query;
mod raw_upload;
mod session_acts;
mod session_picture;
mod sessions;
mod state;
mod streams;
mod system;
mod upload;

pub use conditional::Constant;
pub use hosts::Hosts;
pub use layers::wrap;
pub use raw_upload::{MAX_FILE_NAME, TEXTS, json_texts};
pub use state::{AppState, Documents};
pub use streams::Streams;
pub use upload::META;

use axum::Router;
use utoipa_axum::router::OpenApiRouter;

/// Every documented route.
pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .merge(jobs::routes())
        .merge(compare::routes())
        .merge(datasets::routes())
        .merge(sessions::routes())
        .merge(session_acts::routes())
        .merge(session_picture::routes())
        .merge(catalogue::routes())
        .merge(system::routes())
        .merge(problems::routes())
}

/// The whole application without its layers.
pub fn application(state: AppState) -> Router {
    let (api, _) = routes().split_for_parts();
    api.merge(system::documents())
        .fallback(system::dashboard_or_nothing)
        .with_state(state)
        .merge(system::docs_page())
}
