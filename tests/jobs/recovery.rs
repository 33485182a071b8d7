//! Stopping and starting: nothing is lost, nothing is done twice, and a job that kills is stopped.

use crate::support::{long, of_job, open, small, start, start_with};
use serde_json::json;
use std::time::{Duration, Instant};
use trackloom::service::config::Config;
use trackloom::service::error::ServiceError;
use trackloom::service::jobs::Jobs;
use trackloom::service::types::{Event, JobKind, JobState};

#[tokio::test(flavor = "multi_thread")]
async fn a_stop_is_quick_and_hands_running_jobs_back_to_the_queue() {
    let service = start_with(|config| config.slots = 1).await;
    let running = service.submit_ok(JobKind::Simulate, long()).await;
    let queued = service.submit_ok(JobKind::Simulate, small(1)).await;
    let waiting = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(queued.id)}))
        .await;
    service.in_progress(running.id).await;
    let since = Instant::now();
    let events = service.events(running.id, 0).await.unwrap();
    let service = service
        .restart(&[
            "UPDATE jobs SET spec = json_set(spec, '$.scenario.scans', 20) WHERE kind = 'simulate'",
        ])
        .await;
    assert!(
        since.elapsed() < Duration::from_secs(4),
        "{:?}",
        since.elapsed()
    );
    drop(events);
    let done = service.succeeded(running.id).await;
    assert_eq!(done.attempt, 2);
    service.succeeded(queued.id).await;
    service.succeeded(waiting.id).await;
    let events = service.all_events(running.id).await;
    let said: Vec<&str> = events
        .iter()
        .filter_map(|event| {
            if let Event::Log(event) = event {
                Some(event.data.message.as_str())
            } else {
                None
            }
        })
        .collect();
    assert_eq!(said, ["the service stopped; queued again"]);
    assert_eq!(
        events.iter().map(Event::seq).collect::<Vec<_>>(),
        (1..=events.len() as u64).collect::<Vec<_>>()
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn every_stream_ends_when_the_service_stops_and_nothing_new_is_taken() {
    let service = start_with(|config| config.slots = 1).await;
    let job = service.submit_ok(JobKind::Simulate, long()).await;
    let (events, waited, ()) = tokio::join!(
        service.all_events(job.id),
        service.wait(job.id, Duration::from_secs(60)),
        async {
            tokio::time::sleep(Duration::from_millis(300)).await;
            service.shutdown().await;
        }
    );
    assert!(!events.is_empty() && !events.last().unwrap().is_last());
    assert!(!waited.is_ok_and(|job| job.state.is_terminal()));
    assert!(service.is_shutting_down());
    assert!(matches!(
        service.submit(JobKind::Simulate, small(1), None).await,
        Err(ServiceError::ShuttingDown)
    ));
}

#[tokio::test(flavor = "multi_thread")]
async fn what_was_running_when_the_process_died_runs_again_and_leaves_one_result() {
    let service = start_with(|config| config.slots = 1).await;
    let blocker = service.submit_ok(JobKind::Simulate, long()).await;
    let (victim, queued) = (
        service.submit_ok(JobKind::Simulate, small(1)).await,
        service.submit_ok(JobKind::Simulate, small(2)).await,
    );
    service.in_progress(blocker.id).await;
    service.cancel(blocker.id).await.unwrap();
    service.succeeded(victim.id).await;
    service.succeeded(queued.id).await;
    // As a crash leaves it: started, not ended, no results.
    let service = service
        .restart(&[
            "DELETE FROM artifacts",
            "UPDATE jobs SET state = 'running', finished_at = NULL, attempt = 1 WHERE state = 'succeeded'",
            "UPDATE jobs SET state = 'running', finished_at = NULL, cancel_requested_at = 1 WHERE state = 'canceled'",
        ])
        .await;
    for id in [victim.id, queued.id] {
        let job = service.succeeded(id).await;
        assert_eq!(job.attempt, 2);
        let reports = service
            .artifacts(id)
            .await
            .unwrap()
            .items
            .into_iter()
            .filter(|artifact| artifact.name == "report.json")
            .count();
        assert_eq!(reports, 1);
    }
    assert_eq!(
        service.get(blocker.id).await.unwrap().state,
        JobState::Canceled,
        "its cancellation had been asked for"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_was_running_in_three_dead_processes_fails_as_crashed() {
    let service = start().await;
    let poison = service.submit_ok(JobKind::Simulate, small(1)).await;
    service.succeeded(poison.id).await;
    let service = service
        .restart(&[
            "DELETE FROM artifacts",
            "UPDATE jobs SET state = 'running', crashes = 2, attempt = 3",
        ])
        .await;
    let follower = service
        .submit_ok(JobKind::Associate, json!({"input": of_job(poison.id)}))
        .await;
    let job = service.ended(poison.id).await;
    let error = job.error.unwrap();
    assert_eq!(
        (job.state, job.attempt, error.code.as_str()),
        (JobState::Failed, 3, "crashed")
    );
    assert_eq!(
        error.detail,
        "the process ended 3 times while it ran this job"
    );
    assert_eq!(
        service.ended(follower.id).await.error.unwrap().code,
        "dependency_failed"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_queue_is_made_anew_from_the_tables_and_the_file_of_an_earlier_version_goes() {
    let service = start_with(|config| config.slots = 1).await;
    let blocker = service.submit_ok(JobKind::Simulate, long()).await;
    let queued = service.submit_ok(JobKind::Simulate, small(1)).await;
    service.in_progress(blocker.id).await;
    service.cancel(blocker.id).await.unwrap();
    service.shutdown().await;
    let former = service.directory.path().join("queue.db");
    std::fs::write(&former, "the queue of an earlier version").unwrap();
    let service = service.restart(&[]).await;
    service.succeeded(queued.id).await;
    assert!(!former.exists());
}

#[tokio::test(flavor = "multi_thread")]
async fn a_directory_serves_one_process_at_a_time() {
    let service = start().await;
    let error = Jobs::open(Config::new(service.directory.path()))
        .await
        .err()
        .unwrap();
    assert!(
        error
            .to_string()
            .ends_with("is in use by another trackloom"),
        "{error}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn two_hundred_jobs_at_once_all_run_once() {
    let directory = tempfile::tempdir().unwrap();
    let jobs = open(directory.path(), |_| {}).await;
    let body = json!({"scenario": crate::support::scenario(1, 1, 0.0)});
    let submitted = futures::future::join_all(
        (0..200).map(|_| jobs.submit(JobKind::Simulate, body.clone(), None)),
    )
    .await;
    for answer in submitted {
        let job = jobs
            .wait(answer.unwrap().job.id, Duration::from_secs(120))
            .await
            .unwrap();
        assert_eq!(
            (job.state, job.attempt),
            (JobState::Succeeded, 1),
            "{:?}",
            job.error
        );
    }
}
