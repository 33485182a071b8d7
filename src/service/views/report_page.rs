//! One file that shows a job without the service: the report and what its pictures are made of, embedded in a page.

use super::association_map::{self, AssociationMapSeries};
use super::layers::JobLayers;
use super::plan::{self, Plan};
use super::series::{TrackProbabilitySeries, track_probability};
use super::{Method, Window};
use serde::Serialize;
use serde_json::Value;

/// Where the data go in the page.
const PLACE: &str = "<!--DATA-->";
/// Points of a layer of the plan.
const PLAN_POINTS: usize = 20_000;
/// Points of the picture of all tracks.
const MAP_POINTS: usize = 60_000;
/// Tracks whose candidates come one by one, the most doubtful first, and their rows.
const RIBBONS: usize = 24;
const RIBBON_ROWS: usize = 4_000;
/// Entries of any list of the report.
const LIST_ENTRIES: usize = 1_000;
/// Lines of the table of causes.
const CAUSE_LINES: usize = 1_000;

/// What a page is made of.
pub struct Source<'a> {
    pub name: &'a str,
    /// As the job left it.
    pub report: Value,
    pub layers: &'a JobLayers,
    /// The file of causes, where the job explained its events.
    pub causes: Option<&'a [u8]>,
}

/// What the script of the page reads.
#[derive(Debug, Serialize)]
struct Data<'a> {
    name: &'a str,
    report: Value,
    plan: Plan,
    association_map: AssociationMapSeries,
    probabilities: Vec<TrackProbabilitySeries>,
    /// As CSV.
    causes: String,
    /// What the job has more of than the page, in words.
    left_out: Vec<String>,
}

/// The page with the data of a job; its size is bounded, and it says what was left out.
pub fn render(template: &str, source: Source) -> String {
    let data = data_of(source);
    let text = serde_json::to_string(&data).unwrap_or_default();
    // In JSON these stand in texts alone; there they must not end the element that holds the data.
    template.replacen(PLACE, &text.replace('<', "\\u003c"), 1)
}

fn data_of(source: Source) -> Data {
    let Source {
        name,
        mut report,
        layers,
        causes,
    } = source;
    let mut left_out = Vec::new();
    shorten(&mut report, "", &mut left_out);
    let plan = plan::of(layers, &window(PLAN_POINTS));
    tell_layers(&plan, &mut left_out);
    let map = association_map::of(layers, &window(MAP_POINTS));
    tell(
        "tracks of the picture of all tracks",
        map.returned_tracks,
        map.source_tracks,
        &mut left_out,
    );
    let worst = map.rows.iter().take(RIBBONS);
    let probabilities: Vec<_> = worst
        .map(|row| ribbon(layers, &row.track_id))
        .filter(|series| series.method == Method::All)
        .collect();
    tell(
        "tracks with each candidate",
        probabilities.len(),
        map.source_tracks,
        &mut left_out,
    );
    let causes = causes.map(|bytes| first_lines(bytes, &mut left_out));
    Data {
        name,
        report,
        plan,
        association_map: map,
        probabilities,
        causes: causes.unwrap_or_default(),
        left_out,
    }
}

fn window(max_points: usize) -> Window {
    Window {
        max_points,
        ..Window::default()
    }
}

fn ribbon(layers: &JobLayers, track_id: &str) -> TrackProbabilitySeries {
    let window = Window {
        track_id: Some(track_id.to_owned()),
        ..window(RIBBON_ROWS)
    };
    track_probability(layers, &window)
}

fn tell(what: &str, kept: usize, of: usize, left_out: &mut Vec<String>) {
    if kept < of {
        left_out.push(format!("{what}: {kept} of {of}"));
    }
}

fn tell_layers(plan: &Plan, left_out: &mut Vec<String>) {
    let layers = [
        (
            "points of truth",
            plan.truth.returned_points,
            plan.truth.source_points,
        ),
        (
            "detections",
            plan.detections.returned_points,
            plan.detections.source_points,
        ),
        (
            "points of tracks",
            plan.tracks.returned_points,
            plan.tracks.source_points,
        ),
    ];
    for (what, kept, of) in layers {
        tell(what, kept, of, left_out);
    }
}

/// Cuts the lists of a report; `pointer` says where in it this value stands.
fn shorten(value: &mut Value, pointer: &str, left_out: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            tell(
                pointer,
                items.len().min(LIST_ENTRIES),
                items.len(),
                left_out,
            );
            items.truncate(LIST_ENTRIES);
            for (index, item) in items.iter_mut().enumerate() {
                shorten(item, &format!("{pointer}/{index}"), left_out);
            }
        }
        Value::Object(members) => {
            for (name, member) in members {
                shorten(member, &format!("{pointer}/{name}"), left_out);
            }
        }
        _ => {}
    }
}

fn first_lines(bytes: &[u8], left_out: &mut Vec<String>) -> String {
    let text = String::from_utf8_lossy(bytes);
    let lines = text.lines().count().saturating_sub(1);
    tell("causes", lines.min(CAUSE_LINES), lines, left_out);
    let kept: Vec<&str> = text.lines().take(CAUSE_LINES + 1).collect();
    kept.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn rendered(report: Value, causes: &[u8]) -> Value {
        let source = Source {
            name: "a </script><script>alert(1)</script> job",
            report,
            layers: &JobLayers::default(),
            causes: Some(causes),
        };
        let page = render("<html><!--DATA--></html>", source);
        let json = page
            .strip_prefix("<html>")
            .and_then(|rest| rest.strip_suffix("</html>"))
            .unwrap();
        assert!(!json.contains('<'), "nothing in the data ends its element");
        serde_json::from_str(json).unwrap()
    }

    #[test]
    fn texts_of_a_job_stay_texts() {
        let data = rendered(json!({"result": {}}), b"");
        assert_eq!(data["name"], "a </script><script>alert(1)</script> job");
        assert_eq!(data["left_out"], json!([]));
    }

    #[test]
    fn long_lists_are_cut_and_that_is_told() {
        let targets: Vec<u32> = (0..1500).collect();
        let causes = format!("event\n{}", "miss\n".repeat(1200));
        let report = json!({"result": {"tfa": {"targets": targets}}});
        let data = rendered(report, causes.as_bytes());
        let kept = data["report"]["result"]["tfa"]["targets"]
            .as_array()
            .unwrap();
        assert_eq!((kept.len(), kept[999].as_u64()), (1000, Some(999)));
        assert_eq!(data["causes"].as_str().unwrap().lines().count(), 1001);
        assert_eq!(
            data["left_out"],
            json!(["/result/tfa/targets: 1000 of 1500", "causes: 1000 of 1200"])
        );
    }
}
