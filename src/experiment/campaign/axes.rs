//! The axes of a campaign's grid, and the changes that their points make to the base.

use super::spec::{AxisSpec, Change, VariantSpec};
use crate::experiment::job::refuse_any;
use crate::model::fault::Fault;
use serde_json::Value;

/// One direction of the grid.
#[derive(Debug, Clone)]
pub struct Axis {
    pub name: String,
    pub points: Vec<VariantSpec>,
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

impl From<AxisSpec> for Axis {
    fn from(spec: AxisSpec) -> Self {
        match spec {
            AxisSpec::Variants { name, variants } => Axis {
                name,
                points: variants,
                has_one_path: false,
            },
            AxisSpec::Values { name, path, values } => {
                let point = |value: Value| VariantSpec {
                    name: text_of(&value),
                    set: vec![Change {
                        path: path.clone(),
                        value,
                    }],
                };
                Axis {
                    points: values.into_iter().map(point).collect(),
                    name: name.unwrap_or_else(|| path.clone()),
                    has_one_path: true,
                }
            }
        }
    }
}

fn text_of(value: &Value) -> String {
    let text = value.as_str().map(str::to_owned);
    text.unwrap_or_else(|| value.to_string())
}

/// Names tell axes and points apart.
pub fn check_names(axes: &[Axis]) -> Result<(), Vec<Fault>> {
    let names = axes.iter().map(|axis| axis.name.as_str());
    let mut faults = twice("/grid", &names.collect::<Vec<_>>());
    for (index, axis) in axes.iter().enumerate() {
        let names = axis.points.iter().map(|point| point.name.as_str());
        faults.extend(twice(&format!("/grid/{index}"), &names.collect::<Vec<_>>()));
    }
    refuse_any(faults)
}

fn twice(pointer: &str, names: &[&str]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (index, name) in names.iter().enumerate() {
        if names[..index].contains(name) {
            let detail = format!("'{name}' occurs twice");
            let fault = Fault::new(format!("{pointer}/{index}"), "duplicate", detail);
            faults.push(fault.allowing("each name once"));
        }
    }
    faults
}

/// A change that a cell makes to the base, and where the spec gives its path and its value.
pub struct Made<'a> {
    pub change: &'a Change,
    pub path_pointer: String,
    pub value_pointer: String,
}

pub fn changes_at<'a>(axes: &'a [Axis], points: &[usize]) -> Vec<Made<'a>> {
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
