//! The API: one file a resource, and the layers that every answer goes through. Handlers read a request, call the
//! facade, and write an answer; they decide nothing else.

mod body;
mod catalogue;
mod compare;
pub(super) mod conditional;
pub mod dashboard;
mod datasets;
mod door;
mod error;
mod extract;
mod headers;
mod hosts;
mod jobs;
mod keys;
mod layers;
mod origins;
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
pub use door::{COOKIE, needs};
pub use hosts::Hosts;
pub use keys::LOGIN;
pub use layers::wrap;
pub use raw_upload::{MAX_FILE_NAME, TEXTS, json_texts};
pub use state::{AppState, Documents};
pub use streams::Streams;
pub use upload::META;

use axum::Router;
use axum::middleware::from_fn_with_state;
use door::{Door, ask};
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
        .merge(keys::routes())
        .merge(system::routes())
        .merge(problems::routes())
}

/// The whole application without its outer layers.
pub fn application(state: AppState) -> Router {
    let (api, _) = routes().split_for_parts();
    let door = Door::new(state.keys.clone());
    api.merge(system::documents())
        .fallback(system::dashboard_or_nothing)
        .with_state(state)
        .merge(system::docs_page())
        .layer(from_fn_with_state(door, ask))
}
