//! JSON values of which only numbers and lists of numbers matter: anything else is read away.

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// What a visitor makes of every value that is neither an array nor an object.
macro_rules! visit_scalars {
    ($this:ident => $answer:expr) => {
        fn visit_bool<E: serde::de::Error>($this, _: bool) -> Result<Self::Value, E> {
            $answer
        }

        fn visit_i64<E: serde::de::Error>($this, _: i64) -> Result<Self::Value, E> {
            $answer
        }

        fn visit_u64<E: serde::de::Error>($this, _: u64) -> Result<Self::Value, E> {
            $answer
        }

        fn visit_f64<E: serde::de::Error>($this, _: f64) -> Result<Self::Value, E> {
            $answer
        }

        visit_texts!($this => $answer);
    };
}

/// The same of those that are no numbers either, but for `true` and `false`.
macro_rules! visit_texts {
    ($this:ident => $answer:expr) => {
        fn visit_str<E: serde::de::Error>($this, _: &str) -> Result<Self::Value, E> {
            $answer
        }

        fn visit_unit<E: serde::de::Error>($this) -> Result<Self::Value, E> {
            $answer
        }
    };
}

/// A visitor of any value as its own seed.
macro_rules! own_seed {
    ($visitor:ty => $value:ty) => {
        impl<'de> serde::de::DeserializeSeed<'de> for $visitor {
            type Value = $value;

            fn deserialize<D: serde::de::Deserializer<'de>>(
                self,
                deserializer: D,
            ) -> Result<$value, D::Error> {
                deserializer.deserialize_any(self)
            }
        }
    };
}

/// A value read by a visitor, asked for by one of the methods of a deserializer.
macro_rules! read_by {
    ($value:ty => $ask:ident($visitor:expr)) => {
        impl<'de> serde::Deserialize<'de> for $value {
            fn deserialize<D: serde::de::Deserializer<'de>>(
                deserializer: D,
            ) -> Result<Self, D::Error> {
                deserializer.$ask($visitor)
            }
        }
    };
}

pub(super) use {own_seed, read_by, visit_scalars, visit_texts};

/// A value of any shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) enum Loose {
    Number {
        value: f64,
        /// Where it is written as a whole number from 0 on.
        whole: Option<u64>,
    },
    Numbers(Vec<f64>),
    /// Two lists of numbers.
    Pair([Vec<f64>; 2]),
    #[default]
    Other,
}

impl Loose {
    pub fn number(&self) -> Option<f64> {
        if let Loose::Number { value, .. } = *self {
            Some(value)
        } else {
            None
        }
    }

    pub fn numbers(self) -> Option<Vec<f64>> {
        if let Loose::Numbers(numbers) = self {
            Some(numbers)
        } else {
            None
        }
    }
}

read_by!(Loose => deserialize_any(LooseVisitor { lists: true }));

/// A value that is a number, a list of numbers or nothing that matters.
struct Inner(Loose);

impl<'de> Deserialize<'de> for Inner {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer
            .deserialize_any(LooseVisitor { lists: false })
            .map(Inner)
    }
}

struct LooseVisitor {
    /// Whether lists may hold lists.
    lists: bool,
}

impl<'de> Visitor<'de> for LooseVisitor {
    type Value = Loose;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("any value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<Loose, E> {
        Ok(Loose::Other)
    }

    fn visit_u64<E>(self, value: u64) -> Result<Loose, E> {
        Ok(Loose::Number {
            value: value as f64,
            whole: Some(value),
        })
    }

    fn visit_i64<E>(self, value: i64) -> Result<Loose, E> {
        Ok(Loose::Number {
            value: value as f64,
            whole: u64::try_from(value).ok(),
        })
    }

    fn visit_f64<E>(self, value: f64) -> Result<Loose, E> {
        Ok(Loose::Number { value, whole: None })
    }

    visit_texts!(self => Ok(Loose::Other));

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Loose, A::Error> {
        while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Loose::Other)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Loose, A::Error> {
        let (mut numbers, mut lists) = (Vec::new(), Vec::new());
        while let Some(Inner(item)) = items.next_element()? {
            match item {
                Loose::Number { value, .. } if lists.is_empty() => numbers.push(value),
                Loose::Numbers(list) if self.lists && numbers.is_empty() && lists.len() < 2 => {
                    lists.push(list)
                }
                _ => {
                    while items.next_element::<IgnoredAny>()?.is_some() {}
                    return Ok(Loose::Other);
                }
            }
        }
        Ok(match (lists.len(), <[Vec<f64>; 2]>::try_from(lists)) {
            (0, _) => Loose::Numbers(numbers),
            (_, Ok(pair)) => Loose::Pair(pair),
            _ => Loose::Other,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_lists_are_kept_and_the_rest_is_read_away() {
        let read = |text: &str| serde_json::from_str::<Loose>(text).unwrap();
        assert_eq!(
            read("2"),
            Loose::Number {
                value: 2.0,
                whole: Some(2)
            }
        );
        assert_eq!(read("-2").number(), Some(-2.0));
        assert_eq!(
            read("2.0"),
            Loose::Number {
                value: 2.0,
                whole: None
            }
        );
        assert_eq!(read("[]"), Loose::Numbers(Vec::new()));
        assert_eq!(read("[1, -2.5]"), Loose::Numbers(vec![1.0, -2.5]));
        assert_eq!(
            read("[[1], [2, 3]]"),
            Loose::Pair([vec![1.0], vec![2.0, 3.0]])
        );
        for other in [
            "null",
            "true",
            "\"1\"",
            "{\"a\": [1]}",
            "[[1]]",
            "[[1], [2], [3]]",
            "[1, [2]]",
            "[[1], 2]",
            "[[[1]], [2]]",
            "[\"1\", 2]",
        ] {
            assert_eq!(read(other), Loose::Other, "{other}");
        }
    }
}
