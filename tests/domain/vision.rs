//! The metrics of vision against a reference on real boxes, and against plain dense implementations on random ones.

mod dense;

use serde_json::json;
use std::path::PathBuf;
use trackloom_domain::evaluation::comparison::Comparison;
use trackloom_domain::evaluation::events::EventLog;
use trackloom_domain::evaluation::metrics::{METRICS, MetricReport, Sequence};
use trackloom_domain::formats::{ReadOptions, format_named};
use trackloom_domain::model::boxes::{BoxSet, ObjectBox};
use trackloom_domain::model::dataset::{Dataset, DatasetKind};
use trackloom_domain::registry;

fn evaluate(name: &str, comparisons: &[Comparison]) -> MetricReport {
    let method = METRICS
        .iter()
        .find(|method| method.name == name)
        .expect("a name of the table");
    let defaults =
        registry::check(&json!({}), method.parameters).expect("every parameter has a default");
    let metric = (method.build)(&defaults).expect("defaults build");
    let logs: Vec<EventLog> = comparisons.iter().map(EventLog::new).collect();
    let sequence = |(comparison, events)| Sequence {
        comparison,
        events,
        input: None,
    };
    metric.evaluate(
        &comparisons
            .iter()
            .zip(&logs)
            .map(sequence)
            .collect::<Vec<_>>(),
    )
}

fn assert_close(what: &str, found: Option<f64>, expected: f64, tolerance: f64) {
    let found = found.unwrap_or_else(|| panic!("{what} is null, not {expected}"));
    assert!(
        (found - expected).abs() <= tolerance,
        "{what} is {found}, not {expected}"
    );
}

/// TUD-Campus of MOTChallenge with the tracks of one tracker; `None` where the machine has it not.
fn tud_campus() -> Option<Comparison> {
    let Some(folder) = std::env::var_os("TRACKLOOM_DATA")
        .map(|folder| PathBuf::from(folder).join("mot-tud/TUD-Campus"))
    else {
        println!("skipped: TRACKLOOM_DATA names no folder with mot-tud/TUD-Campus");
        return None;
    };
    let read = |file: &str, kind| {
        let bytes = std::fs::read(folder.join(file)).expect("the folder has the file");
        mot(&bytes, kind)
    };
    Some(Comparison::of_boxes(
        &read("gt.txt", DatasetKind::Truth),
        &read("test.txt", DatasetKind::Tracks),
        0.5,
    ))
}

const CLEAR: [(&str, f64); 22] = [
    ("mota", 0.526_462_395_543_175_5),
    ("moda", 0.545_961_002_785_515_3),
    ("motp_similarity", 0.722_798_915_360_538_5),
    ("motp_distance", 0.277_201_084_639_461_8),
    ("smota", 0.365_083_491_115_188_1),
    ("motal", 0.543_606_969_247_871_2),
    ("recall", 0.582_172_701_949_860_7),
    ("precision", 0.941_441_441_441_441_4),
    ("f1", 0.719_449_225_473_321_9),
    ("fp_per_step", 0.183_098_591_549_295_78),
    ("mt_share", 0.125),
    ("pt_share", 0.75),
    ("ml_share", 0.125),
    ("tp", 209.0),
    ("fn", 150.0),
    ("fp", 13.0),
    ("idsw", 7.0),
    ("frag", 7.0),
    ("frag_trackeval", 7.0),
    ("mt", 1.0),
    ("pt", 6.0),
    ("ml", 1.0),
];

const IDENTITY: [(&str, f64); 6] = [
    ("idf1", 0.557_659_208_261_617_9),
    ("idp", 0.729_729_729_729_729_7),
    ("idr", 0.451_253_481_894_150_43),
    ("idtp", 162.0),
    ("idfn", 197.0),
    ("idfp", 60.0),
];

const HOTA: [(&str, f64); 12] = [
    ("hota", 0.391_397_437_845_113_9),
    ("det_a", 0.418_047_030_142_763),
    ("ass_a", 0.369_120_681_208_328_36),
    ("loc_a", 0.770_052_227_022_172),
    ("det_re", 0.441_577_481_307_726_2),
    ("det_pr", 0.714_082_503_556_187_9),
    ("ass_re", 0.383_224_913_943_496_67),
    ("ass_pr", 0.754_049_776_587_294),
    ("owta", 0.403_394_660_892_216_6),
    ("hota_0", 0.549_351_167_667_314),
    ("loc_a_0", 0.702_803_103_988_236_6),
    ("hota_loc_a_0", 0.386_085_705_816_150_5),
];

#[rustfmt::skip]
const HOTA_BY_ALPHA: [(&str, [f64; 19]); 12] = [
    ("hota", [0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.545_181_125_985_210_7, 0.542_362_193_208_016_5, 0.539_321_736_265_715_7, 0.536_371_928_789_123_2, 0.520_610_339_245_348_5, 0.496_507_754_177_191_3, 0.424_198_924_812_536_1, 0.349_432_095_264_615_05, 0.292_928_599_158_255_7, 0.222_201_988_285_363_86, 0.142_395_332_089_741_67, 0.069_274_827_541_031_86, 0.009_008_635_898_442_875, 0.0]),
    ("det_a", [0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.604_972_375_690_607_7, 0.596_153_846_153_846_1, 0.587_431_693_989_071, 0.578_804_347_826_086_9, 0.553_475_935_828_877, 0.520_942_408_376_963_4, 0.441_687_344_913_151_37, 0.341_801_385_681_293_3, 0.263_043_478_260_869_55, 0.185_714_285_714_285_72, 0.117_307_692_307_692_31, 0.054_446_460_980_036_3, 0.005_190_311_418_685_121, 0.0]),
    ("ass_a", [0.488_024_447_048_925_34, 0.488_024_447_048_925_34, 0.488_024_447_048_925_34, 0.488_024_447_048_925_34, 0.488_024_447_048_925_34, 0.491_299_226_334_437_57, 0.493_424_223_493_977_7, 0.495_151_926_913_357_3, 0.497_050_250_354_041_6, 0.489_696_313_396_640_77, 0.473_219_200_422_039_6, 0.407_402_951_170_118_04, 0.357_233_160_297_575_85, 0.326_209_054_001_787_7, 0.265_858_511_681_371_4, 0.172_848_260_860_538_7, 0.088_141_665_123_089_27, 0.015_635_963_664_637_5, 0.0]),
    ("loc_a", [0.702_803_103_988_236_6, 0.702_803_103_988_236_6, 0.702_803_103_988_236_6, 0.702_803_103_988_236_6, 0.702_803_103_988_236_6, 0.708_584_579_311_579_1, 0.712_088_902_683_134_1, 0.715_165_359_552_191_8, 0.717_838_646_509_064_9, 0.724_822_977_675_770_8, 0.732_489_312_159_779_6, 0.751_040_868_164_063_3, 0.777_364_756_882_313_5, 0.799_685_746_331_502_5, 0.824_253_126_883_841_9, 0.848_773_229_150_197_9, 0.876_697_557_202_671_7, 0.928_171_730_973_974_1, 1.0]),
    ("det_re", [0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.618_384_401_114_206_1, 0.610_027_855_153_203_3, 0.604_456_824_512_534_8, 0.598_885_793_871_866_2, 0.593_314_763_231_197_8, 0.576_601_671_309_192_2, 0.554_317_548_746_518_1, 0.495_821_727_019_498_6, 0.412_256_267_409_470_74, 0.337_047_353_760_445_7, 0.253_481_894_150_417_83, 0.169_916_434_540_389_96, 0.083_565_459_610_027_86, 0.008_356_545_961_002_786, 0.0]),
    ("det_pr", [1.0, 1.0, 1.0, 1.0, 1.0, 0.986_486_486_486_486_5, 0.977_477_477_477_477_5, 0.968_468_468_468_468_5, 0.959_459_459_459_459_4, 0.932_432_432_432_432_5, 0.896_396_396_396_396_3, 0.801_801_801_801_801_8, 0.666_666_666_666_666_6, 0.545_045_045_045_045, 0.409_909_909_909_909_9, 0.274_774_774_774_774_8, 0.135_135_135_135_135_14, 0.013_513_513_513_513_514, 0.0]),
    ("ass_re", [0.488_194_494_796_607_4, 0.488_194_494_796_607_4, 0.488_194_494_796_607_4, 0.488_194_494_796_607_4, 0.488_194_494_796_607_4, 0.491_628_678_718_684_6, 0.493_819_097_379_978_76, 0.495_650_973_021_592_17, 0.497_659_994_919_963_27, 0.494_385_529_494_735_47, 0.484_543_567_940_305_2, 0.433_339_895_804_288_9, 0.388_475_088_519_102_6, 0.364_516_183_418_232_1, 0.321_579_661_116_884_4, 0.225_934_614_975_829_5, 0.123_239_436_619_718_3, 0.025_528_169_014_084_504, 0.0]),
    ("ass_pr", [0.991_683_991_683_991_7, 0.991_683_991_683_991_7, 0.991_683_991_683_991_7, 0.991_683_991_683_991_7, 0.991_683_991_683_991_7, 0.989_462_592_202_318_1, 0.983_288_600_800_121_5, 0.977_438_453_019_848_3, 0.970_966_826_600_629_5, 0.951_711_834_864_008_8, 0.924_016_833_250_501_5, 0.837_158_360_626_735_8, 0.749_136_824_538_375_9, 0.673_022_897_859_043_7, 0.588_544_145_699_117_5, 0.424_281_710_208_185_7, 0.257_656_182_228_803_04, 0.041_840_534_840_938_665, 0.0]),
    ("owta", [0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.549_351_167_667_314, 0.547_454_302_457_497_5, 0.546_126_028_743_121_7, 0.544_554_363_527_362, 0.543_053_636_027_617_2, 0.531_375_303_094_200_1, 0.512_165_702_871_377_6, 0.449_443_249_856_985_14, 0.383_759_832_784_995_6, 0.331_583_923_651_314_67, 0.259_596_454_361_389_56, 0.171_376_078_266_279_54, 0.085_823_066_577_722_08, 0.011_430_776_395_683_401, 0.0]),
    ("tp", [222.0, 222.0, 222.0, 222.0, 222.0, 219.0, 217.0, 215.0, 213.0, 207.0, 199.0, 178.0, 148.0, 121.0, 91.0, 61.0, 30.0, 3.0, 0.0]),
    ("fn", [137.0, 137.0, 137.0, 137.0, 137.0, 140.0, 142.0, 144.0, 146.0, 152.0, 160.0, 181.0, 211.0, 238.0, 268.0, 298.0, 329.0, 356.0, 359.0]),
    ("fp", [0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 5.0, 7.0, 9.0, 15.0, 23.0, 44.0, 74.0, 101.0, 131.0, 161.0, 192.0, 219.0, 222.0]),
];

#[test]
fn tud_campus_equals_the_reference() {
    let Some(comparison) = tud_campus() else {
        return;
    };
    let comparisons = [comparison];
    assert_eq!(
        (
            comparisons[0].steps.len(),
            comparisons[0].truth_ids.len(),
            comparisons[0].track_ids.len()
        ),
        (71, 8, 13)
    );
    for (metric, expected) in [
        ("clear", &CLEAR[..]),
        ("identity", &IDENTITY),
        ("hota", &HOTA),
    ] {
        let report = evaluate(metric, &comparisons);
        for &(name, value) in expected {
            let tolerance = if value.fract() == 0.0 { 0.0 } else { 1e-9 };
            assert_close(name, report.quantity(name), value, tolerance);
        }
    }
    let report = evaluate("hota", &comparisons);
    for (name, values) in HOTA_BY_ALPHA {
        let series = report
            .series
            .iter()
            .find(|series| series.name == name)
            .expect("a curve of this name");
        for (index, value) in values.into_iter().enumerate() {
            assert_close(
                &format!("{name} at {}", series.at[index]),
                series.values[index],
                value,
                1e-9,
            );
        }
    }
}

/// A sequence and its copy combined: counts double, ratios stay.
#[test]
fn copies_of_tud_campus_have_the_same_ratios() {
    let Some(comparison) = tud_campus() else {
        return;
    };
    let comparisons = [comparison.clone(), comparison];
    for (metric, expected) in [
        ("clear", &CLEAR[..10]),
        ("identity", &IDENTITY[..3]),
        ("hota", &HOTA),
    ] {
        let report = evaluate(metric, &comparisons);
        for &(name, value) in expected.iter().filter(|(name, _)| *name != "motal") {
            assert_close(name, report.quantity(name), value, 1e-9);
        }
    }
    assert_eq!(evaluate("clear", &comparisons).quantity("idsw"), Some(14.0));
    assert_eq!(
        evaluate("identity", &comparisons).quantity("idtp"),
        Some(324.0)
    );
}

/// Numbers from a seed, in [0, 1).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Up to `most` objects that wander, come and go.
    fn objects(&mut self, most: f64, frames: u32) -> BoxSet {
        let count = (self.next() * (most + 1.0)) as u32;
        let mut boxes = Vec::new();
        for object in 0..count {
            let (mut left_px, mut top_px) = (self.next() * 8.0, self.next() * 3.0);
            for frame in 1..=frames {
                left_px += self.next() * 6.0 - 3.0;
                top_px += self.next() * 2.0 - 1.0;
                if self.next() < 0.75 {
                    let (width_px, height_px) = (8.0 + self.next() * 4.0, 8.0 + self.next() * 4.0);
                    boxes.push(ObjectBox {
                        frame,
                        object,
                        left_px,
                        top_px,
                        width_px,
                        height_px,
                        confidence: 1.0,
                    });
                }
            }
        }
        BoxSet::new((0..count).map(|object| object.to_string()).collect(), boxes)
            .expect("the boxes are sound")
    }
}

#[test]
fn random_boxes_have_the_metrics_of_a_dense_implementation() {
    let mut noise = Noise(20_261_122);
    let (mut switches, mut matches) = (0.0, 0.0);
    for case in 0..1000 {
        let frames = 1 + case % 9;
        let (truth, tracks) = (noise.objects(4.0, frames), noise.objects(4.0, frames));
        let scene = dense::Scene::new(&truth, &tracks, frames);
        let comparisons = [Comparison::of_boxes(&truth, &tracks, 0.5)];
        let (truth_points, track_points) =
            (truth.boxes().len() as f64, tracks.boxes().len() as f64);
        let identity = evaluate("identity", &comparisons);
        assert_eq!(identity.quantity("idtp"), Some(scene.idtp()), "case {case}");
        let clear = evaluate("clear", &comparisons);
        let expected = scene.clear();
        assert_eq!(clear.quantity("tp"), Some(expected.matches), "case {case}");
        assert_eq!(
            clear.quantity("idsw"),
            Some(expected.switches),
            "case {case}"
        );
        assert_eq!(
            clear.quantity("frag_trackeval"),
            Some(expected.fragments),
            "case {case}"
        );
        assert_eq!(
            clear.quantity("fn"),
            Some(truth_points - expected.matches),
            "case {case}"
        );
        assert_eq!(
            clear.quantity("fp"),
            Some(track_points - expected.matches),
            "case {case}"
        );
        (switches, matches) = (switches + expected.switches, matches + expected.matches);
        if truth_points + track_points == 0.0 {
            assert_eq!(
                (
                    identity.value,
                    clear.value,
                    evaluate("hota", &comparisons).value
                ),
                (None, None, None)
            );
            continue;
        }
        let hota = evaluate("hota", &comparisons);
        for (name, values) in scene.hota() {
            let series = hota
                .series
                .iter()
                .find(|series| series.name == name)
                .expect("a curve of this name");
            for (index, value) in values.into_iter().enumerate() {
                assert_close(
                    &format!("case {case}: {name} number {index}"),
                    series.values[index],
                    value,
                    1e-12,
                );
            }
        }
    }
    assert!(
        switches > 100.0 && matches > 1000.0,
        "{switches} switches, {matches} matches: the cases are too easy"
    );
}

/// One pedestrian, one distractor, one car, a track on each: the one on the distractor is taken away, the one on the car is false. What
/// TrackEval says of MOT17.
#[test]
fn a_track_on_a_distractor_is_neither_right_nor_false() {
    let truth = "1,1,1,1,10,20,1,1,1\n1,2,100,1,10,20,1,8,1\n1,3,200,1,10,20,1,3,1\n";
    let tracks = "1,1,1,1,10,20,1\n1,2,100,1,10,20,1\n1,3,200,1,10,20,1\n";
    let comparison = Comparison::of_boxes(
        &mot(truth.as_bytes(), DatasetKind::Truth),
        &mot(tracks.as_bytes(), DatasetKind::Tracks),
        0.5,
    );
    assert_eq!(comparison.track_ids, ["1", "3"]);
    let rows: Vec<u32> = comparison.tracks.iter().map(|track| track.point).collect();
    assert_eq!(rows, [0, 2], "rows are those of the file");
    let clear = evaluate("clear", &[comparison]);
    for (name, value) in [("fp", 1.0), ("fn", 0.0), ("tp", 1.0), ("mota", 0.0)] {
        assert_close(name, clear.quantity(name), value, 0.0);
    }
}

/// The distractor lies beside the pedestrian: a track goes to whom it overlaps most in all, and one that overlaps by less than half is
/// not forgiven.
#[test]
fn a_track_is_forgiven_only_where_the_best_matching_gives_it_to_a_distractor() {
    let truth =
        "1,1,0,0,10,10,1,1,1\n1,2,4,0,10,10,0,7,1\n2,1,0,0,10,10,1,1,1\n2,2,40,0,10,10,0,7,1\n";
    // Frame 1: on the pedestrian, and between the two: IoU 9/11 and 1/3 with the pedestrian, 5/15 and 1 with the other.
    let tracks = "1,1,1,0,10,10,1\n1,2,4,0,10,10,1\n2,1,0,0,10,10,1\n2,2,46,0,10,10,1\n";
    let comparison = Comparison::of_boxes(
        &mot(truth.as_bytes(), DatasetKind::Truth),
        &mot(tracks.as_bytes(), DatasetKind::Tracks),
        0.5,
    );
    let clear = evaluate("clear", &[comparison]);
    for (name, value) in [("tp", 2.0), ("fp", 1.0), ("fn", 0.0)] {
        assert_close(name, clear.quantity(name), value, 0.0);
    }
}

fn mot(bytes: &[u8], kind: DatasetKind) -> BoxSet {
    let format = format_named("mot").expect("the format is known");
    let options = ReadOptions {
        kind: Some(kind),
        ..ReadOptions::default()
    };
    let read = (format.read)(&mut &*bytes, &options).expect("the text is sound");
    match read.dataset {
        Dataset::TruthBoxes(set) | Dataset::TrackBoxes(set) => set,
        other => panic!("expected boxes, found {}", other.kind().name()),
    }
}
