//! The cells of a campaign: the product of its axes, each with the job body of its runs.

use crate::experiment::catalogue::request_object;
use crate::experiment::input::known::{self as known_data, Known};
use crate::experiment::plan::{JobKind, Plan, plan};
use crate::experiment::request::preset_source;
use crate::model::fault::Fault;
use crate::registry::nearest_path;
use serde::Deserialize;
use serde_json::{Map, Value};

/// Cells of one campaign.
const MAX_CELLS: u128 = 2000;

const WHOLE_GRID: &str = "/grid";

#[derive(Debug, Clone, Deserialize)]
struct Change {
    path: String,
    value: Value,
}

#[derive(Debug, Clone, Deserialize)]
struct Variant {
    name: String,
    set: Vec<Change>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
enum Wire {
    Values {
        name: Option<String>,
        path: String,
        values: Vec<Value>,
    },
    Variants {
        name: String,
        variants: Vec<Variant>,
    },
}

/// One direction of the grid.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub name: String,
    points: Vec<Variant>,
    /// Whether the spec gives one path for all points.
    has_one_path: bool,
}

impl Axis {
    pub fn point_named(&self, name: &str) -> Option<usize> {
        self.points.iter().position(|point| point.name == name)
    }

    /// Where the spec gives the path and the value of a change of a point.
    fn pointers(&self, point: usize, change: usize) -> (String, String) {
        if self.has_one_path {
            ("/path".to_owned(), format!("/values/{point}"))
        } else {
            (
                format!("/variants/{point}/set/{change}/path"),
                format!("/variants/{point}/set/{change}/value"),
            )
        }
    }

    pub fn point_names(&self) -> String {
        self.points
            .iter()
            .map(|point| point.name.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// One combination of points.
#[derive(Debug, Clone)]
pub(super) struct Cell {
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

/// The axes of a checked grid.
pub(super) fn axes_of(spec: &Value) -> Vec<Axis> {
    let axis = |wire: Wire| match wire {
        Wire::Variants { name, variants } => Axis {
            name,
            points: variants,
            has_one_path: false,
        },
        Wire::Values { name, path, values } => {
            let point = |value: Value| Variant {
                name: text_of(&value),
                set: vec![Change {
                    path: path.clone(),
                    value,
                }],
            };
            let points = values.into_iter().map(point).collect();
            Axis {
                name: name.unwrap_or_else(|| path.clone()),
                points,
                has_one_path: true,
            }
        }
    };
    let wires = spec["grid"].as_array().into_iter().flatten();
    wires
        .filter_map(|wire| Wire::deserialize(wire).ok())
        .map(axis)
        .collect()
}

fn text_of(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// Every cell, the last axis running fastest.
///
/// # Errors
/// Every fault: of the base alone where it has any, else of the grid, with the cell that has it.
pub(super) fn cells_of(spec: &Value, axes: &[Axis]) -> Result<Vec<Cell>, Vec<Fault>> {
    let (kind, base) = base_of(spec)?;
    // Paths of the grid reach into what a preset brings; an unknown preset is a fault of the base below.
    let mut body = preset_source::with_settings(kind, &base).into_owned();
    preset_source::write_out(&mut body, &mut Vec::new());
    let count: u128 = axes.iter().map(|axis| axis.points.len() as u128).product();
    if count > MAX_CELLS {
        let fault = Fault::new("/grid", "too_large", format!("the grid has {count} cells"));
        return Err(vec![fault.allowing(format!("at most {MAX_CELLS} cells"))]);
    }
    check_names(axes)?;
    plan(kind, &body).map_err(in_base)?;
    let (mut cells, mut faults) = (Vec::new(), Vec::new());
    for number in 0..count as usize {
        match cell(kind, &body, axes, number, &spec["seed"]) {
            Ok(cell) => cells.push(cell),
            // Every cell at a point has the faults of the point.
            Err(found) => found.into_iter().for_each(|misfit| {
                let is_known = |known: &Fault| {
                    (&known.pointer, &known.code) == (&misfit.fault.pointer, &misfit.fault.code)
                };
                if misfit.fault.pointer == WHOLE_GRID || !faults.iter().any(is_known) {
                    faults.push(misfit.told(kind));
                }
            }),
        }
        if faults.len() >= 100 {
            break;
        }
    }
    if faults.is_empty() {
        Ok(cells)
    } else {
        Err(faults)
    }
}

/// Every fault of the base, whatever the grid makes of it.
pub(super) fn faults_of_base(spec: &Value) -> Vec<Fault> {
    let found = base_of(spec).and_then(|(kind, body)| plan(kind, &body).map_err(in_base));
    // What the table says of a base that is missing, it has said.
    found
        .err()
        .filter(|_| spec.get("base").is_some())
        .unwrap_or_default()
}

fn in_base(faults: Vec<Fault>) -> Vec<Fault> {
    faults
        .into_iter()
        .map(|fault| Fault {
            pointer: format!("/base{}", fault.pointer),
            ..fault
        })
        .collect()
}

/// Names tell axes and points apart.
fn check_names(axes: &[Axis]) -> Result<(), Vec<Fault>> {
    let mut faults = Vec::new();
    let mut twice = |pointer: String, names: Vec<&str>| {
        for (index, name) in names.iter().enumerate() {
            if names[..index].contains(name) {
                faults.push(
                    Fault::new(
                        format!("{pointer}/{index}"),
                        "duplicate",
                        format!("'{name}' occurs twice"),
                    )
                    .allowing("each name once"),
                );
            }
        }
    };
    twice(
        "/grid".to_owned(),
        axes.iter().map(|axis| axis.name.as_str()).collect(),
    );
    for (index, axis) in axes.iter().enumerate() {
        twice(
            format!("/grid/{index}"),
            axis.points
                .iter()
                .map(|point| point.name.as_str())
                .collect(),
        );
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(faults)
    }
}

/// Kind and body of the base.
fn base_of(spec: &Value) -> Result<(JobKind, Value), Vec<Fault>> {
    let kinds = || {
        let is_base = |kind: &JobKind| *kind != JobKind::Campaign;
        JobKind::ALL
            .into_iter()
            .filter(is_base)
            .map(JobKind::name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut body = spec["base"].clone();
    let Some(fields) = body.as_object_mut() else {
        return Err(vec![
            Fault::new(
                "/base",
                "wrong_type",
                "the base is the body of a job, an object",
            )
            .allowing("an object"),
        ]);
    };
    let Some(name) = fields.shift_remove("kind") else {
        return Err(vec![
            Fault::new("/base/kind", "missing", "'kind' is required").allowing(kinds()),
        ]);
    };
    match JobKind::deserialize(&name) {
        Ok(kind) if kind != JobKind::Campaign => Ok((kind, body)),
        _ => Err(vec![
            Fault::new(
                "/base/kind",
                "unknown_value",
                format!("a campaign has no runs of kind {name}"),
            )
            .allowing(kinds()),
        ]),
    }
}

/// What is known of the data, held against every cell: each fault once, at the change that made it or else in the base.
pub(super) fn check_known(cells: &[Cell], axes: &[Axis], known: &[Option<Known>]) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for cell in cells {
        let made = changes_at(axes, &cell.points);
        for fault in known_data::faults_of(&cell.plan, known) {
            let in_base = Fault {
                pointer: format!("/base{}", fault.pointer),
                ..fault.clone()
            };
            let placed = placed(fault, &cell.name, &made, &cell.plan.spec).fault;
            let fault = if placed.pointer == WHOLE_GRID {
                in_base
            } else {
                placed
            };
            if !faults
                .iter()
                .any(|known| (&known.pointer, &known.code) == (&fault.pointer, &fault.code))
            {
                faults.push(fault);
            }
        }
    }
    faults
}

/// A change that a cell makes to the base, and where the spec gives its path and its value.
struct Made<'a> {
    change: &'a Change,
    path_pointer: String,
    value_pointer: String,
}

fn changes_at<'a>(axes: &'a [Axis], points: &[usize]) -> Vec<Made<'a>> {
    let mut made = Vec::new();
    for (number, (axis, &point)) in axes.iter().zip(points).enumerate() {
        made.extend(
            axis.points[point]
                .set
                .iter()
                .enumerate()
                .map(|(index, change)| {
                    let (path, value) = axis.pointers(point, index);
                    Made {
                        change,
                        path_pointer: format!("/grid/{number}{path}"),
                        value_pointer: format!("/grid/{number}{value}"),
                    }
                }),
        );
    }
    made
}

/// The way from the place `outer` to `inner`, where that is the same or inside of it.
fn within<'a>(inner: &'a str, outer: &str) -> Option<&'a str> {
    inner
        .strip_prefix(outer)
        .filter(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// A fault of a cell, and the path that no field has with the body that has none.
struct Misfit {
    fault: Fault,
    unknown: Option<(String, Value)>,
}

impl Misfit {
    /// The fault, with the known path that is nearest to the unknown one: looking for it takes a while, so once for each.
    fn told(self, kind: JobKind) -> Fault {
        let nearest = |(path, body): (String, Value)| {
            nearest_path(&path, &body, request_object(kind)).filter(|nearest| *nearest != path)
        };
        let hint = self
            .unknown
            .and_then(nearest)
            .map_or_else(String::new, |nearest| {
                format!("; the nearest path is '{nearest}'")
            });
        Fault {
            detail: self.fault.detail + &hint,
            ..self.fault
        }
    }
}

fn cell(
    kind: JobKind,
    base: &Value,
    axes: &[Axis],
    number: usize,
    seed: &Value,
) -> Result<Cell, Vec<Misfit>> {
    let mut points = vec![0; axes.len()];
    let mut rest = number;
    for (point, axis) in points.iter_mut().zip(axes).rev() {
        *point = rest % axis.points.len();
        rest /= axis.points.len();
    }
    let chosen = || {
        axes.iter()
            .zip(&points)
            .map(|(axis, &point)| &axis.points[point])
    };
    let name = match axes {
        [] => "all".to_owned(),
        _ => chosen()
            .map(|point| point.name.as_str())
            .collect::<Vec<_>>()
            .join(", "),
    };
    let made = changes_at(axes, &points);
    let mut body = base.clone();
    for Made {
        change,
        path_pointer,
        ..
    } in &made
    {
        let unknown = |fault: Box<Fault>| {
            let detail = format!("cell '{name}': {}: {}", change.path, fault.detail);
            let fault = Fault {
                pointer: path_pointer.clone(),
                detail,
                ..*fault
            };
            vec![Misfit {
                fault,
                unknown: Some((change.path.clone(), base.clone())),
            }]
        };
        set(&mut body, &change.path, &change.value).map_err(unknown)?;
    }
    body["seed"] = seed.clone();
    let placed = |fault: Fault| placed(fault, &name, &made, &body);
    let plan =
        plan(kind, &body).map_err(|faults| faults.into_iter().map(placed).collect::<Vec<_>>())?;
    Ok(Cell {
        name,
        points,
        plan: Plan {
            wants_files: false,
            ..plan
        },
    })
}

/// A fault of a cell's body at the change that made it: at its path where the body has no such place, else in its value; at the grid
/// where it is in no change, such as what two of them contradict.
fn placed(fault: Fault, name: &str, made: &[Made], body: &Value) -> Misfit {
    let detail = format!("cell '{name}': {}: {}", fault.pointer, fault.detail);
    let is_unknown = |made: &&Made| {
        fault.code == "unknown_field" && within(&made.change.path, &fault.pointer).is_some()
    };
    if let Some(made) = made.iter().rev().find(is_unknown) {
        let fault = Fault {
            pointer: made.path_pointer.clone(),
            detail,
            ..fault
        };
        return Misfit {
            fault,
            unknown: Some((made.change.path.clone(), body.clone())),
        };
    }
    let in_value = |made: &Made| {
        within(&fault.pointer, &made.change.path)
            .map(|rest| format!("{}{rest}", made.value_pointer))
    };
    let pointer = made
        .iter()
        .rev()
        .find_map(in_value)
        .unwrap_or_else(|| WHOLE_GRID.to_owned());
    Misfit {
        fault: Fault {
            pointer,
            detail,
            ..fault
        },
        unknown: None,
    }
}

/// Puts a value at a JSON pointer; objects on the way that are absent are made, for a field may have been left to its default.
fn set(body: &mut Value, path: &str, value: &Value) -> Result<(), Box<Fault>> {
    let fault = |detail: String, allowed: String| {
        Box::new(Fault::new(path, "unknown_path", detail).allowing(allowed))
    };
    if path == "/seed" {
        let allowed = "'runs' for more scenes, or 'seed' of the campaign for others".to_owned();
        return Err(fault(
            "every cell has the seed of the campaign".to_owned(),
            allowed,
        ));
    }
    let Some(steps) = path.strip_prefix('/') else {
        return Err(fault(
            "a path begins with '/'".to_owned(),
            "a JSON pointer such as /associator".to_owned(),
        ));
    };
    let mut place = body;
    for step in steps
        .split('/')
        .map(|step| step.replace("~1", "/").replace("~0", "~"))
    {
        place = match place {
            Value::Object(fields) => fields
                .entry(step)
                .or_insert_with(|| Value::Object(Map::new())),
            Value::Array(items) => {
                let allowed = format!("an index below {}", items.len());
                let item = step
                    .parse::<usize>()
                    .ok()
                    .and_then(|index| items.get_mut(index));
                item.ok_or_else(|| fault(format!("there is no item '{step}'"), allowed))?
            }
            _ => {
                return Err(fault(
                    format!("'{step}' is inside of a plain value"),
                    "a path to a field of the base".to_owned(),
                ));
            }
        };
    }
    *place = value.clone();
    Ok(())
}
