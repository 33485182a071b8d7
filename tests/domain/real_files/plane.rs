//! Recordings of the ferry milliAmpere and boxes of a video, against the `json` of Python and its count of lines.

use super::*;
use serde_json::json;

/// Scenario; scans; measurements of lidar, radar, infrared and daylight; points of truth, the first time and the last one; a row of each
/// target: time, east and north.
type Scenario = (u32, u64, [usize; 4], u64, [f64; 2], [[f64; 3]; 2]);

const SCENARIOS: [Scenario; 6] = [
    (
        2,
        1907,
        [412, 437, 1446, 1944],
        2145,
        [1_620_114_891.8, 1_620_115_009.88],
        [
            [
                1_620_114_891.88,
                -354.795_964_683_932_2,
                84.635_100_992_121_83,
            ],
            [
                1_620_115_009.8,
                -388.672_134_589_489_5,
                29.428_033_521_882_423,
            ],
        ],
    ),
    (
        3,
        2107,
        [407, 394, 1529, 996],
        2411,
        [1_620_115_381.4, 1_620_115_511.88],
        [
            [
                1_620_115_381.48,
                -435.085_157_889_366,
                196.783_141_504_805_37,
            ],
            [
                1_620_115_511.8,
                -496.360_482_866_191_6,
                -4.667_055_709_597_543,
            ],
        ],
    ),
    (
        4,
        1604,
        [392, 277, 652, 953],
        1809,
        [1_620_115_864.6, 1_620_115_963.96],
        [
            [
                1_620_115_864.76,
                -600.990_837_015_172_4,
                -133.473_486_751_861_86,
            ],
            [
                1_620_115_963.8,
                -481.989_310_335_288_2,
                73.298_412_022_029_34,
            ],
        ],
    ),
    (
        5,
        3250,
        [375, 443, 3587, 1267],
        3160,
        [1_620_116_323.16, 1_620_116_462.16],
        [
            [
                1_620_116_323.16,
                -437.880_925_644_788_76,
                189.983_895_093_611_1,
            ],
            [
                1_620_116_462.0,
                -719.353_848_905_571_3,
                -152.129_427_851_819_03,
            ],
        ],
    ),
    (
        6,
        2457,
        [667, 495, 1323, 1241],
        2251,
        [1_620_116_942.0, 1_620_117_094.16],
        [
            [
                1_620_116_942.0,
                -718.147_768_117_057_5,
                -183.499_018_788_021_12,
            ],
            [
                1_620_117_094.0,
                -402.517_788_811_868_06,
                105.343_119_747_257_32,
            ],
        ],
    ),
    (
        17,
        1282,
        [102, 191, 3672, 6224],
        1171,
        [1_620_206_016.6, 1_620_206_095.96],
        [
            [
                1_620_206_016.72,
                -476.125_364_765_457_3,
                -581.043_505_075_807_3,
            ],
            [
                1_620_206_095.8,
                -326.650_223_445_774_3,
                -499.226_035_082_109_04,
            ],
        ],
    ),
];

#[test]
fn boats_before_a_ferry() {
    for (number, scans, measurements, points_of_truth, span, rows) in SCENARIOS {
        let file = format!("autoferry/scenario{number}_detections.json");
        let Some(detections) = read(&file, &[]) else {
            return;
        };
        let total = measurements.iter().sum::<usize>() as u64;
        assert_eq!(fates(&detections), [total, total, 0, 0], "{file}");
        assert_eq!(detections.dataset.summary().scans, scans);
        let Dataset::Detections(recording) = &detections.dataset else {
            panic!("no detections")
        };
        let sensors = ["lidar", "radar", "infrared", "daylight"];
        let counts = sensors.map(|sensor| {
            let of_it = recording.only_sensors(&[sensor.to_owned()]).unwrap();
            of_it.detection_count()
        });
        assert_eq!(counts, measurements, "{file}");
        let file = format!("autoferry/scenario{number}_groundTruth.json");
        let truth = read(&file, &[]).unwrap();
        let total = points_of_truth;
        assert_eq!(fates(&truth), [total, total, 0, 0], "{file}");
        assert_eq!(span_s(&truth.dataset), span);
        assert_eq!(identities_and_paths(&truth.dataset), [2, 2]);
        for [time_s, x_m, y_m] in rows {
            let points = points(&truth.dataset);
            let is_it = |point: &&(&str, f64, Place)| {
                let (_, found_s, place) = **point;
                (found_s - time_s).abs() <= TIME_S
                    && (place.x - x_m).abs() < 1e-9
                    && (place.y - y_m).abs() < 1e-9
            };
            assert!(points.iter().any(|point| is_it(&point)), "{file}: {time_s}");
        }
    }
}

/// Boxes, objects, and left, top, width and height of the first and of the last line.
#[test]
fn walkers_in_a_video() {
    let files = [
        (
            "gt.txt",
            "truth",
            359,
            8,
            [[399.0, 182.0, 121.0, 229.0], [416.0, 204.0, 58.0, 164.0]],
        ),
        (
            "test.txt",
            "tracks",
            222,
            13,
            [
                [113.84, 274.5, 57.307, 130.05],
                [432.2, 217.39, 66.352, 150.57],
            ],
        ),
    ];
    for (name, kind, lines, objects, ends) in files {
        let file = format!("mot-tud/TUD-Campus/{name}");
        let Some(refused) = try_read(&file, &[]) else {
            return;
        };
        refused.expect_err("the file does not say what it holds");
        let read = read(&file, &[("kind", json!(kind))]).unwrap();
        assert_eq!(fates(&read), [lines, lines, 0, 0]);
        let (Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set)) = &read.dataset else {
            panic!("no boxes")
        };
        assert_eq!((set.frames(), set.object_ids().len()), (71, objects));
        for (frame, [left, top, width, height]) in [1, 71].into_iter().zip(ends) {
            let is_it = set.boxes().iter().any(|one| {
                let found = [one.left_px, one.top_px, one.width_px, one.height_px];
                one.frame == frame && found == [left, top, width, height]
            });
            assert!(is_it, "{name}, frame {frame}");
        }
    }
}
