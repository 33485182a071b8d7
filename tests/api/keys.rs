//! Keys: every operation with every action, and what ends a key.

use crate::helpers::{Answer, Api, send};
use reqwest::Method;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use trackloom::service::keys::MasterKey;

const MASTER: &str = "a-master-key-of-16-and-more-bytes";
const ACTIONS: [&str; 6] = ["read", "jobs", "datasets", "push", "sessions", "keys"];

/// What each operation needs, written down once more: "" is nothing, "any" any key.
const NEEDS: &[(&str, &str)] = &[
    ("", "getAccess getHealth getReadiness login logout"),
    (
        "any",
        "getMethod getPreset getProblemType getVersion listMethods listPresets listProblemTypes",
    ),
    (
        "read",
        "compareJobs downloadDataset downloadJobArtifact getCampaignCells getDataset getJob getJobHistory getJobPlan getJobReport \
         getJobReportPage getJobSeries getJobSpec getMetrics getSession getSessionHistory getSessionPicture getSessionTrack getUsage listDatasets \
         listJobArtifacts listJobs listSessionTracks listSessions previewDataset streamJobEvents streamSessionEvents validateJob",
    ),
    (
        "jobs",
        "cancelJob createAssociateJob createCampaignJob createCorrelateJob createEvaluateJob createGroupJob createJob createSimulateJob \
         deleteJob rerunJob updateJob",
    ),
    ("datasets", "deleteDataset uploadDataset uploadRawDataset"),
    ("push", "pushScans"),
    (
        "sessions",
        "beginSessionTrack closeSession createSession deleteSession endSessionTrack pauseSession recordSession resumeSession",
    ),
    ("keys", "createKey listKeys revokeKey"),
];

async fn locked() -> Api {
    Api::start_with(|config| config.master_key = Some(MasterKey::new(MASTER).unwrap())).await
}

async fn ask(api: &Api, key: Option<&str>, method: Method, path: &str, body: &Value) -> Answer {
    let mut request = api.request(method.clone(), path);
    if let Some(key) = key {
        request = request.bearer_auth(key);
    }
    if method != Method::GET && method != Method::DELETE {
        request = request.json(body);
    }
    send(request).await
}

/// The key that is made of this, with its id.
async fn made(api: &Api, by: &str, body: &Value) -> (String, String) {
    let made = ask(api, Some(by), Method::POST, "/v1/keys", body)
        .await
        .ok(201);
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    (text(&made["key"]), text(&made["info"]["id"]))
}

async fn key_of(api: &Api, actions: &[&str]) -> String {
    made(api, MASTER, &json!({"name": "a test", "actions": actions}))
        .await
        .0
}

/// Method and a path that names nothing, of every operation.
async fn operations(api: &Api) -> BTreeMap<String, (Method, String)> {
    let document = ask(api, Some(MASTER), Method::GET, "/openapi.json", &json!({}))
        .await
        .ok(200);
    let mut operations = BTreeMap::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        let path = path
            .replace("{id}", "00000000-0000-7000-8000-000000000001")
            .replace("{name}", "nobody")
            .replace("{family}", "nothing")
            .replace("{code}", "gone");
        for (method, operation) in item.as_object().unwrap() {
            let method = Method::from_bytes(method.to_uppercase().as_bytes()).unwrap();
            let id = operation["operationId"].as_str().unwrap().to_owned();
            operations.insert(id, (method, path.clone()));
        }
    }
    operations
}

#[tokio::test(flavor = "multi_thread")]
async fn every_operation_is_open_to_the_action_that_it_needs_and_to_no_other() {
    let api = locked().await;
    let operations = operations(&api).await;
    let mut needs = BTreeMap::new();
    for (need, names) in NEEDS {
        needs.extend(
            names
                .split_whitespace()
                .map(|name| (name.to_owned(), *need)),
        );
    }
    let known: Vec<&String> = needs.keys().collect();
    assert_eq!(known, operations.keys().collect::<Vec<_>>());
    let mut keys = vec![("none", None), ("wrong", Some("tlk_0_0".to_owned()))];
    for action in ACTIONS {
        keys.push((action, Some(key_of(&api, &[action]).await)));
    }
    for (name, (method, path)) in &operations {
        let need = needs[name];
        for (action, key) in &keys {
            let answer = ask(&api, key.as_deref(), method.clone(), path, &json!({})).await;
            let is_key = ACTIONS.contains(action);
            let wanted = match need {
                "" => None,
                _ if !is_key => Some(401),
                "any" => None,
                _ => (*action != need).then_some(403),
            };
            let status = answer.status.as_u16();
            let refused = [401, 403].contains(&status).then_some(status);
            // Signing in without a key is refused by the operation itself.
            assert_eq!(refused, wanted, "{name} with {action}: {}", answer.text);
            if status == 401 {
                assert_eq!(
                    answer.header("www-authenticate"),
                    "Bearer realm=\"trackloom\""
                );
                assert_eq!(answer.problem()["type"], "/problems/unauthenticated");
            }
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stolen_read_key_changes_nothing() {
    let api = locked().await;
    let body = json!({"input": {"source": "preset", "preset": "liang2009-10"}});
    let job = ask(&api, Some(MASTER), Method::POST, "/v1/jobs/evaluate", &body).await;
    let path = job.header("location").to_owned();
    let stolen = key_of(&api, &["read"]).await;
    let before = ask(
        &api,
        Some(&stolen),
        Method::GET,
        "/v1/jobs?count=true",
        &json!({}),
    )
    .await;
    let before = before.ok(200)["total"].clone();
    for (method, path) in operations(&api).await.into_values() {
        if method != Method::GET && !path.ends_with("/logout") {
            ask(&api, Some(&stolen), method, &path, &body).await;
        }
    }
    for (method, path) in [
        (Method::POST, format!("{path}/cancel")),
        (Method::POST, format!("{path}/rerun")),
        (Method::PATCH, path.clone()),
        (Method::DELETE, path.clone()),
    ] {
        let answer = ask(&api, Some(&stolen), method, &path, &json!({"name": "mine"})).await;
        assert_eq!(answer.status.as_u16(), 403, "{path}");
    }
    let after = ask(
        &api,
        Some(&stolen),
        Method::GET,
        "/v1/jobs?count=true",
        &json!({}),
    )
    .await;
    assert_eq!(after.ok(200)["total"], before);
    let job = ask(&api, Some(&stolen), Method::GET, &path, &json!({}))
        .await
        .ok(200);
    assert!(job["state"] != json!("canceled") && job["name"] != json!("mine"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_key_ends_when_it_is_revoked_or_old_or_asks_too_often() {
    let api = locked().await;
    let get = async |key: &str| ask(&api, Some(key), Method::GET, "/v1/jobs", &json!({})).await;
    let read = |more: Value| {
        let mut body = json!({"name": "short", "actions": ["read"]});
        body.as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        body
    };
    let (key, id) = made(&api, MASTER, &read(json!({}))).await;
    get(&key).await.ok(200);
    let list = ask(&api, Some(MASTER), Method::GET, "/v1/keys", &json!({})).await;
    assert!(!list.text.contains(&key) && list.text.contains(&id));
    let path = format!("/v1/keys/{id}");
    let revoked = ask(&api, Some(MASTER), Method::DELETE, &path, &json!({})).await;
    assert_eq!(revoked.status.as_u16(), 204);
    let refused = get(&key).await.problem();
    assert_eq!(refused["detail"], "the key was revoked");
    let again = ask(&api, Some(MASTER), Method::DELETE, &path, &json!({})).await;
    assert_eq!(again.status.as_u16(), 404);

    // A tenth of a second.
    let (key, _) = made(&api, MASTER, &read(json!({"expires_in_days": 1.2e-6}))).await;
    tokio::time::sleep(std::time::Duration::from_millis(150)).await;
    let refused = get(&key).await.problem();
    assert_eq!(
        (&refused["status"], &refused["detail"]),
        (&json!(401), &json!("the key has ended"))
    );

    let (key, _) = made(&api, MASTER, &read(json!({"requests_per_minute": 2}))).await;
    get(&key).await.ok(200);
    get(&key).await.ok(200);
    let often = get(&key).await;
    assert_eq!(often.status.as_u16(), 429);
    assert!(often.header("retry-after").parse::<u64>().unwrap() >= 1);
    assert_eq!(often.problem()["type"], "/problems/too_many_requests");
}

#[tokio::test(flavor = "multi_thread")]
async fn nobody_gives_away_what_is_not_theirs() {
    let api = locked().await;
    let body = json!({"name": "maker", "actions": ["keys", "read"], "expires_in_days": 1.0});
    let (maker, _) = made(&api, MASTER, &body).await;
    let more = json!({"name": "x", "actions": ["read", "jobs"], "expires_in_days": 2.0});
    let refused = ask(&api, Some(&maker), Method::POST, "/v1/keys", &more)
        .await
        .problem();
    let places: Vec<&str> = refused["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| fault["pointer"].as_str().unwrap())
        .collect();
    assert_eq!(places, ["/actions/1", "/expires_in_days"]);
    let forever = json!({"name": "x", "actions": ["read"]});
    let refused = ask(&api, Some(&maker), Method::POST, "/v1/keys", &forever).await;
    assert_eq!(refused.status.as_u16(), 422);
    let fewer = json!({"name": "x", "actions": ["read"], "expires_in_days": 0.5});
    made(&api, &maker, &fewer).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_page_signs_in_with_a_cookie_that_other_sites_cannot_use() {
    let api = locked().await;
    // The page itself tells nothing.
    assert_eq!(api.get("/").await.status.as_u16(), 200);
    let asked = api.get("/v1/access").await.ok(200);
    assert_eq!(
        asked,
        json!({"is_needed": true, "is_given": false, "actions": []})
    );
    let wrong = api.post("/v1/login", &json!({"key": "x"})).await;
    assert_eq!(wrong.status.as_u16(), 401);
    let key = key_of(&api, &["read", "jobs"]).await;
    let signed = api.post("/v1/login", &json!({"key": key})).await;
    assert_eq!(signed.status.as_u16(), 204);
    let cookie = signed.header("set-cookie").to_owned();
    assert!(
        cookie.ends_with("; Path=/; HttpOnly; SameSite=Strict"),
        "{cookie}"
    );
    let cookie = cookie.split(';').next().unwrap();
    let who = api.get_with("/v1/access", "cookie", cookie).await.ok(200);
    assert_eq!(
        (&who["is_given"], &who["actions"]),
        (&json!(true), &json!(["read", "jobs"]))
    );
    api.get_with("/v1/jobs", "cookie", cookie).await.ok(200);
    let body = json!({"input": {"source": "preset", "preset": "liang2009-10"}});
    let request = api.request(Method::POST, "/v1/jobs/evaluate").json(&body);
    let request = request
        .header("cookie", cookie)
        .header("origin", "https://evil.example");
    assert_eq!(
        send(request).await.problem()["type"],
        "/problems/cross_site"
    );
    let out = api.post("/v1/logout", &json!({})).await;
    assert!(out.header("set-cookie").starts_with("trackloom_key=; "));
    assert!(out.header("set-cookie").contains("Max-Age=0"));
}

#[tokio::test(flavor = "multi_thread")]
async fn without_a_master_key_nobody_is_asked() {
    let api = Api::start().await;
    let asked = api.get("/v1/access").await.ok(200);
    assert_eq!(
        asked,
        json!({"is_needed": false, "is_given": true, "actions": ACTIONS})
    );
    let refused = api
        .post("/v1/keys", &json!({"name": "x", "actions": ["read"]}))
        .await;
    assert!(
        refused.problem()["detail"]
            .as_str()
            .unwrap()
            .contains("needs no keys")
    );
}
