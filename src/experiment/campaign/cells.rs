//! The cells of a campaign: the product of its axes, each with the job of its runs.

use super::axes::{Axis, Made, changes_at, check_names};
use super::placing::{InvalidField, WHOLE_GRID, is_same, place};
use super::spec::{Change, Spec};
use crate::experiment::job::{JobKind, Plan, Planner, refuse_any};
use crate::experiment::request::job_shape::remove_kind;
use crate::experiment::request::paths::{put_at, put_field, unknown_path};
use crate::experiment::request::preset_source;
use crate::model::fault::Fault;
use crate::registry::placed;
use serde::Deserialize;
use serde_json::{Map, Value};

/// Cells of one campaign.
const MAX_CELLS: u128 = 2000;

/// One combination of points.
#[derive(Debug, Clone)]
pub struct Cell {
    /// The names of its points, divided by commas; `all` where there is no axis.
    pub name: String,
    /// Its point on each axis.
    pub points: Vec<usize>,
    pub plan: Plan,
}

impl Cell {
    /// Name of the point on each axis.
    pub fn parameters(&self, axes: &[Axis]) -> Map<String, Value> {
        let named = |(axis, &point): (&Axis, &usize)| {
            (
                axis.name.clone(),
                Value::String(axis.points[point].name.clone()),
            )
        };
        axes.iter().zip(&self.points).map(named).collect()
    }
}

/// Every cell, the last axis running fastest.
///
/// # Errors
/// Every fault: of the base alone where it has any, else of the grid, with the cell that has it.
pub fn cells_of(spec: &Spec, axes: &[Axis], planner: Planner) -> Result<Vec<Cell>, Vec<Fault>> {
    let (kind, base) = base_of(&spec.base)?;
    let request = (planner.request)(kind);
    // Paths of the grid reach into what a preset brings; an unknown preset is a fault of the base below.
    let mut body = preset_source::with_settings(request, &base).into_owned();
    preset_source::write_out(&mut body, &mut Vec::new());
    let count: u128 = axes.iter().map(|axis| axis.points.len() as u128).product();
    if count > MAX_CELLS {
        let fault = Fault::new("/grid", "too_large", format!("the grid has {count} cells"));
        return Err(vec![fault.allowing(format!("at most {MAX_CELLS} cells"))]);
    }
    check_names(axes)?;
    (planner.plan)(kind, &body).map_err(|faults| placed("/base", faults))?;
    let (mut cells, mut faults) = (Vec::new(), Vec::new());
    let base = Base {
        kind,
        body: &body,
        seed: spec.seed,
    };
    for number in 0..count as usize {
        match base.cell(axes, number, planner) {
            Ok(cell) => cells.push(cell),
            Err(found) => {
                for invalid in found {
                    // Every cell at a point has the faults of the point.
                    let is_new = !faults.iter().any(|known| is_same(known, &invalid.fault));
                    if invalid.fault.pointer == WHOLE_GRID || is_new {
                        faults.push(invalid.into_fault(request));
                    }
                }
            }
        }
        if faults.len() >= 100 {
            break;
        }
    }
    refuse_any(faults)?;
    Ok(cells)
}

/// Every fault of the base, whatever the grid makes of it.
pub fn faults_of_base(base: &Value, planner: Planner) -> Vec<Fault> {
    let planned = base_of(base).and_then(|(kind, body)| {
        let planned = (planner.plan)(kind, &body);
        planned.map_err(|faults| placed("/base", faults))
    });
    planned.err().unwrap_or_default()
}

/// Kind and body of the base.
fn base_of(base: &Value) -> Result<(JobKind, Value), Vec<Fault>> {
    let mut body = base.clone();
    if !body.is_object() {
        let detail = "the base is the body of a job, an object";
        return Err(vec![
            Fault::new("/base", "wrong_type", detail).allowing("an object"),
        ]);
    }
    let Some(name) = remove_kind(&mut body) else {
        let fault = Fault::new("/base/kind", "missing", "'kind' is required");
        return Err(vec![fault.allowing(kinds_of_bases())]);
    };
    match JobKind::deserialize(&name) {
        Ok(kind) if kind != JobKind::Campaign => Ok((kind, body)),
        _ => {
            let detail = format!("a campaign has no runs of kind {name}");
            let fault = Fault::new("/base/kind", "unknown_value", detail);
            Err(vec![fault.allowing(kinds_of_bases())])
        }
    }
}

fn kinds_of_bases() -> String {
    let kinds = JobKind::ALL.into_iter();
    let bases = kinds.filter(|kind| *kind != JobKind::Campaign);
    bases.map(JobKind::name).collect::<Vec<_>>().join(", ")
}

/// What all cells are changes of.
struct Base<'a> {
    kind: JobKind,
    body: &'a Value,
    seed: u32,
}

impl Base<'_> {
    fn cell(
        &self,
        axes: &[Axis],
        number: usize,
        planner: Planner,
    ) -> Result<Cell, Vec<InvalidField>> {
        let points = points_at(axes, number);
        let name = name_of(axes, &points);
        let made = changes_at(axes, &points);
        let mut body = self.body.clone();
        for Made {
            change,
            path_pointer,
            ..
        } in &made
        {
            put_change(&mut body, change).map_err(|fault| {
                let detail = format!("cell '{name}': {}: {}", change.path, fault.detail);
                let fault = Fault {
                    pointer: path_pointer.clone(),
                    detail,
                    ..*fault
                };
                let unknown = Some((change.path.clone(), self.body.clone()));
                vec![InvalidField { fault, unknown }]
            })?;
        }
        put_field(&mut body, "seed", self.seed.into());
        let plan = (planner.plan)(self.kind, &body).map_err(|faults| {
            let placed = |fault: Fault| place(fault, &name, &made, &body);
            faults.into_iter().map(placed).collect::<Vec<_>>()
        })?;
        Ok(Cell { name, points, plan })
    }
}

/// The point on each axis of a cell, the last axis running fastest.
fn points_at(axes: &[Axis], number: usize) -> Vec<usize> {
    let mut points = vec![0; axes.len()];
    let mut rest = number;
    for (point, axis) in points.iter_mut().zip(axes).rev() {
        *point = rest % axis.points.len();
        rest /= axis.points.len();
    }
    points
}

fn name_of(axes: &[Axis], points: &[usize]) -> String {
    if axes.is_empty() {
        return "all".to_owned();
    }
    let names = axes
        .iter()
        .zip(points)
        .map(|(axis, &point)| axis.points[point].name.as_str());
    names.collect::<Vec<_>>().join(", ")
}

fn put_change(body: &mut Value, change: &Change) -> Result<(), Box<Fault>> {
    if change.path == "/seed" {
        let detail = "every cell has the seed of the campaign".to_owned();
        let allowed = "'runs' for more scenes, or 'seed' of the campaign for others".to_owned();
        return Err(unknown_path(&change.path, detail, allowed));
    }
    put_at(body, &change.path, &change.value)
}
