//! Where the request of a campaign has made a fault of one of its cells.

use super::axes::{Axis, Made, changes_at};
use super::cells::Cell;
use crate::experiment::job::Known;
use crate::model::fault::Fault;
use crate::registry::{Object, nearest_path};
use serde_json::Value;

pub const WHOLE_GRID: &str = "/grid";

/// Whether two faults are one to who reads them.
pub fn is_same(left: &Fault, right: &Fault) -> bool {
    (&left.pointer, &left.code) == (&right.pointer, &right.code)
}

/// A fault of a cell, and the path that no field has with the body that has none.
pub struct InvalidField {
    pub fault: Fault,
    pub unknown: Option<(String, Value)>,
}

impl InvalidField {
    /// The fault, with the known path that is nearest to the unknown one: looking for it takes a while, so once for each.
    pub fn into_fault(self, request: &'static Object) -> Fault {
        let nearest = |(path, body): (String, Value)| {
            nearest_path(&path, &body, request).filter(|nearest| *nearest != path)
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

/// A fault of a cell's body at the change that made it: at its path where the body has no such place, else in its value; at the grid
/// where it is in no change, such as what two of them contradict.
pub fn place(fault: Fault, name: &str, made: &[Made], body: &Value) -> InvalidField {
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
        return InvalidField {
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
    InvalidField {
        fault: Fault {
            pointer,
            detail,
            ..fault
        },
        unknown: None,
    }
}

/// The way from the place `outer` to `inner`, where that is the same or inside of it.
fn within<'a>(inner: &'a str, outer: &str) -> Option<&'a str> {
    inner
        .strip_prefix(outer)
        .filter(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// What is known of the data, held against every cell: each fault once, at the change that made it or else in the base.
pub fn check_known(cells: &[Cell], axes: &[Axis], known: &[Option<Known>]) -> Vec<Fault> {
    let mut faults: Vec<Fault> = Vec::new();
    for cell in cells {
        let made = changes_at(axes, &cell.points);
        let (job, inputs) = (&cell.plan.job, &cell.plan.inputs);
        for fault in job.check_known(inputs, known).faults {
            let in_base = Fault {
                pointer: format!("/base{}", fault.pointer),
                ..fault.clone()
            };
            let placed = place(fault, &cell.name, &made, &cell.plan.spec).fault;
            let fault = if placed.pointer == WHOLE_GRID {
                in_base
            } else {
                placed
            };
            if !faults.iter().any(|known| is_same(known, &fault)) {
                faults.push(fault);
            }
        }
    }
    faults
}
