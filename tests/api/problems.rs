//! What problems mean: for every code that the program knows, as JSON and as a page.

use crate::helpers::{Api, problem};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// What stands before the code of a problem in the sources.
const BEFORE: [&str; 6] = [
    "Problem::new(",
    "ApiError::new(",
    "ApiError::busy(",
    "conflict(",
    "code: ",
    "code @ ",
];

fn collect(folder: &Path, codes: &mut BTreeSet<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, codes);
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let shipped = text.split("#[cfg(test)]\nmod ").next().unwrap();
        for before in BEFORE {
            let after = shipped
                .split(before)
                .skip(1)
                .filter_map(|rest| rest.trim_start().strip_prefix('"'));
            codes.extend(
                after
                    .filter_map(|rest| rest.split('"').next())
                    .map(str::to_owned),
            );
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn every_problem_that_the_program_can_tell_is_explained_and_no_other() {
    let api = Api::start().await;
    let listed = api.get("/problems").await.ok(200);
    let items = listed["items"].as_array().unwrap();
    let explained: BTreeSet<String> = items
        .iter()
        .map(|item| item["code"].as_str().unwrap().to_owned())
        .collect();
    let mut used = BTreeSet::new();
    collect(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src/service"),
        &mut used,
    );
    // Told through `Problem::validation` and a helper.
    used.extend(["validation".to_owned()]);
    assert_eq!(explained, used);
    for item in items {
        let code = item["code"].as_str().unwrap();
        assert_eq!(&api.get(&format!("/problems/{code}")).await.ok(200), item);
        assert!(
            ["title", "cause", "remedy"]
                .iter()
                .all(|name| item[name].as_str().is_some_and(|text| !text.is_empty())),
            "{item}"
        );
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_problem_leads_to_its_meaning() {
    let api = Api::start().await;
    let told = api.get("/v1/nothing").await.json();
    let meaning = api.get(told["type"].as_str().unwrap()).await.ok(200);
    for member in ["code", "title", "status"] {
        assert_eq!(meaning[member], told[member]);
    }
    assert_eq!(
        meaning["cause"],
        "There is nothing with this path, id or name. The detail says which."
    );
    let answer = api.get("/problems/unheard_of").await;
    assert_eq!(answer.problem()["code"], "not_found");
    assert!(
        answer.problem()["detail"]
            .as_str()
            .unwrap()
            .starts_with("there is no problem 'unheard_of'; there are malformed_request, ")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_browser_gets_a_page() {
    let api = Api::start().await;
    let browser = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";
    let page = api
        .get_with("/problems/queue_full", "accept", browser)
        .await;
    assert_eq!(
        (
            page.header("content-type"),
            page.header("vary").contains("accept")
        ),
        ("text/html; charset=utf-8", true)
    );
    for text in [
        "<h1>The queue is full</h1>",
        "<p>503 · The queue is full</p>",
        "As many jobs are queued as the service takes.",
        "--queue-limit",
    ] {
        assert!(page.text.contains(text), "{}", page.text);
    }
    let all = api.get_with("/problems", "accept", browser).await;
    let listed: Value = api.get("/problems").await.ok(200);
    for item in listed["items"].as_array().unwrap() {
        assert!(
            all.text
                .contains(&format!("<h2 id=\"{}\">", item["code"].as_str().unwrap())),
            "{item}"
        );
    }
    assert_eq!(
        api.get_with("/problems/nothing", "accept", browser)
            .await
            .problem(),
        {
            let detail = api.get("/problems/nothing").await.problem()["detail"]
                .as_str()
                .unwrap()
                .to_owned();
            problem("not_found", 404, "There is no such thing", &detail)
        }
    );
}
