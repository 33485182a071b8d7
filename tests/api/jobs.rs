//! Asking for jobs and finding them.

use crate::helpers::{Api, id, problem, small};
use serde_json::{Value, json};
use std::collections::BTreeSet;

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_accepted_with_its_place_and_found_there() {
    let api = Api::start().await;
    let answer = api.post("/v1/jobs/simulate", &small()).await;
    let job = answer.ok(202);
    assert_eq!(
        (&job["kind"], &job["name"], &job["seed"]),
        (&json!("simulate"), &json!("small"), &json!(3))
    );
    assert_eq!(answer.header("location"), job["links"]["self"]);
    assert_eq!(answer.header("preference-applied"), "");
    assert_eq!(
        api.get(answer.header("location")).await.ok(200)["id"],
        job["id"]
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_preferred_wait_gives_the_ended_job() {
    let api = Api::start().await;
    let answer = api
        .post_with("/v1/jobs/simulate", &small(), "prefer", "wait=30")
        .await;
    assert_eq!(answer.ok(200)["state"], "succeeded");
    assert_eq!(answer.header("preference-applied"), "wait=30");
    let answer = api
        .post_with(
            "/v1/jobs/simulate",
            &crate::helpers::long(),
            "prefer",
            "wait=1",
        )
        .await;
    assert_ne!(answer.ok(202)["state"], "succeeded");
    assert_eq!(answer.header("preference-applied"), "wait=1");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_key_gives_the_same_job_again_and_no_other() {
    let api = Api::start().await;
    let first = api
        .post_with("/v1/jobs/simulate", &small(), "idempotency-key", "k1")
        .await;
    assert_eq!(first.header("idempotent-replayed"), "");
    let again = api
        .post_with("/v1/jobs/simulate", &small(), "idempotency-key", "k1")
        .await;
    assert_eq!(again.header("idempotent-replayed"), "true");
    assert_eq!(id(&again.ok(202)), id(&first.ok(202)));
    let other = api
        .post_with(
            "/v1/jobs/simulate",
            &crate::helpers::long(),
            "idempotency-key",
            "k1",
        )
        .await;
    let title = "The idempotency key belongs to another request";
    assert_eq!(
        other.problem(),
        problem(
            "idempotency_mismatch",
            422,
            title,
            "the idempotency key belongs to another request"
        )
    );
    let long_key = "k".repeat(256);
    let refused = api
        .post_with("/v1/jobs/simulate", &small(), "idempotency-key", &long_key)
        .await;
    assert_eq!(
        refused.problem()["errors"][0]["pointer"],
        "/headers/idempotency-key"
    );
    assert_eq!(api.get("/v1/jobs?count=true").await.ok(200)["total"], 1);
}

#[tokio::test(flavor = "multi_thread")]
async fn an_unchanged_job_is_not_sent_again() {
    let api = Api::start().await;
    let job = api.run("simulate", &small()).await;
    let path = job["links"]["self"].as_str().unwrap();
    let tag = api.get(path).await.header("etag").to_owned();
    assert!(tag.starts_with("W/\""), "{tag}");
    let answer = api.get_with(path, "if-none-match", &tag).await;
    assert_eq!(
        (
            answer.status.as_u16(),
            answer.text.as_str(),
            answer.header("etag")
        ),
        (304, "", tag.as_str())
    );
    assert_eq!(
        api.get_with(path, "if-none-match", "W/\"other\"")
            .await
            .status,
        200
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_walk_by_links_sees_every_job_once() {
    let api = Api::start().await;
    let mut wanted = BTreeSet::new();
    for number in 0..7 {
        let mut body = small();
        body["labels"] = json!({"number": number.to_string(), "all of": "us & them"});
        wanted.insert(id(&api.post("/v1/jobs/simulate", &body).await.ok(202)).to_owned());
    }
    let mut path = "/v1/jobs?limit=3&count=true&label=all%20of:us%20%26%20them".to_owned();
    let mut seen = Vec::new();
    loop {
        let answer = api.get(&path).await;
        let page = answer.ok(200);
        assert_eq!(page["total"], 7);
        seen.extend(
            page["items"]
                .as_array()
                .unwrap()
                .iter()
                .map(|job| id(job).to_owned()),
        );
        let link = answer.header("link");
        let Some(next) = link
            .strip_prefix('<')
            .and_then(|link| link.strip_suffix(">; rel=\"next\""))
        else {
            break;
        };
        assert!(next.ends_with(page["next_cursor"].as_str().unwrap()));
        path = next.to_owned();
    }
    assert_eq!(seen.len(), 7);
    assert_eq!(seen.into_iter().collect::<BTreeSet<_>>(), wanted);
    let one = api
        .get("/v1/jobs?label=number:4&label=all%20of:us%20%26%20them")
        .await
        .ok(200);
    assert_eq!(one["items"].as_array().unwrap().len(), 1);
    assert_eq!(one["items"][0]["labels"]["number"], "4");
}

#[tokio::test(flavor = "multi_thread")]
async fn lists_are_filtered_and_ordered() {
    let api = Api::start().await;
    let first = api.run("simulate", &small()).await;
    let second = api
        .run(
            "associate",
            &json!({"name": "Second", "input": {"source": "preset", "preset": "liang2009-10"}}),
        )
        .await;
    let ids = |page: Value| {
        page["items"]
            .as_array()
            .unwrap()
            .iter()
            .map(|job| id(job).to_owned())
            .collect::<Vec<_>>()
    };
    let list = async |query: &str| ids(api.get(&format!("/v1/jobs?{query}")).await.ok(200));
    let (first, second) = (id(&first).to_owned(), id(&second).to_owned());
    assert_eq!(list("").await, [second.clone(), first.clone()]);
    assert_eq!(
        list("sort=created_at").await,
        [first.clone(), second.clone()]
    );
    assert_eq!(
        list("kind=associate,evaluate").await,
        std::slice::from_ref(&second)
    );
    assert_eq!(list("state=failed").await, [""; 0]);
    assert_eq!(list("q=seco").await, std::slice::from_ref(&second));
    assert_eq!(
        list(&format!("q={first}")).await,
        std::slice::from_ref(&first)
    );
    assert_eq!(list("created_after=2999-01-01T00:00:00Z").await, [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cursor_that_is_not_ours_is_refused() {
    let api = Api::start().await;
    let expected = problem(
        "invalid_cursor",
        400,
        "The cursor is not one of ours",
        "the cursor is not one of ours",
    );
    assert_eq!(api.get("/v1/jobs?cursor=zzz").await.problem(), expected);
    assert_eq!(api.get("/v1/datasets?cursor=zzz").await.problem(), expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_spec_of_a_job_posted_again_is_the_same_job() {
    let api = Api::start().await;
    let body = json!({"input": {"source": "preset", "preset": "liang2009-10"}});
    let job = api.run("associate", &body).await;
    let spec = api
        .get(&format!("/v1/jobs/{}/spec", id(&job)))
        .await
        .ok(200);
    assert_eq!(
        (&spec["kind"], &spec["input"]["source"]),
        (&json!("associate"), &json!("scenario"))
    );
    assert_eq!(spec["tracker"]["confirm_hits"], 3);
    let again = api.run("associate", &spec).await;
    assert_eq!(again["spec_sha256"], job["spec_sha256"]);
    assert_eq!(again["duplicate_of"], job["id"]);
    // The metrics of an evaluation are filled in after everything else.
    let judged = api.run("evaluate", &body).await;
    let spec = api
        .get(&format!("/v1/jobs/{}/spec", id(&judged)))
        .await
        .ok(200);
    assert!(spec["metrics"].is_array());
    assert_eq!(
        api.run("evaluate", &spec).await["duplicate_of"],
        judged["id"]
    );
}
