//! What of the limits of a request no table can see.

use super::draft::Draft;
use crate::model::fault::Fault;

/// Every limit has a bound; only a campaign has intervals and cells.
pub fn check_limits(draft: &mut Draft, is_campaign: bool) {
    let count = draft.length_of("limits").unwrap_or(0);
    for index in 0..count {
        let pointer = format!("/limits/{index}");
        let has = |draft: &Draft, name: &str| draft.at(&format!("{pointer}/{name}")).is_some();
        if !has(draft, "at_most") && !has(draft, "at_least") {
            let detail = "a limit needs 'at_most' or 'at_least'";
            draft.add([
                Fault::new(&pointer, "missing", detail).allowing("at_most, at_least, or both")
            ]);
        }
        let bounds: [Option<f64>; 2] =
            ["at_least", "at_most"].map(|name| draft.read(&format!("{pointer}/{name}")));
        if let [Some(least), Some(most)] = bounds
            && least > most
        {
            let detail = format!("no number is at least {least} and at most {most}");
            draft.add([Fault::new(
                format!("{pointer}/at_least"),
                "out_of_range",
                detail,
            )]);
        }
        if is_campaign {
            continue;
        }
        if draft.text_at(&format!("{pointer}/with")) == Some("interval") {
            let detail = "one run has no interval";
            let fault = Fault::new(format!("{pointer}/with"), "unsupported", detail);
            draft.add([fault.allowing("value, or a campaign")]);
        }
        if has(draft, "cell") {
            let detail = "only a campaign has cells";
            draft.add([Fault::new(format!("{pointer}/cell"), "unsupported", detail)]);
        }
    }
}
