//! Claims, ends and readiness of jobs in a fresh database.

use super::*;
use crate::model::dataset::DatasetKind;
use crate::service::storage::tests::{new_job, storage};
use crate::service::storage::{Admission, NewJob, Ready, SourceId, SourceRef};

async fn admit(storage: &Storage, needs: &[Uuid]) -> (Uuid, Changed) {
    let source = |id: &Uuid| SourceRef {
        pointer: "/input".into(),
        role: DatasetKind::Detections,
        id: SourceId::Job(id.to_string()),
    };
    let new = NewJob {
        sources: needs.iter().map(source).collect(),
        ..new_job(JobKind::Simulate, 7)
    };
    match storage.admit(&new, 100).await.unwrap() {
        Admission::Admitted(id, changed) => (id, changed),
        other => panic!("{other:?}"),
    }
}

fn ready(job_id: Uuid) -> Ready {
    Ready {
        job_id,
        chunk: None,
        priority: 7,
    }
}

async fn claimed(storage: &Storage, id: Uuid) -> Option<ClaimedJob> {
    match storage.claim(id, Uuid::now_v7(), 3).await.unwrap() {
        Claim::Run(job) => Some(job),
        _ => None,
    }
}

fn done() -> Ending {
    let artifact = |name: &str| NewArtifact {
        name: name.into(),
        media_type: "text/csv".into(),
        bytes: 1,
        sha256: "00".into(),
        dataset: None,
        sensors: Vec::new(),
        unsynced: None,
    };
    Ending::Succeeded {
        artifacts: vec![artifact("a"), artifact("b")],
        warnings: vec!["w".into()],
    }
}

#[tokio::test]
async fn of_many_who_claim_a_job_one_gets_it() {
    let (storage, _directory) = storage().await;
    let (id, changed) = admit(&storage, &[]).await;
    assert_eq!(changed, Changed::new(id, vec![ready(id)]));
    let claims = futures::future::join_all((0..10).map(|_| claimed(&storage, id))).await;
    assert_eq!(
        claims
            .iter()
            .flatten()
            .map(|job| job.attempt)
            .collect::<Vec<_>>(),
        [1]
    );
    assert!(claimed(&storage, Uuid::now_v7()).await.is_none());
}

#[tokio::test]
async fn results_are_written_once_and_a_late_copy_is_dropped() {
    let (storage, _directory) = storage().await;
    let (id, _) = admit(&storage, &[]).await;
    let first = claimed(&storage, id).await.unwrap();
    storage.recover().await.unwrap();
    let second = claimed(&storage, id).await.unwrap();
    assert_eq!(
        (
            first.attempt,
            second.attempt,
            storage.crashes(id, Uuid::now_v7()).await.unwrap()
        ),
        (1, 2, 1)
    );
    let progress = Progress {
        step: ProgressStep::Load,
        done: 1,
        total: 2,
        fraction: 0.5,
        eta_s: None,
    };
    assert_eq!(
        storage
            .progress(id, first.attempt, &progress)
            .await
            .unwrap(),
        None
    );
    assert_eq!(
        storage.finish(&first, &done()).await.unwrap(),
        None,
        "the first attempt was given up"
    );
    assert_eq!(
        storage.finish(&second, &done()).await.unwrap(),
        Some(Changed::new(id, vec![]))
    );
    assert_eq!(
        storage.finish(&second, &Ending::Canceled).await.unwrap(),
        None
    );
    assert_eq!(storage.release(&second).await.unwrap(), None);
    let job = storage.job(id).await.unwrap().unwrap().job;
    assert_eq!(
        (job.state, job.warnings),
        (JobState::Succeeded, vec!["w".to_owned()])
    );
    assert_eq!(storage.artifacts(id).await.unwrap().len(), 2);
}

#[tokio::test]
async fn a_job_is_ready_when_the_last_one_that_it_needs_has_succeeded() {
    let (storage, _directory) = storage().await;
    let ((one, _), (two, _)) = (admit(&storage, &[]).await, admit(&storage, &[]).await);
    let (both, changed) = admit(&storage, &[one, two]).await;
    assert_eq!(changed, Changed::new(both, vec![]));
    assert_eq!(
        storage.ready(false).await.unwrap(),
        [ready(one), ready(two)]
    );
    assert!(
        claimed(&storage, both).await.is_none(),
        "it cannot be had before"
    );
    for (id, ready) in [(one, vec![]), (two, vec![self::ready(both)])] {
        let job = claimed(&storage, id).await.unwrap();
        assert_eq!(
            storage.finish(&job, &done()).await.unwrap(),
            Some(Changed::new(id, ready))
        );
    }
    assert!(claimed(&storage, both).await.is_some());
}
