//! What of a request that tracks no table can see.

use super::{auto_filter, dry_run};
use crate::association::bat;
use crate::experiment::job::{Cost, InputRequest};
use crate::experiment::request::draft::Draft;
use crate::experiment::request::fields::{DEFAULT_ASSOCIATOR, DEFAULT_FILTER};
use crate::experiment::request::methods::{FilterChoice, NamedFilter};
use crate::filtering::FILTER_KIND;
use crate::model::fault::Fault;
use crate::registry::Kind;
use crate::tracking::{Confirmation, Initiation, LIFECYCLE, Lifecycle, poisson_multi_bernoulli};

/// Checks where the data come from and how they are tracked, if they are; tells what a simulation costs.
pub fn check_tracking(draft: &mut Draft, takes_detector: bool) -> Cost {
    draft.check_sources(takes_detector);
    auto_filter::settle_at_planning(draft);
    check_lifecycle(draft);
    let faults_before = draft.fault_count();
    let cost = draft.check_scenario();
    if draft.fault_count() == faults_before {
        dry_run::check(draft);
    }
    cost
}

/// For requests in which how to track is optional.
pub fn fill_tracking_defaults(draft: &mut Draft) {
    static TRACKER: Kind = Kind::Object(&LIFECYCLE);
    static ASSOCIATOR: Kind = Kind::Union(&crate::association::ASSOCIATOR);
    draft.put_default("associator", DEFAULT_ASSOCIATOR, &ASSOCIATOR);
    draft.put_default("filter", DEFAULT_FILTER, &FILTER_KIND);
    draft.put_default("tracker", "{}", &TRACKER);
}

/// The filter that the request names, where it does and its parameters are right.
pub fn named_filter(draft: &Draft) -> Option<NamedFilter> {
    match draft.read("/filter")? {
        FilterChoice::Named(filter) => Some(filter),
        FilterChoice::Auto => None,
    }
}

fn check_lifecycle(draft: &mut Draft) {
    let Some(lifecycle) = draft.read::<Lifecycle>("/tracker") else {
        return;
    };
    check_directions(draft, &lifecycle);
    check_undetected(draft, &lifecycle);
    if lifecycle.gate_probability == 1.0 {
        check_without_gate(draft, &lifecycle);
    }
    check_budget(draft);
    let (hits, window) = (lifecycle.confirm_hits, lifecycle.confirm_window);
    if hits > window {
        let detail = format!("{hits} detections cannot be found in {window} scans");
        draft.add([Fault::new("/tracker/confirm_hits", "out_of_range", detail)
            .allowing(format!("[1, {window}] (confirm_window)"))]);
    }
}

/// A filter of directions knows neither speeds nor positions.
fn check_directions(draft: &mut Draft, lifecycle: &Lifecycle) {
    let Some(NamedFilter { filter, name }) = named_filter(draft) else {
        return;
    };
    if filter.space().has_places() {
        return;
    }
    let mut refuse = |pointer: &str, needs: &str, allowed: &str| {
        let detail = format!("this needs {needs}, which the filter '{name}' does not know");
        draft.add([Fault::new(pointer, "unsupported", detail).allowing(allowed)]);
    };
    if let Initiation::TwoPoint { .. } = lifecycle.initiation {
        refuse(
            "/tracker/initiation/method",
            "speeds",
            "one_point, multi_scan, truth",
        );
    }
    if lifecycle.max_position_sigma_m.is_some() {
        refuse("/tracker/max_position_sigma_m", "positions", "no value");
    }
}

/// What a tracker of undetected targets does not take, and what no other does.
fn check_undetected(draft: &mut Draft, lifecycle: &Lifecycle) {
    let takes_it = draft.text_at("/tracker/method") == Some(poisson_multi_bernoulli::NAME);
    if !takes_it {
        if draft.at("/tracker/undetected").is_some() {
            let detail = "only the method 'poisson_multi_bernoulli' knows undetected targets";
            draft.add([
                Fault::new("/tracker/undetected", "unsupported", detail).allowing("no value")
            ]);
        }
        return;
    }
    if lifecycle.initiation != Initiation::OnePoint {
        let detail = "tracks begin from undetected targets";
        let fault = Fault::new("/tracker/initiation/method", "unsupported", detail);
        draft.add([fault.allowing("no value, or one_point, which is not used")]);
    }
    if lifecycle.confirmation != Confirmation::MOfN {
        let detail = "tracks are told by the existence that undetected.report_existence says";
        let fault = Fault::new("/tracker/confirmation/rule", "unsupported", detail);
        draft.add([fault.allowing("no value, or m_of_n, which is not used")]);
    }
    if draft.text_at("/associator/method") == Some("oracle") {
        let detail = "an undetected target has no detection that says where it comes from";
        let fault = Fault::new("/associator/method", "unsupported", detail);
        draft.add([fault.allowing("any other")]);
    }
    let births = draft.text_at("/tracker/undetected/births/method");
    let named = named_filter(draft).filter(|named| !named.filter.space().has_places());
    if let (Some("uniform" | "gaussian"), Some(named)) = (births, named) {
        let detail = format!(
            "this needs places, which the filter '{}' does not know",
            named.name
        );
        let fault = Fault::new("/tracker/undetected/births/method", "unsupported", detail);
        draft.add([fault.allowing("counted")]);
    }
}

/// Without a gate nothing is counted in it and no pair is out of its reach.
fn check_without_gate(draft: &mut Draft, lifecycle: &Lifecycle) {
    if draft.text_at("/associator/clutter") == Some("nonparametric") {
        let detail = "the detections of a gate are counted, and gate_probability 1 is no gate";
        draft
            .add([Fault::new("/associator/clutter", "unsupported", detail).allowing("parametric")]);
    }
    if let Initiation::TwoPoint { .. } | Initiation::MultiScan(_) = lifecycle.initiation {
        let detail = "points are put together within a gate, and gate_probability 1 is no gate";
        draft.add([
            Fault::new("/tracker/initiation/method", "unsupported", detail)
                .allowing("one_point, truth"),
        ]);
    }
}

/// A search that would never end in a tracker is refused.
fn check_budget(draft: &mut Draft) {
    let population = draft.count_at("/associator/population").unwrap_or(1);
    let iterations = draft.count_at("/associator/iterations").unwrap_or(1);
    let moves = population * iterations;
    if draft.text_at("/associator/method") == Some("bat") && moves > bat::MAX_MOVES {
        let detail =
            format!("{population} bats that move {iterations} times are {moves} moves a cluster");
        draft.add([Fault::new("/associator/iterations", "too_large", detail)
            .allowing(format!("population × iterations up to {}", bat::MAX_MOVES))]);
    }
}

/// Tracks that begin at the truth need it.
pub fn check_start(draft: &mut Draft, inputs: &[InputRequest]) {
    if draft.text_at("/tracker/initiation/method") == Some("truth")
        && !inputs.is_empty()
        && !draft.knows_truth(inputs)
    {
        let detail = "'truth' is required where tracks begin at it";
        draft
            .add([Fault::new("/truth", "missing", detail)
                .allowing("truth, or an input that knows it")]);
    }
}
