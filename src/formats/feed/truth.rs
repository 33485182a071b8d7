//! Reports as truth: each path of an identity is a target.

use super::codes::Codes;
use super::place::{Ground, Unplaced};
use super::{Feed, Manner, note, path_name, paths};
use crate::formats::Reading;
use crate::model::attributes::Attributes;
use crate::model::dataset::Dataset;
use crate::model::fault::Fault;
use crate::model::names::natural_order;
use crate::model::space::Space;
use crate::model::truth::{Target, TruthPoint, TruthSet};

pub(super) fn build(
    feed: &mut Feed,
    manner: &Manner,
    reading: &Reading,
) -> Result<Dataset, Vec<Fault>> {
    let paths = paths::divide(feed, manner, reading);
    let used: Vec<usize> = paths
        .iter()
        .flat_map(|path| path.reports.iter().copied())
        .collect();
    let mut ground = Ground::of(feed, &used, reading)?;
    let mut attributes = Attributes::new();
    let mut codes = Codes::default();
    let mut targets = Vec::with_capacity(paths.len());
    let mut unplaced = Unplaced::default();
    for path in paths {
        let truth_id = path_name(feed.identities.name(path.identity), path.number);
        let known = feed.attributes_of(path.identity, &path.reports);
        note(&mut attributes, &truth_id, known);
        codes.note(feed, &truth_id, &path.reports);
        let mut points = Vec::with_capacity(path.reports.len());
        for &index in &path.reports {
            let place_m = ground.place_m(&feed.reports[index]);
            unplaced.count(feed, index, place_m.is_some());
            let Some(place_m) = place_m else { continue };
            let report = &feed.reports[index];
            points.push(TruthPoint {
                time_s: report.time_s,
                position: place_m.push(0.0),
                velocity: ground.velocity(report),
                height_m: report.height_m,
            });
        }
        targets.push(Target { truth_id, points });
    }
    feed.warnings.extend(unplaced.warning(feed));
    feed.warnings.extend(ground.warning());
    targets.retain(|target| !target.points.is_empty());
    targets.sort_by(|a, b| natural_order(&a.truth_id, &b.truth_id));
    let mut truth = TruthSet::new(Space::Plane, targets)?;
    (truth.frame, truth.attributes) = (ground.frame, attributes);
    truth.changes = codes.finish(feed);
    Ok(Dataset::Truth(truth))
}
