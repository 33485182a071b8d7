//! Bearing-time records through the front door: uploaded, shown, and tracked by way of a detector.

use crate::helpers::{Api, id};
use reqwest::multipart::{Form, Part};
use serde_json::{Value, json};

const ROWS: usize = 40;
const CELLS: usize = 60;

/// A target that goes from 100 to 120 degrees, far above a floor that hardly moves.
fn level_db(row: usize, cell: usize) -> f32 {
    let off = 80.0 + cell as f32 - (100.0 + 0.5 * row as f32);
    (30.0 - 1.3 * off * off).max(0.1 * ((row * 7 + cell * 3) % 11) as f32)
}

/// The levels as NumPy writes them.
fn array() -> Vec<u8> {
    let header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({ROWS}, {CELLS}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(
        (0..ROWS * CELLS).flat_map(|index| level_db(index / CELLS, index % CELLS).to_le_bytes()),
    );
    bytes
}

fn matrix() -> String {
    let header: Vec<String> = (0..CELLS).map(|cell| (80 + cell).to_string()).collect();
    let row = |row: usize| {
        (0..CELLS).fold(row.to_string(), |text, cell| {
            format!("{text},{}", level_db(row, cell))
        })
    };
    format!(
        "time_s,{}\n{}\n",
        header.join(","),
        (0..ROWS).map(row).collect::<Vec<_>>().join("\n")
    )
}

async fn upload_array(api: &Api, meta: &Value) -> crate::helpers::Answer {
    let form = Form::new()
        .text("meta", meta.to_string())
        .part("file", Part::bytes(array()).file_name("levels.npy"));
    api.upload_form(form).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_record_of_either_format_is_kept_shown_and_tracked() {
    let api = Api::start().await;
    let axes = json!({"first_time_s": 0, "time_step_s": 1, "first_bearing_deg": 80, "bearing_step_deg": 1});
    let array = upload_array(&api, &json!({"bearing_time": axes}))
        .await
        .ok(201);
    let matrix = api.upload(&json!({}), &matrix()).await.ok(201);
    let mut tracks = Vec::new();
    for (dataset, format) in [(&array, "npy"), (&matrix, "csv")] {
        for (member, expected) in [
            ("kind", json!("bearing_time")),
            ("format", json!(format)),
            ("scans", json!(ROWS)),
            ("rows", json!(ROWS * CELLS)),
            ("end_s", json!(39.0)),
            ("first_bearing_deg", json!(80.0)),
        ] {
            assert_eq!(dataset[member], expected, "{format}: {member}");
        }
        let preview = api
            .get(&format!("/v1/datasets/{}/preview?limit=1", id(dataset)))
            .await
            .ok(200);
        assert_eq!(
            (
                &preview["total_rows"],
                preview["rows"].as_array().unwrap().len()
            ),
            (&json!(ROWS), 1)
        );
        let job = api
            .run(
                "associate",
                &json!({
                    "input": {"source": "dataset", "dataset_id": id(dataset)},
                    "detector": {"every_s": 2, "threshold": {"kind": "constant", "level_db": 15}},
                    "filter": {"method": "bearing_only"}, "sensors": [{"sensor_id": "sonar", "p_d": 0.9, "sigma_bearing_deg": 0.5}]
                }),
            )
            .await;
        assert_eq!(job["state"], "succeeded", "{job}");
        let report = api
            .get(&format!("/v1/jobs/{}/report", id(&job)))
            .await
            .ok(200);
        let detection = &report["result"]["detection"];
        assert_eq!(
            (
                &detection["scans"],
                &detection["detections"],
                &detection["rows"]
            ),
            (&json!(20), &json!(20), &json!(ROWS))
        );
        assert_eq!(report["inputs"][0]["role"], "bearing_time");
        let picture = api
            .get(&format!("/v1/jobs/{}/artifacts/record.svg", id(&job)))
            .await;
        assert!(picture.text.starts_with("<svg"), "{}", picture.text);
        tracks.push(report["result"]["association"]["tracks"].clone());
    }
    assert_eq!(tracks[0].as_array().unwrap().len(), 1);
    assert_eq!(tracks[0], tracks[1]);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_array_without_axes_is_refused_with_what_is_needed() {
    let api = Api::start().await;
    let problem = upload_array(&api, &json!({})).await.problem();
    assert_eq!(problem["errors"][0]["pointer"], "/meta/bearing_time");
    assert!(
        problem["errors"][0]["allowed"]
            .as_str()
            .unwrap()
            .contains("bearing_step_deg"),
        "{problem}"
    );
    let half = upload_array(&api, &json!({"bearing_time": {"time_step_s": 0}}))
        .await
        .problem();
    let pointers: Vec<&str> = half["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|error| error["pointer"].as_str().unwrap())
        .collect();
    assert_eq!(
        pointers,
        [
            "/meta/bearing_time/time_step_s",
            "/meta/bearing_time/first_bearing_deg",
            "/meta/bearing_time/bearing_step_deg"
        ]
    );
}
