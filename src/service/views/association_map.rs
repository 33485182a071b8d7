//! How the probability of every track was shared at each of its points: the picture of all tracks over time.

use super::Window;
use super::layers::JobLayers;
use super::origins::Origins;
use crate::model::track::{Track, TrackPoint, TrackSet};
use serde::Serialize;
use utoipa::ToSchema;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AssociationMapName {
    AssociationMap,
}

/// One row for each track, the most doubtful first. Where a reduction is needed, the last tracks are left out whole.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct AssociationMapSeries {
    pub name: AssociationMapName,
    /// Whether the recording says which target each detection came from.
    pub origins_known: bool,
    /// The times of all points of the rows, each once, in order (s).
    pub time_s: Vec<f64>,
    pub rows: Vec<AssociationMapRow>,
    /// Tracks with candidates inside the window.
    pub source_tracks: usize,
    pub returned_tracks: usize,
    pub source_points: usize,
    pub returned_points: usize,
}

/// The points of one track, as columns of equal length. Shares are thousandths; what is left of 1000 is "no detection".
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct AssociationMapRow {
    pub track_id: String,
    /// Its own target: the one whose detections got most of the track's probability; null without one, and where origins are unknown.
    pub truth_id: Option<String>,
    /// Probability that went elsewhere, summed over the points: to detections of other targets and of none; where origins are
    /// unknown, to all but the most probable detection.
    pub doubt: f64,
    /// Place of each point's time in `time_s`.
    pub at: Vec<u32>,
    /// Detections of the own target; where origins are unknown, the most probable detection.
    pub own: Vec<u16>,
    /// Detections of other targets; where origins are unknown, the other detections.
    pub other: Vec<u16>,
    /// Detections of no target; 0 where origins are unknown.
    pub clutter: Vec<u16>,
}

/// How the probability of one point was shared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Shares {
    own: f64,
    other: f64,
    clutter: f64,
}

/// The series of the tracks inside the window.
pub fn of(layers: &JobLayers, window: &Window) -> AssociationMapSeries {
    let empty = TrackSet::default();
    let set = layers.tracks.as_ref().unwrap_or(&empty);
    let origins = Origins::of(layers, set);
    let wanted = set
        .tracks
        .iter()
        .filter(|track| window.holds_track(&track.track_id));
    let mut rows: Vec<Row> = wanted
        .map(|track| Row::of(set, track, origins.as_ref(), window))
        .filter(|row| !row.points.is_empty())
        .collect();
    // Of equally doubtful ones the order of the file stays.
    rows.sort_by(|a, b| b.doubt.total_cmp(&a.doubt));
    let (source_tracks, source_points) = (rows.len(), points_of(&rows));
    keep_first(&mut rows, window.max_points);
    let time_s = times_of(&rows);
    AssociationMapSeries {
        name: AssociationMapName::AssociationMap,
        origins_known: origins.is_some(),
        rows: rows.iter().map(|row| row.told(&time_s)).collect(),
        time_s,
        source_tracks,
        returned_tracks: rows.len(),
        source_points,
        returned_points: points_of(&rows),
    }
}

fn points_of(rows: &[Row]) -> usize {
    rows.iter().map(|row| row.points.len()).sum()
}

/// Keeps the first rows that have at most `max_points` points together, and one at least.
fn keep_first(rows: &mut Vec<Row>, max_points: usize) {
    let mut points = 0;
    let mut kept = 0;
    for row in rows.iter() {
        points += row.points.len();
        if points > max_points && kept > 0 {
            break;
        }
        kept += 1;
    }
    rows.truncate(kept);
}

fn times_of(rows: &[Row]) -> Vec<f64> {
    let points = rows.iter().flat_map(|row| &row.points);
    let mut times: Vec<f64> = points.map(|(time_s, _)| *time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// A track on its way to a row.
struct Row<'a> {
    track_id: &'a str,
    truth_id: Option<&'a str>,
    doubt: f64,
    points: Vec<(f64, Shares)>,
}

impl<'a> Row<'a> {
    fn of(
        set: &TrackSet,
        track: &'a Track,
        origins: Option<&Origins<'a>>,
        window: &Window,
    ) -> Self {
        let points = track
            .points
            .iter()
            .filter(|point| window.holds(point.time_s) && !set.candidates_of(point).is_empty());
        let own = origins.and_then(|origins| own_target(set, track, origins));
        let points: Vec<(f64, Shares)> = points
            .map(|point| {
                let shares = match origins {
                    Some(origins) => shares_by_origin(set, point, origins, own),
                    None => shares_by_rank(set, point),
                };
                (point.time_s, shares)
            })
            .collect();
        let elsewhere = points
            .iter()
            .map(|(_, shares)| shares.other + shares.clutter);
        Row {
            track_id: &track.track_id,
            truth_id: own.zip(origins).map(|(own, origins)| origins.name(own)),
            doubt: elsewhere.sum(),
            points,
        }
    }

    fn told(&self, time_s: &[f64]) -> AssociationMapRow {
        let times = self.points.iter().map(|(time, _)| *time);
        let share = |of: fn(&Shares) -> f64| {
            let shares = self.points.iter().map(|(_, shares)| of(shares));
            shares
                .map(|share| (1000.0 * share).round() as u16)
                .collect()
        };
        AssociationMapRow {
            track_id: self.track_id.to_owned(),
            truth_id: self.truth_id.map(str::to_owned),
            doubt: self.doubt,
            at: times.map(|time| place_in(time_s, time)).collect(),
            own: share(|shares| shares.own),
            other: share(|shares| shares.other),
            clutter: share(|shares| shares.clutter),
        }
    }
}

/// Index of a time among those that are known.
fn place_in(time_s: &[f64], time: f64) -> u32 {
    time_s.partition_point(|known| *known < time) as u32
}

/// The target whose detections got most of a track's probability; of equals the one that it was given first.
fn own_target(set: &TrackSet, track: &Track, origins: &Origins) -> Option<u32> {
    let mut sums: Vec<(u32, f64)> = Vec::new();
    for point in &track.points {
        for candidate in set.candidates_of(point) {
            let Some(target) = origins.target(point, candidate) else {
                continue;
            };
            match sums.iter_mut().find(|(known, _)| *known == target) {
                Some((_, sum)) => *sum += candidate.probability,
                None => sums.push((target, candidate.probability)),
            }
        }
    }
    let most = sums.into_iter().rev().max_by(|a, b| a.1.total_cmp(&b.1));
    most.map(|(target, _)| target)
}

fn shares_by_origin(
    set: &TrackSet,
    point: &TrackPoint,
    origins: &Origins,
    own: Option<u32>,
) -> Shares {
    let mut shares = Shares::default();
    for candidate in set.candidates_of(point) {
        if candidate.detection.is_none() {
            continue;
        }
        match origins.target(point, candidate) {
            None => shares.clutter += candidate.probability,
            target if target == own => shares.own += candidate.probability,
            Some(_) => shares.other += candidate.probability,
        }
    }
    shares
}

fn shares_by_rank(set: &TrackSet, point: &TrackPoint) -> Shares {
    let detections = set
        .candidates_of(point)
        .iter()
        .filter(|candidate| candidate.detection.is_some());
    let sum: f64 = detections.map(|candidate| candidate.probability).sum();
    let best = set
        .most_probable(point)
        .filter(|candidate| candidate.detection.is_some())
        .map_or(0.0, |candidate| candidate.probability);
    Shares {
        own: best,
        other: sum - best,
        clutter: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::dataset::Dataset;
    use crate::service::views::tests::{everything, read};

    /// Track `t` begins on A and goes over to B; `u` follows B with clutter in its gate; `v` is sure.
    const TRACKS: &str = "time_s,track_id,x_m,y_m,detection_id,probability\n\
        0,t,0,0,a1,1\n2,t,0,0,a2,0.75\n2,t,0,0,,0.25\n4,t,0,0,b3,0.6\n4,t,0,0,a3,0.4\n\
        0,u,0,0,b1,0.5\n0,u,0,0,c1,0.25\n0,u,0,0,,0.25\n0,v,0,0,a1,1\n";

    fn layers(detections: &str) -> JobLayers {
        let Dataset::Detections(detections) = read(detections) else {
            panic!("not detections")
        };
        let Dataset::Tracks(tracks) = read(TRACKS) else {
            panic!("not tracks")
        };
        JobLayers {
            detections: Some(detections),
            tracks: Some(tracks),
            ..JobLayers::default()
        }
    }

    fn known() -> JobLayers {
        layers(
            "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n0,1,r,a1,0,0,A\n0,1,r,b1,0,0,B\n0,1,r,c1,0,0,\n\
            2,2,r,a2,0,0,A\n4,3,r,a3,0,0,A\n4,3,r,b3,0,0,B\n",
        )
    }

    #[test]
    fn probability_is_shared_by_the_target_of_each_detection() {
        let series = of(&known(), &everything());
        assert!(series.origins_known);
        assert_eq!(series.time_s, [0.0, 2.0, 4.0]);
        let names: Vec<_> = series
            .rows
            .iter()
            .map(|row| row.track_id.as_str())
            .collect();
        assert_eq!(names, ["t", "u", "v"], "doubts of 0.6, 0.25 and 0");
        let [t, u, v] = &series.rows[..] else {
            panic!("not three rows")
        };
        assert_eq!(
            t.truth_id.as_deref(),
            Some("A"),
            "1 + 0.75 + 0.4 against 0.6"
        );
        assert!((t.doubt - 0.6).abs() < 1e-12 && (u.doubt - 0.25).abs() < 1e-12 && v.doubt == 0.0);
        assert_eq!(t.at, [0, 1, 2]);
        assert_eq!(t.own, [1000, 750, 400]);
        assert_eq!(t.other, [0, 0, 600]);
        assert_eq!(t.clutter, [0, 0, 0]);
        assert_eq!((u.own[0], u.other[0], u.clutter[0]), (500, 0, 250));
        assert_eq!(u.truth_id.as_deref(), Some("B"));
    }

    #[test]
    fn without_origins_the_most_probable_detection_stands_against_the_others() {
        let series = of(
            &layers("time_s,scan,sensor_id,detection_id,x_m,y_m\n0,1,r,a1,0,0\n"),
            &everything(),
        );
        assert!(!series.origins_known);
        let names: Vec<_> = series
            .rows
            .iter()
            .map(|row| row.track_id.as_str())
            .collect();
        assert_eq!(names, ["t", "u", "v"], "doubts of 0.4, 0.25 and 0");
        assert_eq!(series.rows[0].own, [1000, 750, 600]);
        assert_eq!(series.rows[0].other, [0, 0, 400]);
        assert!(series.rows.iter().all(|row| row.truth_id.is_none()));
    }

    #[test]
    fn where_there_is_no_room_the_most_doubtful_tracks_stay() {
        let window = Window {
            max_points: 4,
            ..everything()
        };
        let series = of(&known(), &window);
        assert_eq!((series.source_tracks, series.returned_tracks), (3, 2));
        assert_eq!((series.source_points, series.returned_points), (5, 4));
        let window = Window {
            max_points: 2,
            ..everything()
        };
        assert_eq!(of(&known(), &window).returned_tracks, 1, "one at least");
    }
}
