//! The cells of a campaign held against the limits of its request.

use super::CampaignResult;
use crate::experiment::limits::{Limit, LimitsReport};

/// Holds the cells of a campaign against the limits.
pub(super) fn judge(limits: &[Limit], result: &CampaignResult) -> LimitsReport {
    let mut checks = Vec::new();
    for limit in limits {
        let is_meant = |name: &str| limit.cell.as_deref().is_none_or(|cell| cell == name);
        let first = checks.len();
        for cell in result.cells.iter().filter(|cell| is_meant(&cell.name)) {
            let summary = cell.outcomes.get(&limit.quantity);
            let (value, interval) =
                summary.map_or((None, None), |summary| (summary.mean, summary.interval));
            let limit = Limit {
                cell: Some(cell.name.clone()),
                ..limit.clone()
            };
            let reason = if summary.is_some() {
                "no run has a number for it".to_owned()
            } else {
                format!(
                    "no outcome has this name; there are {}",
                    result.outcomes.join(", ")
                )
            };
            checks.push(limit.check(value, interval, reason));
        }
        if checks.len() == first {
            let names: Vec<&str> = result.cells.iter().map(|cell| cell.name.as_str()).collect();
            let reason = format!("no cell has this name; there are {}", names.join("; "));
            checks.push(limit.check(None, None, reason));
        }
    }
    LimitsReport::of(checks)
}
