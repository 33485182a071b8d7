//! Jobs: ask for them, watch them, change them, read what they found.

mod create;
mod events;
mod life;
mod list;
mod pictures;
mod results;

use super::state::AppState;
use utoipa_axum::router::OpenApiRouter;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .merge(create::routes())
        .merge(list::routes())
        .merge(life::routes())
        .merge(events::routes())
        .merge(results::routes())
        .merge(pictures::routes())
}
