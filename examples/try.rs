use trackloom::experiment::{observer::Silent, plan, run};
use trackloom::formats; use trackloom::model::dataset::*;
use serde_json::json;
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let d = std::fs::read("examples/data/autoferry-scenario2/detections.json").unwrap();
    let t = std::fs::read("examples/data/autoferry-scenario2/groundTruth.json").unwrap();
    let f = formats::format_named("autoferry").unwrap();
    let rd = (f.read)(&mut d.as_slice(), &Default::default()).unwrap();
    println!("{:?} {:?}", rd.warnings, rd.dataset.summary());
    let Dataset::Detections(rec) = rd.dataset else {panic!()};
    let rec = rec.only_sensors(&["radar".to_owned()]).unwrap();
    let tr = (f.read)(&mut t.as_slice(), &Default::default()).unwrap();
    println!("{:?}", tr.dataset.summary());
    let body = json!({"input":{"source":"dataset","dataset_id":"x"},"truth":{"source":"dataset","dataset_id":"y"},
     "sensors":[{"sensor_id":"radar","p_d":0.9,"clutter_per_m2":a[4],"sigma_x_m":a[0],"sigma_y_m":a[0]}],
     "associator":{"method":"nearest_neighbour"},"filter":{"method":"kalman","process_noise_m2ps3":a[1]},
     "tracker":{"gate_probability":a[5],"confirm_hits":a[6] as i64,"confirm_window":a[7] as i64,"max_missed":5,"initial_speed_sigma_mps":a[2]},
     "tfa":{"symbols":{"kind":"nearest_truth","gate_m":a[3]}}});
    let plan = plan::plan(plan::JobKind::Evaluate, &body).unwrap();
    let ins = vec![Some(run::Input{dataset:Dataset::Detections(rec),sensors:vec![],sha256:"".into()}),Some(run::Input{dataset:tr.dataset,sensors:vec![],sha256:"".into()})];
    let o = run::run(&plan, ins, &mut Silent).unwrap();
    println!("{} {:?}", o.result["association"]["counts"], o.warnings);
    println!("{}", serde_json::to_string_pretty(&json!([o.result["association"]["tracks"], o.result["tfa"]["counts"],o.result["tfa"]["targets"]])).unwrap());
    println!("{}", o.result["tfa"]["output_tracks"]);
}
