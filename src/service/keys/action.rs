//! What keys allow, and what each operation needs.

/// What a key may allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Action {
    Read,
    Jobs,
    Datasets,
    Push,
    Sessions,
    Keys,
}

impl Action {
    pub const ALL: [Action; 6] = [
        Action::Read,
        Action::Jobs,
        Action::Datasets,
        Action::Push,
        Action::Sessions,
        Action::Keys,
    ];
    /// As requests name them.
    pub const NAMES: [&str; 6] = ["read", "jobs", "datasets", "push", "sessions", "keys"];

    pub fn name(self) -> &'static str {
        Action::NAMES[self as usize]
    }

    pub fn from_name(name: &str) -> Option<Action> {
        Action::ALL.into_iter().find(|action| action.name() == name)
    }
}

/// What an operation needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// It answers everybody.
    Nothing,
    /// Any key does.
    AnyKey,
    Action(Action),
}

/// Tells nothing of what is kept: whether it lives, and how one gets in.
pub const OPEN: [&str; 5] = ["getHealth", "getReadiness", "getAccess", "login", "logout"];
/// Changes nothing, though the first sends a body and the others stand among what tells of the program alone.
const READING: [&str; 3] = ["validateJob", "getMetrics", "getUsage"];

/// What an operation needs, by its name, its first tag, and whether its method only reads.
pub fn need_of(operation: &str, tag: &str, only_reads: bool) -> Need {
    if OPEN.contains(&operation) {
        return Need::Nothing;
    }
    if READING.contains(&operation) {
        return Need::Action(Action::Read);
    }
    if operation == "pushScans" {
        return Need::Action(Action::Push);
    }
    match tag {
        "system" | "catalogue" => Need::AnyKey,
        "keys" => Need::Action(Action::Keys),
        _ if only_reads => Need::Action(Action::Read),
        "datasets" => Need::Action(Action::Datasets),
        "sessions" => Need::Action(Action::Sessions),
        // Work, its change and its end; what is new and not named here is no less.
        _ => Need::Action(Action::Jobs),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_have_names() {
        for action in Action::ALL {
            assert_eq!(Action::from_name(action.name()), Some(action));
        }
        assert_eq!(Action::from_name("all"), None);
    }
}
