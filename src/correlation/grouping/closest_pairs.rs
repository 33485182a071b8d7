//! Reports to groups by distance: each to its nearest, or, where a group takes one report of a sensor, the closest pair of
//! all first.

/// For each of `reports` one of `groups` within the gate, or none. `squared_distance(report, group)`; of equal distances the
/// earlier group, then the earlier report, goes first.
pub(super) fn choose(
    reports: std::ops::Range<usize>,
    groups: usize,
    gate: f64,
    one_per_group: bool,
    squared_distance: impl Fn(usize, usize) -> f64,
) -> Vec<Option<usize>> {
    if !one_per_group {
        return reports
            .map(|report| nearest(groups, gate, |group| squared_distance(report, group)))
            .collect();
    }
    let first = reports.start;
    let mut chosen = vec![None; reports.len()];
    let mut pairs: Vec<(f64, usize, usize)> = reports
        .flat_map(|report| (0..groups).map(move |group| (group, report)))
        .map(|(group, report)| (squared_distance(report, group), group, report))
        .filter(|pair| pair.0 <= gate)
        .collect();
    pairs.sort_by(|left, right| {
        left.0
            .total_cmp(&right.0)
            .then((left.1, left.2).cmp(&(right.1, right.2)))
    });
    let mut is_taken = vec![false; groups];
    for (_, group, report) in pairs {
        if !is_taken[group] && chosen[report - first].is_none() {
            is_taken[group] = true;
            chosen[report - first] = Some(group);
        }
    }
    chosen
}

fn nearest(groups: usize, gate: f64, squared_distance: impl Fn(usize) -> f64) -> Option<usize> {
    let distances = (0..groups)
        .map(|group| (squared_distance(group), group))
        .filter(|pair| pair.0 <= gate);
    distances
        .min_by(|left, right| left.0.total_cmp(&right.0))
        .map(|pair| pair.1)
}

/// The squared distance of a gate of `sigmas`; infinite without a gate.
pub(super) fn gate(sigmas: Option<f64>) -> f64 {
    sigmas.map_or(f64::INFINITY, |sigmas| sigmas * sigmas)
}
