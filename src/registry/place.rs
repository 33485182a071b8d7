//! Where in a document a value stands.

/// A chain of steps from the outside in. It becomes a JSON pointer only where a fault tells it, for most values have none.
#[derive(Clone, Copy)]
pub enum Place<'p> {
    /// What a pointer names, "" the whole document.
    Pointer(&'p str),
    Member(&'p Place<'p>, &'p str),
    Item(&'p Place<'p>, usize),
}

impl From<&Place<'_>> for String {
    /// The pointer, escaped as RFC 6901 says.
    fn from(place: &Place) -> String {
        match place {
            Place::Pointer(pointer) => (*pointer).to_owned(),
            Place::Member(outer, name) => join(&String::from(*outer), name),
            Place::Item(outer, index) => format!("{}/{index}", String::from(*outer)),
        }
    }
}

/// `pointer` with one more step, escaped as RFC 6901 says.
pub fn join(pointer: &str, step: &str) -> String {
    format!("{pointer}/{}", step.replace('~', "~0").replace('/', "~1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_told_as_a_pointer() {
        let outer = Place::Pointer("/input");
        let list = Place::Member(&outer, "a/b~c");
        assert_eq!(String::from(&Place::Item(&list, 7)), "/input/a~1b~0c/7");
        assert_eq!(String::from(&Place::Pointer("")), "");
    }
}
