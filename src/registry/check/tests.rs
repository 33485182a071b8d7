//! Faults with their pointers, and defaults.

use super::super::Variant;
use super::*;
use serde_json::json;

static BAT: Object = Object {
    name: "Bat",
    summary: "",
    fields: &[integer("bats", "30")],
};
static NEAREST: Object = Object {
    name: "Nearest",
    summary: "",
    fields: &[],
};
static METHOD: Union = Union {
    name: "Method",
    summary: "",
    tag: "method",
    variants: || {
        vec![
            Variant {
                tag: "bat",
                object: &BAT,
            },
            Variant {
                tag: "nearest",
                object: &NEAREST,
            },
        ]
    },
};
static JOB: Object = Object {
    name: "Job",
    summary: "",
    fields: &[
        Field {
            name: "p_d",
            summary: "",
            kind: Kind::Number {
                min: Bound::Excluding(0.0),
                max: Bound::Including(1.0),
                unit: "",
            },
            presence: Presence::Required,
        },
        Field {
            name: "method",
            summary: "",
            kind: Kind::Union(&METHOD),
            presence: Presence::Default(r#"{"method":"bat"}"#),
        },
        Field {
            name: "times",
            summary: "",
            kind: Kind::List {
                item: &Kind::Integer {
                    min: 0,
                    max: 9,
                    unit: "s",
                },
                min: 1,
                max: 2,
            },
            presence: Presence::Optional,
        },
    ],
};

const fn integer(name: &'static str, default: &'static str) -> Field {
    Field {
        name,
        summary: "",
        kind: Kind::Integer {
            min: 1,
            max: 100,
            unit: "",
        },
        presence: Presence::Default(default),
    }
}

#[test]
fn defaults_are_filled_in_at_every_depth() {
    let checked = check(&json!({"p_d": 0.9}), &JOB).unwrap();
    assert_eq!(
        checked,
        json!({"p_d": 0.9, "method": {"method": "bat", "bats": 30}})
    );
}

#[test]
fn every_fault_is_named_with_its_pointer_and_what_is_allowed() {
    let body = json!({"p_d": 0, "method": {"method": "bat", "bats": 0, "wings": 2}, "times": [3, "x", 12], "q/r": 1});
    let faults = check(&body, &JOB).unwrap_err();
    let seen: Vec<_> = faults
        .iter()
        .map(|fault| {
            (
                fault.pointer.as_str(),
                fault.code.as_str(),
                fault.allowed.as_deref().unwrap(),
            )
        })
        .collect();
    let expected = [
        ("/p_d", "out_of_range", "(0, 1]"),
        ("/method/bats", "out_of_range", "[1, 100]"),
        ("/method/wings", "unknown_field", "method, bats"),
        ("/times", "out_of_range", "1 to 2 entries"),
        ("/times/1", "wrong_type", "a whole number"),
        ("/times/2", "out_of_range", "[0, 9]"),
        ("/q~1r", "unknown_field", "p_d, method, times"),
    ];
    assert_eq!(seen, expected);
}

#[test]
fn control_characters_are_refused_in_texts_and_in_both_sides_of_a_map() {
    static TEXTS: Object = Object {
        name: "Texts",
        summary: "",
        fields: &[
            super::super::optional("name", "", Kind::Text { max_length: 5 }),
            super::super::optional("labels", "", crate::registry::text_map(4, 5)),
        ],
    };
    let body = json!({"name": "a\u{0}b", "labels": {"k\n": "v", "kind": "\t", "long name": "v", "ok": "\u{7f}é"}});
    let found: Vec<_> = check(&body, &TEXTS)
        .unwrap_err()
        .into_iter()
        .map(|fault| (fault.pointer, fault.code, fault.detail))
        .collect();
    let control = |pointer: &str, what: &str| {
        (
            pointer.to_owned(),
            "control_character".to_owned(),
            format!("the text has the control character {what}"),
        )
    };
    let expected = [
        control("/name", "U+0000 at character 2"),
        control("/labels/k\n", "U+000A at character 2"),
        control("/labels/kind", "U+0009 at character 1"),
        (
            "/labels/long name".to_owned(),
            "too_large".to_owned(),
            "the text is too long".to_owned(),
        ),
    ];
    assert_eq!(found, expected);
}

#[test]
fn an_unknown_variant_lists_the_known_ones() {
    let faults = check(&json!({"p_d": 1, "method": {"method": "owl"}}), &JOB).unwrap_err();
    assert_eq!(faults.len(), 1);
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].allowed.as_deref()),
        ("/method/method", Some("bat, nearest"))
    );
}
