//! What is said of panics: of those that are caught while a file is read, and told as its fault, nothing.

use std::cell::RefCell;
use std::thread;

thread_local! {
    /// What panics said while a file is read on this thread; `None` at other times.
    static HELD: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
}

/// From now on panics within [`reading`] say something only where they end it.
pub fn hold_while_reading() {
    let tell = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let is_held = HELD.with_borrow_mut(|held| {
            let held = held.as_mut();
            held.map(|held| held.push(panic.to_string())).is_some()
        });
        if !is_held {
            tell(panic);
        }
    }));
}

/// Reads a file.
pub fn reading<T>(read: impl FnOnce() -> T) -> T {
    HELD.set(Some(Vec::new()));
    let _told = Told;
    read()
}

/// Tells what was held where nobody caught the panic.
struct Told;

impl Drop for Told {
    fn drop(&mut self) {
        let held = HELD.take().unwrap_or_default();
        if thread::panicking() {
            held.iter().for_each(|text| eprintln!("{text}"));
        }
    }
}
