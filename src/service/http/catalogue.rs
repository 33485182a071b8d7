//! What can be asked for: methods with their parameters, request schemas, presets.

use super::conditional::Constant;
use super::query::{NoParams, names};
use super::state::AppState;
use crate::experiment::job_shape::with_kind;
use crate::experiment::{self, catalogue, presets};
use crate::registry::{Variant, standalone_schema};
use crate::service::http::error::{ApiError, ApiResult};
use crate::service::types::{JobKind, JobSpec};
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Serialize;
use serde_json::Value;
use std::sync::LazyLock;
use utoipa::ToSchema;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list_methods))
        .routes(routes!(get_method))
        .routes(routes!(list_presets))
        .routes(routes!(get_preset))
}

/// Everything that can be chosen.
#[derive(Serialize, ToSchema)]
struct MethodCatalogue {
    families: Vec<MethodFamily>,
    requests: RequestSchemas,
}

/// Methods that can stand in for each other.
#[derive(Serialize, ToSchema)]
struct MethodFamily {
    family: String,
    summary: String,
    methods: Vec<MethodEntry>,
}

#[derive(Serialize, ToSchema)]
struct MethodEntry {
    name: String,
    summary: String,
    parameters: JsonSchema,
}

/// The body of each kind of job.
#[derive(Serialize, ToSchema)]
struct RequestSchemas {
    simulate: JsonSchema,
    associate: JsonSchema,
    evaluate: JsonSchema,
    group: JsonSchema,
    correlate: JsonSchema,
    campaign: JsonSchema,
}

/// A JSON Schema (draft 2020-12) with titles, defaults, ranges and, as `x-unit`, units.
#[derive(Serialize, ToSchema)]
#[schema(value_type = Object)]
struct JsonSchema(Value);

/// A complete job body, ready to run or to change.
#[derive(Serialize, ToSchema)]
struct PresetInfo {
    name: String,
    summary: String,
    kind: JobKind,
    /// The job, with its kind.
    #[schema(value_type = JobSpec)]
    body: Value,
}

#[derive(Serialize, ToSchema)]
struct PresetList {
    items: Vec<PresetInfo>,
}

impl From<Variant> for MethodEntry {
    fn from(method: Variant) -> Self {
        MethodEntry {
            name: method.tag.to_owned(),
            summary: method.object.summary.to_owned(),
            parameters: JsonSchema(standalone_schema(method.object)),
        }
    }
}

impl From<presets::Preset> for PresetInfo {
    fn from(preset: presets::Preset) -> Self {
        let presets::Preset {
            name,
            summary,
            kind,
            body,
        } = preset;
        PresetInfo {
            name,
            summary,
            body: with_kind(kind, &body),
            kind,
        }
    }
}

/// List the methods
///
/// Families of exchangeable methods with the schema of their parameters, and the schemas of whole job bodies. Forms can
/// be made from them.
#[utoipa::path(get, path = "/v1/methods", operation_id = "listMethods", tag = "catalogue",
    responses((status = 200, description = "The catalogue.", body = MethodCatalogue)))]
async fn list_methods(_: NoParams, headers: HeaderMap) -> Response {
    static CATALOGUE: LazyLock<Constant> = LazyLock::new(|| Constant::new(&method_catalogue()));
    CATALOGUE.answer(&headers)
}

fn method_catalogue() -> MethodCatalogue {
    let family = |family: &catalogue::Family| MethodFamily {
        family: family.name.to_owned(),
        summary: family.summary().to_owned(),
        methods: family
            .methods()
            .into_iter()
            .map(MethodEntry::from)
            .collect(),
    };
    let schema = |kind| JsonSchema(standalone_schema(experiment::request_object(kind)));
    let requests = RequestSchemas {
        simulate: schema(JobKind::Simulate),
        associate: schema(JobKind::Associate),
        evaluate: schema(JobKind::Evaluate),
        group: schema(JobKind::Group),
        correlate: schema(JobKind::Correlate),
        campaign: schema(JobKind::Campaign),
    };
    MethodCatalogue {
        families: catalogue::FAMILIES.iter().map(family).collect(),
        requests,
    }
}

/// Get a method
///
/// Its parameters with defaults, ranges and units.
#[utoipa::path(get, path = "/v1/methods/{family}/{name}", operation_id = "getMethod", tag = "catalogue",
    params(
        ("family" = String, Path, description = "Such as `associator`."),
        ("name" = String, Path, description = "Such as `nearest_neighbour`."),
    ),
    responses((status = 200, description = "The method.", body = MethodEntry)))]
async fn get_method(
    Path((family, name)): Path<(String, String)>,
    _: NoParams,
    headers: HeaderMap,
) -> ApiResult {
    let known = catalogue::FAMILIES
        .iter()
        .find(|known| known.name == family);
    let family = known.ok_or_else(|| {
        nothing(
            "family",
            &family,
            names(catalogue::FAMILIES.iter().map(|family| family.name)),
        )
    })?;
    let methods = family.methods();
    let method = methods.iter().find(|method| method.tag == name).copied();
    let method = method.ok_or_else(|| {
        nothing(
            "method",
            &name,
            names(methods.iter().map(|method| method.tag)),
        )
    })?;
    Ok(Constant::new(&MethodEntry::from(method)).answer(&headers))
}

fn nothing(what: &str, name: &str, known: String) -> ApiError {
    ApiError::new(
        "not_found",
        format!("there is no {what} '{name}'; there are {known}"),
    )
}

/// List the presets
///
/// Complete job bodies.
#[utoipa::path(get, path = "/v1/presets", operation_id = "listPresets", tag = "catalogue",
    responses((status = 200, description = "The presets.", body = PresetList)))]
async fn list_presets(_: NoParams, headers: HeaderMap) -> Response {
    static PRESETS: LazyLock<Constant> = LazyLock::new(|| {
        Constant::new(&PresetList {
            items: presets::all().into_iter().map(PresetInfo::from).collect(),
        })
    });
    PRESETS.answer(&headers)
}

/// Get a preset
///
/// One complete job body.
#[utoipa::path(get, path = "/v1/presets/{name}", operation_id = "getPreset", tag = "catalogue",
    params(("name" = String, Path, description = "Such as `liang2009-100`.")),
    responses((status = 200, description = "The preset.", body = PresetInfo)))]
async fn get_preset(Path(name): Path<String>, _: NoParams, headers: HeaderMap) -> ApiResult {
    let known = || names(presets::all().iter().map(|preset| preset.name.as_str()));
    let preset = presets::find(&name).ok_or_else(|| nothing("preset", &name, known()))?;
    Ok(Constant::new(&PresetInfo::from(preset)).answer(&headers))
}
