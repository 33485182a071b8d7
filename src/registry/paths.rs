//! The places that a table knows in a value, for who has mistyped one.

use super::{Kind, Object, place::join};
use serde_json::Value;

/// The JSON pointer nearest to `wanted`, by edit distance, among the fields that `object` has where the variants of its unions are those
/// of `value`, all of them where it has none. `None` of a table without fields.
pub fn nearest_path(wanted: &str, value: &Value, object: &'static Object) -> Option<String> {
    let mut known = Vec::new();
    visit_object(value, object, "", &mut known);
    nearest_of(wanted, known)
}

/// The text nearest to `wanted`, by edit distance.
pub fn nearest_of(wanted: &str, known: Vec<String>) -> Option<String> {
    known
        .into_iter()
        .min_by_key(|path| edit_distance(path, wanted))
}

fn visit_object(value: &Value, object: &'static Object, pointer: &str, known: &mut Vec<String>) {
    for field in object.fields {
        visit(
            &value[field.name],
            &field.kind,
            join(pointer, field.name),
            known,
        );
    }
}

fn visit(value: &Value, kind: &'static Kind, pointer: String, known: &mut Vec<String>) {
    match kind {
        Kind::Object(object) => visit_object(value, object, &pointer, known),
        Kind::Union(union) => {
            known.push(join(&pointer, union.tag));
            let tag = &value[union.tag];
            for variant in (union.variants)()
                .iter()
                .filter(|variant| tag.is_null() || tag == variant.tag)
            {
                visit_object(value, variant.object, &pointer, known);
            }
        }
        Kind::List { item, .. } => {
            let items = value.as_array().into_iter().flatten().enumerate();
            items
                .for_each(|(index, entry)| visit(entry, item, format!("{pointer}/{index}"), known));
        }
        _ => {}
    }
    known.push(pointer);
}

/// The least number of letters to be put in, taken out or changed (Levenshtein 1966).
fn edit_distance(left: &str, right: &str) -> usize {
    let right: Vec<char> = right.chars().collect();
    let mut row: Vec<usize> = (0..=right.len()).collect();
    for (line, letter) in left.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (column, other) in right.iter().enumerate() {
            let changed = diagonal + usize::from(letter != *other);
            diagonal = row[column + 1];
            row[column + 1] = changed.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[right.len()]
}

#[cfg(test)]
mod tests {
    use super::super::{Union, Variant, list, optional};
    use super::*;
    use serde_json::json;

    #[test]
    fn letters_put_in_taken_out_and_changed_are_counted() {
        let of = |left, right| edit_distance(left, right);
        assert_eq!(
            (
                of("kitten", "sitting"),
                of("", "abc"),
                of("abc", ""),
                of("σx", "σy")
            ),
            (3, 3, 3, 1)
        );
    }

    static BAT: Object = Object {
        name: "Bat",
        summary: "",
        fields: &[optional("bats", "", Kind::Flag)],
    };
    static OWL: Object = Object {
        name: "Owl",
        summary: "",
        fields: &[optional("owls", "", Kind::Flag)],
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
                    tag: "owl",
                    object: &OWL,
                },
            ]
        },
    };
    static JOB: Object = Object {
        name: "Job",
        summary: "",
        fields: &[
            optional("night", "", Kind::Union(&METHOD)),
            optional("nights", "", list(&Kind::Union(&METHOD), 0, 9)),
        ],
    };

    #[test]
    fn the_nearest_place_is_one_that_the_value_can_have() {
        let near = |wanted, value: &Value| nearest_path(wanted, value, &JOB).unwrap();
        assert_eq!(
            near("/nigth/bats", &json!({"night": {"method": "bat"}})),
            "/night/bats"
        );
        assert_eq!(
            near("/night/owls", &json!({"night": {"method": "bat"}})),
            "/night/bats"
        );
        assert_eq!(near("/night/owl", &json!({})), "/night/owls");
        assert_eq!(
            near(
                "/nights/1/bat",
                &json!({"nights": [{"method": "owl"}, {"method": "bat"}]})
            ),
            "/nights/1/bats"
        );
        assert_eq!(near("/methud", &json!({})), "/night");
    }
}
