//! One place of a string: a symbol or nothing, and how sure the tracker was.

/// ε in a list of symbols.
pub const EPSILON: u32 = u32::MAX;

/// What is at one scan of a string: a real symbol or ε (`None`), and the weight the tracker gave it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StringStep {
    pub symbol: Option<u32>,
    pub weight: f64,
}

impl StringStep {
    /// ε for want of anything said.
    pub const NOTHING: StringStep = StringStep {
        symbol: None,
        weight: 1.0,
    };

    pub fn certain(symbol: u32) -> Self {
        StringStep {
            symbol: Some(symbol),
            weight: 1.0,
        }
    }
}
