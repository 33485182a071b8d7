//! Which sensor of the session each sensor of a file is.

use crate::model::fault::Fault;
use std::collections::BTreeMap;

pub(super) struct Mapping {
    /// As it was said.
    said: BTreeMap<String, String>,
    /// Sensors of the session.
    known: Vec<String>,
    /// The sensor of the file that is taken for the only one of the session, as nobody said otherwise.
    guessed: Option<String>,
    /// Nothing tells yet that the file has several sensors, or that the only one of the session is taken.
    may_guess: bool,
}

impl Mapping {
    /// # Errors
    /// A pair that is none, or a sensor that the session does not have.
    pub fn new(pairs: &[String], known: Vec<String>) -> Result<Self, Vec<Fault>> {
        let (mut said, mut faults) = (BTreeMap::new(), Vec::new());
        for pair in pairs {
            match pair.split_once('=') {
                Some((file, session)) if known.iter().any(|id| id == session) => {
                    said.insert(file.to_owned(), session.to_owned());
                }
                Some((_, session)) => {
                    let detail = format!("the session has no sensor '{session}'");
                    let fault = Fault::new("--sensor", "unknown_value", detail);
                    faults.push(fault.allowing(known.join(", ")));
                }
                None => {
                    let detail = format!("'{pair}' has no '='");
                    let fault = Fault::new("--sensor", "malformed", detail);
                    faults.push(fault.allowing("FILE_ID=SESSION_ID"));
                }
            }
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Mapping {
            said,
            known,
            guessed: None,
            may_guess: pairs.is_empty(),
        })
    }

    /// Says that the file has several sensors.
    pub fn know_several(&mut self) {
        self.may_guess = false;
    }

    /// The sensor of the session: as it was said, the one of the same name, or the only one of both.
    pub fn of(&mut self, file_id: &str) -> Option<&str> {
        if let Some(said) = self.said.get(file_id) {
            return Some(said);
        }
        if let Some(same) = self.known.iter().find(|known| *known == file_id) {
            self.may_guess = false;
            return self.guessed.is_none().then_some(same);
        }
        let [only] = self.known.as_slice() else {
            return None;
        };
        if !self.may_guess && self.guessed.is_none() {
            return None;
        }
        let guessed = self.guessed.get_or_insert_with(|| file_id.to_owned());
        (guessed == file_id).then_some(only.as_str())
    }

    /// Whether another sensor was taken for the only one before this one, which is none of the session's, was seen.
    pub fn guessed_wrong(&self) -> bool {
        self.guessed.is_some()
    }

    /// The fault of a sensor that is none of the session's.
    pub fn unknown(&self, file_id: &str) -> Fault {
        let detail = match &self.guessed {
            Some(first) => {
                format!("'{first}' was taken for the only sensor, but there is '{file_id}', too")
            }
            None => format!("nobody says which sensor of the session '{file_id}' is"),
        };
        let known = self.known.join(", ");
        let allowed = format!("--sensor '{file_id}=…' with one of {known}");
        Fault::new("--sensor", "missing", detail).allowing(allowed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mapping(pairs: &[&str], known: &[&str]) -> Mapping {
        let owned = |texts: &[&str]| {
            texts
                .iter()
                .map(|text| (*text).to_owned())
                .collect::<Vec<_>>()
        };
        Mapping::new(&owned(pairs), owned(known))
            .unwrap_or_else(|faults| unreachable!("{faults:?}"))
    }

    #[test]
    fn sensors_are_told_by_what_is_said_then_by_name_then_as_the_only_ones() {
        let mut several = mapping(&["25/1=north"], &["north", "south"]);
        assert_eq!(several.of("25/1"), Some("north"));
        assert_eq!(several.of("south"), Some("south"));
        assert_eq!(several.of("25/2"), None);
        let mut only = mapping(&[], &["radar"]);
        assert_eq!(only.of("25/2"), Some("radar"));
        assert!(
            only.of("25/3").is_none() && only.guessed_wrong(),
            "two cannot be one"
        );
        let mut of_several = mapping(&[], &["radar"]);
        of_several.know_several();
        assert_eq!(of_several.of("25/2"), None, "which of them?");
        assert_eq!(of_several.of("radar"), Some("radar"));
        assert!(!of_several.guessed_wrong());
        let mut by_name = mapping(&[], &["radar"]);
        assert_eq!(by_name.of("radar"), Some("radar"));
        assert_eq!(by_name.of("25/2"), None, "the only one is there already");
        assert_eq!(mapping(&["a=radar"], &["radar"]).of("b"), None);
    }

    #[test]
    fn what_is_said_must_be_there() {
        let found = Mapping::new(&["a=x".to_owned(), "b".to_owned()], vec!["r".to_owned()]);
        let faults = found.err().unwrap_or_default();
        let codes: Vec<&str> = faults.iter().map(|fault| fault.code.as_str()).collect();
        assert_eq!(codes, ["unknown_value", "malformed"]);
    }
}
