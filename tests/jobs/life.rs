//! The life of one job, and of jobs that need each other.

use crate::support::{long, of_job, small, start, start_with};
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use trackloom::service::error::ServiceError;
use trackloom::service::jobs::JobPatch;
use trackloom::service::types::{Event, JobKind, JobState};
use uuid::Uuid;

fn states(events: &[Event]) -> Vec<JobState> {
    events
        .iter()
        .filter_map(|event| {
            if let Event::State(event) = event {
                Some(event.data.state)
            } else {
                None
            }
        })
        .collect()
}

fn code(error: ServiceError) -> &'static str {
    match error {
        ServiceError::Conflict { code, .. } => code,
        other => panic!("not a conflict: {other}"),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_queued_runs_and_succeeds_and_its_events_are_numbered_from_one() {
    let service = start().await;
    let job = service.submit_ok(JobKind::Simulate, small(7)).await;
    assert_eq!(
        (job.state, job.attempt, job.seed, job.can_cancel),
        (JobState::Queued, 0, 7, true)
    );
    let job = service.succeeded(job.id).await;
    assert_eq!((job.attempt, job.can_cancel, job.error), (1, false, None));
    assert_eq!(job.progress.unwrap().fraction, 1.0);
    assert!(job.created_at <= job.started_at.unwrap() && job.started_at <= job.finished_at);

    let events = service.all_events(job.id).await;
    let numbers: Vec<u64> = events.iter().map(Event::seq).collect();
    assert_eq!(numbers, (1..=events.len() as u64).collect::<Vec<_>>());
    assert_eq!(
        states(&events),
        [JobState::Queued, JobState::Running, JobState::Succeeded]
    );
    assert!(
        events.last().unwrap().is_last()
            && events.iter().filter(|event| event.is_last()).count() == 1
    );

    let page = service.history(job.id, 2, Duration::ZERO).await.unwrap();
    assert_eq!(page.events, events[2..]);
    assert_eq!(page.next_after, events.len() as u64);
    let nothing = service
        .history(job.id, page.next_after, Duration::from_secs(30))
        .await
        .unwrap();
    assert!(
        nothing.events.is_empty() && nothing.next_after == page.next_after,
        "a job that has ended has no news to wait for"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_report_says_what_was_run_and_its_result_is_the_same_each_time() {
    let service = start().await;
    let body = json!({"scenario": small(1)["scenario"], "seed": 5, "name": "first", "labels": {"team": "a"}});
    let first = service.submit_ok(JobKind::Simulate, body).await;
    assert_eq!(
        (
            first.name.as_deref(),
            first.labels["team"].as_str(),
            first.duplicate_of
        ),
        (Some("first"), "a", None)
    );
    service.succeeded(first.id).await;
    let again = service.rerun(first.id).await.unwrap();
    assert_eq!(
        (again.rerun_of, again.duplicate_of),
        (Some(first.id), Some(first.id))
    );
    assert_eq!(
        (again.name.as_deref(), &again.spec_sha256),
        (Some("first"), &first.spec_sha256)
    );
    service.succeeded(again.id).await;

    let text = |report: &Value| serde_json::to_string(&report["result"]).unwrap();
    let (one, two) = (
        service.report_of(first.id).await,
        service.report_of(again.id).await,
    );
    assert_eq!(text(&one), text(&two));
    assert_eq!(
        (&one["kind"], &one["seed"], &one["job_id"]),
        (&json!("simulate"), &json!(5), &json!(first.id))
    );
    assert_eq!(one["spec"], service.spec(first.id).await.unwrap());
    assert_eq!(one["engine_version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(one["result"]["counts"]["targets"], 3);
    assert!(
        one["timing"]["total_s"].as_f64().unwrap() >= one["timing"]["simulate_s"].as_f64().unwrap()
    );

    let (one, two) = (
        service.artifacts(first.id).await.unwrap().items,
        service.artifacts(again.id).await.unwrap().items,
    );
    let names: Vec<&str> = one.iter().map(|artifact| artifact.name.as_str()).collect();
    assert_eq!(names, ["detections.csv", "truth.csv", "report.json"]);
    assert_eq!(
        (&one[0].sha256, &one[1].sha256),
        (&two[0].sha256, &two[1].sha256)
    );
    assert_ne!(
        one[0].dataset_id, two[0].dataset_id,
        "each job has datasets of its own, over the same file"
    );
    let file = service.artifact(first.id, "truth.csv").await.unwrap();
    assert_eq!(
        crate::support::sha256(&file.content.read().unwrap()),
        file.sha256
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_chain_runs_in_order_and_each_job_reads_what_the_one_before_made() {
    let service = start().await;
    let simulate = service.submit_ok(JobKind::Simulate, small(1)).await;
    let associate = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(simulate.id)}))
        .await;
    let evaluate = service
        .submit_ok(JobKind::Evaluate, json!({"tracks": of_job(associate.id)}))
        .await;
    assert_eq!(
        (associate.depends_on.clone(), evaluate.depends_on.clone()),
        (vec![simulate.id], vec![associate.id])
    );
    let evaluate = service.succeeded(evaluate.id).await;
    let (simulate, associate) = (
        service.get(simulate.id).await.unwrap(),
        service.get(associate.id).await.unwrap(),
    );
    assert!(
        simulate.finished_at <= associate.started_at
            && associate.finished_at <= evaluate.started_at
    );

    let report = service.report_of(evaluate.id).await;
    let read: Vec<(&str, &str)> = report["inputs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|input| {
            (
                input["role"].as_str().unwrap(),
                input["job_id"].as_str().unwrap(),
            )
        })
        .collect();
    let id = associate.id.to_string();
    assert_eq!(
        read,
        [("tracks", id.as_str()), ("detections", &id), ("truth", &id)]
    );
    let tracks = service.artifact(associate.id, "tracks.csv").await.unwrap();
    assert_eq!(report["inputs"][0]["sha256"], tracks.sha256);
    assert_eq!(report["result"]["tfa"]["counts"]["targets"], 3);
    let layers = service.load_job_layers(evaluate.id).await.unwrap();
    assert_eq!(layers.truth.as_ref().unwrap().targets().len(), 3);
    assert_eq!(layers.detections.as_ref().unwrap().scans.len(), 10);
    assert_eq!(
        layers.tracks.as_ref().unwrap().tracks.len(),
        report["result"]["tfa"]["counts"]["output_tracks"]
            .as_u64()
            .unwrap() as usize
    );
    assert_eq!(layers.sensors[0].p_d, Some(0.9));
}

#[tokio::test(flavor = "multi_thread")]
async fn who_needs_a_job_that_does_not_succeed_fails_with_it_down_the_chain() {
    let service = start().await;
    let first = service.submit_ok(JobKind::Simulate, long()).await;
    let second = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(first.id)}))
        .await;
    let third = service
        .submit_ok(JobKind::Evaluate, json!({"tracks": of_job(second.id)}))
        .await;
    service.cancel(first.id).await.unwrap();
    let second = service.ended(second.id).await;
    let third = service.ended(third.id).await;
    for (job, needed, how) in [
        (&second, first.id, "was canceled"),
        (&third, second.id, "failed"),
    ] {
        let error = job.error.clone().unwrap();
        assert_eq!(
            (job.state, job.attempt, error.code.as_str(), error.status),
            (JobState::Failed, 0, "dependency_failed", 409)
        );
        assert_eq!(
            error.detail,
            format!("job {needed}, whose result this job needs, {how}")
        );
    }
    let late = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(first.id)}))
        .await;
    assert_eq!(
        (late.state, late.error.unwrap().code.as_str()),
        (JobState::Failed, "dependency_failed")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_queued_job_is_canceled_at_once_and_a_running_one_within_a_second() {
    let service = start_with(|config| config.slots = 1).await;
    let running = service.submit_ok(JobKind::Simulate, long()).await;
    let queued = service.submit_ok(JobKind::Simulate, small(1)).await;
    service.in_progress(running.id).await;
    assert_eq!(
        service.cancel(queued.id).await.unwrap().state,
        JobState::Canceled
    );
    let asked = service.cancel(running.id).await.unwrap();
    let since = Instant::now();
    assert!(asked.cancel_requested_at.is_some() && !asked.can_cancel);
    let job = service.ended(running.id).await;
    assert_eq!((job.state, job.error), (JobState::Canceled, None));
    assert!(
        since.elapsed() < Duration::from_secs(1),
        "{:?}",
        since.elapsed()
    );
    assert_eq!(
        code(service.cancel(running.id).await.unwrap_err()),
        "job_terminal"
    );
    assert_eq!(
        code(service.report(running.id).await.unwrap_err()),
        "job_failed"
    );
    let after = service.submit_ok(JobKind::Simulate, small(2)).await;
    service.succeeded(after.id).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_over_its_time_limit_fails_and_frees_its_slot() {
    let service = start_with(|config| {
        config.slots = 1;
        config.job_time_limit = Duration::from_millis(300);
    })
    .await;
    let job = service.submit_ok(JobKind::Simulate, long()).await;
    let job = service.ended(job.id).await;
    let error = job.error.unwrap();
    assert_eq!(
        (job.state, error.code.as_str()),
        (JobState::Failed, "time_limit")
    );
    assert_eq!(error.detail, "the job ran longer than 0.3 s");
    let next = service.submit_ok(JobKind::Simulate, small(1)).await;
    service.succeeded(next.id).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn progress_rises_and_comes_at_most_four_times_a_second() {
    let service = start().await;
    let job = service.submit_ok(JobKind::Simulate, long()).await;
    tokio::time::sleep(Duration::from_millis(1500)).await;
    service.cancel(job.id).await.unwrap();
    service.ended(job.id).await;
    let progress: Vec<_> = service
        .all_events(job.id)
        .await
        .into_iter()
        .filter_map(|event| {
            if let Event::Progress(event) = event {
                Some((event.at, event.data.fraction))
            } else {
                None
            }
        })
        .collect();
    assert!((2..=8).contains(&progress.len()), "{progress:?}");
    assert!(
        progress.is_sorted()
            && progress
                .iter()
                .all(|(_, fraction)| (0.0..=1.0).contains(fraction)),
        "{progress:?}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn faults_that_only_the_data_shows_fail_the_job_with_all_of_them() {
    let service = start().await;
    let simulate = service.submit_ok(JobKind::Simulate, small(1)).await;
    let body = json!({"input": {"source": "job", "job_id": simulate.id, "sensor_ids": ["radar", "sonar", "lidar"]}});
    let job = service.submit_ok(JobKind::Associate, body).await;
    let job = service.ended(job.id).await;
    let error = job.error.unwrap();
    assert_eq!(
        (job.state, error.code.as_str(), error.status),
        (JobState::Failed, "validation", 422)
    );
    let places: Vec<(&str, Option<&str>)> = error
        .errors
        .iter()
        .map(|fault| (fault.pointer.as_str(), fault.allowed.as_deref()))
        .collect();
    assert_eq!(
        places,
        [
            ("/input/sensor_ids/1", Some("radar")),
            ("/input/sensor_ids/2", Some("radar"))
        ]
    );
    let no_tracks = service
        .submit_ok(JobKind::Evaluate, json!({"tracks": of_job(simulate.id)}))
        .await;
    let error = service.ended(no_tracks.id).await.error.unwrap();
    assert_eq!(
        (
            error.errors[0].pointer.as_str(),
            error.errors[0].code.as_str()
        ),
        ("/tracks/job_id", "not_found")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn an_error_inside_the_service_fails_the_job_and_says_nothing_of_the_inside() {
    let service = start().await;
    let simulate = service.submit_ok(JobKind::Simulate, small(1)).await;
    service.succeeded(simulate.id).await;
    let artifact = service.artifact(simulate.id, "detections.csv").await;
    std::fs::remove_file(service.blob(&artifact.unwrap().sha256)).unwrap();
    let job = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(simulate.id)}))
        .await;
    let job = service.ended(job.id).await;
    let error = job.error.unwrap();
    assert_eq!(
        (job.state, error.code.as_str(), error.status),
        (JobState::Failed, "internal", 500)
    );
    assert_eq!(
        error.detail,
        "the job failed inside the service; its log says why"
    );
    let next = service.submit_ok(JobKind::Simulate, small(2)).await;
    service.succeeded(next.id).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn unknown_sources_are_refused_where_the_request_names_them() {
    let service = start().await;
    let missing = Uuid::now_v7();
    let faults = service
        .refused(JobKind::Associate, json!({"input": of_job(missing)}))
        .await;
    assert_eq!(faults.len(), 1);
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/input/job_id", "not_found")
    );
    let dataset = json!({"source": "dataset", "dataset_id": missing});
    let body = json!({"tracks": dataset, "detections": dataset, "truth": of_job(missing)});
    let pointers: Vec<String> = service
        .refused(JobKind::Evaluate, body.clone())
        .await
        .into_iter()
        .map(|fault| fault.pointer)
        .collect();
    assert_eq!(
        pointers,
        [
            "/tracks/dataset_id",
            "/detections/dataset_id",
            "/truth/job_id"
        ]
    );
    let checked = service.validate(JobKind::Evaluate, body).await.unwrap();
    assert_eq!((checked.faults.len(), checked.estimate), (3, None));
    assert!(
        service
            .validate(JobKind::Simulate, small(1))
            .await
            .unwrap()
            .estimate
            .unwrap()
            .detections
            > 0
    );
    assert!(
        service
            .list(Default::default())
            .await
            .unwrap()
            .items
            .is_empty()
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn only_a_job_that_has_ended_and_that_nobody_needs_can_be_deleted() {
    let service = start_with(|config| config.slots = 1).await;
    let done = service.submit_ok(JobKind::Simulate, small(1)).await;
    let done = service.succeeded(done.id).await;
    let blocker = service.submit_ok(JobKind::Simulate, long()).await;
    let reader = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(done.id)}))
        .await;
    assert_eq!(
        code(service.delete(blocker.id).await.unwrap_err()),
        "job_active"
    );
    assert_eq!(code(service.delete(done.id).await.unwrap_err()), "in_use");
    assert_eq!(
        code(service.report(reader.id).await.unwrap_err()),
        "result_not_ready"
    );
    service.cancel(reader.id).await.unwrap();
    service.cancel(blocker.id).await.unwrap();
    service.ended(blocker.id).await;

    let report = service.report(done.id).await.unwrap();
    let truth = service.artifact(done.id, "truth.csv").await.unwrap();
    service.delete(done.id).await.unwrap();
    assert!(matches!(
        service.get(done.id).await,
        Err(ServiceError::Gone("job"))
    ));
    assert!(matches!(
        service.delete(done.id).await,
        Err(ServiceError::Gone("job"))
    ));
    assert!(matches!(
        service.get(Uuid::now_v7()).await,
        Err(ServiceError::NotFound("job"))
    ));
    assert!(
        !service.blob(&report.sha256).exists(),
        "the report belonged to nobody else"
    );
    assert!(
        service.blob(&truth.sha256).exists(),
        "the truth is also a dataset"
    );
    assert_eq!(
        service.list(Default::default()).await.unwrap().items.len(),
        2
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn names_and_labels_can_be_changed_within_their_limits() {
    let service = start().await;
    let job = service.submit_ok(JobKind::Simulate, small(1)).await;
    let labels = [("run".to_owned(), "7".to_owned())].into();
    let patched = service
        .patch(
            job.id,
            JobPatch {
                name: Some("n".into()),
                labels: Some(labels),
                pinned: None,
            },
        )
        .await
        .unwrap();
    assert_eq!(
        (patched.name.as_deref(), patched.labels["run"].as_str()),
        (Some("n"), "7")
    );
    let unnamed = service
        .patch(
            job.id,
            JobPatch {
                name: Some(String::new()),
                labels: None,
                pinned: None,
            },
        )
        .await
        .unwrap();
    assert_eq!((unnamed.name, unnamed.labels.len()), (None, 1));
    let long = JobPatch {
        name: Some("x".repeat(101)),
        labels: Some((0..33).map(|n| (n.to_string(), String::new())).collect()),
        pinned: None,
    };
    let Err(ServiceError::Invalid(faults)) = service.patch(job.id, long).await else {
        panic!("accepted")
    };
    assert_eq!(
        faults
            .iter()
            .map(|fault| fault.pointer.as_str())
            .collect::<Vec<_>>(),
        ["/name", "/labels"]
    );
}
