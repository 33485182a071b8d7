//! Zero has no sign, in no report and in no file.

use serde_json::{Value, json};
use trackloom_domain::experiment::observer::Silent;
use trackloom_domain::experiment::{JobKind, plan, presets, run, text};

/// Where a value has a -0.
fn negative_zeros(value: &Value, place: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(number)
            if number
                .as_f64()
                .is_some_and(|number| number == 0.0 && number.is_sign_negative()) =>
        {
            found.push(place.to_owned());
        }
        Value::Array(items) => items
            .iter()
            .enumerate()
            .for_each(|(index, item)| negative_zeros(item, &format!("{place}/{index}"), found)),
        Value::Object(fields) => fields
            .iter()
            .for_each(|(name, item)| negative_zeros(item, &format!("{place}/{name}"), found)),
        _ => {}
    }
}

fn is_negative_zero(word: &str) -> bool {
    word.starts_with('-') && word.parse::<f64>().is_ok_and(|number| number == 0.0)
}

#[test]
fn no_report_and_no_file_of_a_preset_has_a_negative_zero() {
    for mut preset in presets::all() {
        if preset.kind == JobKind::Campaign {
            preset.body["runs"] = json!(2);
            preset.body["timed_runs"] = json!(0);
        }
        let outcome = run(
            &plan(preset.kind, &preset.body).unwrap(),
            Vec::new(),
            &mut Silent,
        )
        .unwrap();
        let mut found = Vec::new();
        negative_zeros(&outcome.result, "", &mut found);
        for file in outcome
            .artifacts
            .iter()
            .filter(|file| file.media_type.starts_with("text"))
        {
            let text = String::from_utf8_lossy(&file.bytes);
            let words = text
                .split([',', '\n', ' ', '|', '(', ')', '"'])
                .filter(|word| is_negative_zero(word));
            found.extend(words.map(|word| format!("{} in {}", word, file.name)));
        }
        let report = json!({"result": outcome.result});
        let texts = [
            text::metrics(&outcome.result),
            text::correlation(&outcome.result),
            text::campaign(&report),
        ];
        found.extend(
            texts
                .iter()
                .flatten()
                .flat_map(|text| text.split([' ', '\n', '[', ']', ',']))
                .filter(|word| is_negative_zero(word))
                .map(str::to_owned),
        );
        assert_eq!(found, [""; 0], "{}", preset.name);
    }
}
