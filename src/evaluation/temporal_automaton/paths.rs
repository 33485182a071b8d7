//! The automaton of decided strings, without a table of its own: the strings are its paths.
//!
//! A state is a place in the list of all symbols: what stands there is the only symbol that leads on, to the next place, and
//! where the string is closed the state is final. Inside a path each symbol is one scan later than the one before, so the
//! time needs to be told only to the start state.

use super::births::Births;
use super::search::{START, Transitions};
use crate::evaluation::strings::normal_form::{END, StringSet};

pub struct Paths<'s> {
    pub outputs: &'s StringSet,
    pub births: &'s Births,
}

impl Transitions for Paths<'_> {
    #[inline]
    fn each(&self, state: u32, time: u32, symbol: u32, mut go: impl FnMut(u32, f64)) {
        if state == START {
            for birth in self.births.on(time, symbol) {
                let first_step = self.outputs.strings()[birth.string as usize].first_step;
                go(first_step as u32 + 1, self.outputs.weight(first_step));
            }
        } else if self.outputs.symbols()[state as usize] == symbol {
            go(state + 1, self.outputs.weight(state as usize));
        }
    }

    fn is_final(&self, state: u32) -> bool {
        state != START && self.outputs.symbols()[state as usize] == END
    }
}
