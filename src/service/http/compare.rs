//! Jobs side by side.

use super::query::Params;
use super::state::AppState;
use crate::service::http::error::ApiResult;
use crate::service::types::Comparison;
use axum::Json;
use axum::extract::State;
use axum::response::IntoResponse;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use uuid::Uuid;

const JOBS: std::ops::RangeInclusive<usize> = 2..=20;
const CONFIDENCE: f64 = 0.95;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(compare_jobs))
}

/// Compare jobs
///
/// The numbers of 2 to 20 jobs that succeeded, side by side; differences to the baseline, pair by pair; where their requests differ.
#[utoipa::path(get, path = "/v1/compare", operation_id = "compareJobs", tag = "results",
    params(
        ("job" = Vec<uuid::Uuid>, Query, min_items = 2, max_items = 20, description = "Identity of a job; repeated, each once."),
        ("baseline" = Option<uuid::Uuid>, Query, description = "The job that the others are compared with; the first when absent."),
        ("confidence" = Option<f64>, Query, exclusive_minimum = 0, exclusive_maximum = 1, description = "Of the intervals, above 0 and below 1; 0.95 when absent."),
    ),
    responses((status = 200, description = "The comparison.", body = Comparison)))]
async fn compare_jobs(State(app): State<AppState>, mut params: Params) -> ApiResult {
    let (jobs, baseline, confidence) = read(&mut params);
    params.finish()?;
    Ok(Json(app.jobs.compare(&jobs, baseline, confidence).await?).into_response())
}

/// The jobs, the place of the baseline among them, and the confidence.
fn read(params: &mut Params) -> (Vec<Uuid>, usize, f64) {
    let texts = params.all("job");
    let jobs: Vec<Uuid> = texts
        .iter()
        .filter_map(|text| Uuid::try_parse(text).ok())
        .collect();
    for text in texts.iter().filter(|text| Uuid::try_parse(text).is_err()) {
        params.fault(
            "job",
            "unknown_value",
            &format!("'{text}' is not the id of a job"),
            "ids of jobs",
        );
    }
    if jobs.len() < texts.len() {
        // Told already, one by one.
    } else if !JOBS.contains(&jobs.len()) {
        params.fault(
            "job",
            "out_of_range",
            &format!("{} jobs are named", jobs.len()),
            "2 to 20 jobs",
        );
    } else if jobs
        .iter()
        .enumerate()
        .any(|(index, job)| jobs[..index].contains(job))
    {
        params.fault(
            "job",
            "duplicate",
            "a job is named more than once",
            "each job once",
        );
    }
    let baseline = params.read("baseline", "one of the jobs", |text| {
        let id = Uuid::try_parse(text).ok()?;
        jobs.iter().position(|job| *job == id)
    });
    let allowed = "above 0, below 1";
    let confidence = params.read("confidence", allowed, |text| {
        text.parse()
            .ok()
            .filter(|share: &f64| *share > 0.0 && *share < 1.0)
    });
    (
        jobs,
        baseline.unwrap_or(0),
        confidence.unwrap_or(CONFIDENCE),
    )
}
