//! A campaign on its way from its first chunk to its end.
#![expect(
    clippy::single_range_in_vec_init,
    reason = "a list of one range is meant"
)]

use super::*;
use crate::service::storage::change::parse_id;
use crate::service::storage::tests::{new_job, storage};
use crate::service::storage::{Admission, Cancellation, Claim, NewJob};
use crate::service::types::{Job, JobKind, JobState};

async fn admitted(storage: &Storage, rerun_of: Option<Uuid>) -> Uuid {
    let new = NewJob {
        rerun_of,
        ..new_job(JobKind::Campaign, 40)
    };
    let Admission::Admitted(id, _) = storage.admit(&new, 100).await.unwrap() else {
        panic!("it is not admitted")
    };
    id
}

/// A campaign of ten runs, started; and what is ready then.
async fn started(storage: &Storage, rerun_of: Option<Uuid>) -> (Uuid, Vec<Ready>) {
    let id = admitted(storage, rerun_of).await;
    let Claim::Run(job) = storage.claim(id, Uuid::now_v7(), 3).await.unwrap() else {
        panic!("it is not claimed")
    };
    let changed = storage.start_campaign(&job, 10).await.unwrap().unwrap();
    (id, changed.ready)
}

async fn claimed(storage: &Storage, id: Uuid, number: u32, entry: Uuid) -> Option<ClaimedChunk> {
    match storage.claim_chunk(id, number, entry, 3).await.unwrap() {
        Chunk::Run(chunk) => Some(chunk),
        _ => None,
    }
}

/// What is ready when the chunk has ended.
async fn finished(storage: &Storage, chunk: &ClaimedChunk, result: &ChunkResult) -> Vec<Ready> {
    let changed = storage.finish_chunk(chunk, result).await.unwrap();
    changed.unwrap().ready
}

async fn job_of(storage: &Storage, id: Uuid) -> Job {
    storage.job(id).await.unwrap().unwrap().job
}

async fn pieces(storage: &Storage, id: Uuid) -> Vec<String> {
    storage.pieces(id).try_collect().await.unwrap()
}

fn piece(runs: u64) -> ChunkResult {
    ChunkResult::Piece {
        piece: format!("piece of {runs}"),
        runs,
        outcomes: "[]".into(),
    }
}

fn ready(id: Uuid, numbers: &[u32]) -> Vec<Ready> {
    numbers
        .iter()
        .map(|&number| Ready {
            job_id: id,
            chunk: Some(number),
            priority: 40,
        })
        .collect()
}

/// Works chunk 0 off and cuts two more of four and three runs.
async fn cut(storage: &Storage, id: Uuid) {
    let entry = Uuid::now_v7();
    let pilot = claimed(storage, id, 0, entry).await.unwrap();
    assert_eq!(
        (pilot.kind, pilot.outcomes.as_deref(), &pilot.items),
        (ChunkKind::Pilot, None, &vec![0..10])
    );
    assert_eq!(finished(storage, &pilot, &piece(3)).await, ready(id, &[1]));
    let look = claimed(storage, id, 1, entry).await.unwrap();
    assert_eq!(
        (look.kind, look.outcomes.as_deref(), look.runs_done),
        (ChunkKind::Look, Some("[]"), 3)
    );
    let more = ChunkResult::More {
        chunks: vec![NewChunk(vec![3..7]), NewChunk(vec![7..10])],
        runs_total: 10,
    };
    assert_eq!(finished(storage, &look, &more).await, ready(id, &[2, 3]));
}

#[tokio::test]
async fn a_campaign_goes_from_its_pilot_over_looks_to_its_end() {
    let (storage, _directory) = storage().await;
    let (id, first) = started(&storage, None).await;
    assert_eq!(first, ready(id, &[0]));
    cut(&storage, id).await;
    let two = claimed(&storage, id, 2, Uuid::now_v7()).await.unwrap();
    let three = claimed(&storage, id, 3, Uuid::now_v7()).await.unwrap();
    assert_eq!((&two.items, &three.items), (&vec![3..7], &vec![7..10]));
    assert_eq!(finished(&storage, &three, &piece(3)).await, []);
    let progress = job_of(&storage, id).await.progress.unwrap();
    assert_eq!(
        (progress.done, progress.total, progress.fraction),
        (6, 10, 0.6)
    );
    assert_eq!(
        finished(&storage, &two, &piece(4)).await,
        ready(id, &[4]),
        "the last one calls for a look"
    );
    assert_eq!(
        pieces(&storage, id).await,
        ["piece of 3", "piece of 4", "piece of 3"]
    );
    let look = claimed(&storage, id, 4, Uuid::now_v7()).await.unwrap();
    let ending = Ending::Succeeded {
        artifacts: Vec::new(),
        warnings: Vec::new(),
    };
    finished(&storage, &look, &ChunkResult::Ended(ending)).await;
    assert_eq!(job_of(&storage, id).await.state, JobState::Succeeded);
    assert!(
        pieces(&storage, id).await.is_empty(),
        "its runs are in its files"
    );
    assert!(storage.ready(false).await.unwrap().is_empty());
}

#[tokio::test]
async fn of_many_who_claim_a_chunk_one_gets_it_and_only_its_result_counts() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    let claims =
        futures::future::join_all((0..10).map(|_| claimed(&storage, id, 0, Uuid::now_v7()))).await;
    assert_eq!(
        claims
            .iter()
            .flatten()
            .map(|chunk| chunk.attempt)
            .collect::<Vec<_>>(),
        [1]
    );
    let first = claims.into_iter().flatten().next().unwrap();
    // The queue gives the same entry out again when the first to have it is taken for dead.
    let entry: String = sqlx::query_scalar("SELECT entry FROM chunks")
        .fetch_one(&storage.read)
        .await
        .unwrap();
    let entry = parse_id(&entry).unwrap();
    // The death that brings it counts before it is claimed, so that it runs alone.
    let crashes = async |entry| storage.chunk_crashes(id, 0, entry).await.unwrap();
    assert_eq!(
        (crashes(entry).await, crashes(Uuid::now_v7()).await),
        (1, 0)
    );
    let second = claimed(&storage, id, 0, entry).await.unwrap();
    assert_eq!(
        (
            second.attempt,
            storage.chunk_crashes(id, 0, Uuid::now_v7()).await.unwrap()
        ),
        (2, 1)
    );
    assert_eq!(
        storage.finish_chunk(&first, &piece(5)).await.unwrap(),
        None,
        "the first was given up"
    );
    assert!(
        storage
            .finish_chunk(&second, &piece(5))
            .await
            .unwrap()
            .is_some()
    );
    assert_eq!(
        storage.finish_chunk(&second, &piece(5)).await.unwrap(),
        None,
        "it has ended"
    );
    assert_eq!(storage.release_chunk(&second).await.unwrap(), None);
    assert_eq!(job_of(&storage, id).await.progress.unwrap().done, 5);
}

#[tokio::test]
async fn a_chunk_that_was_running_at_three_deaths_is_given_up_after_the_others() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    cut(&storage, id).await;
    for _ in 0..3 {
        assert!(claimed(&storage, id, 2, Uuid::now_v7()).await.is_some());
        storage.recover().await.unwrap();
    }
    let refused = storage.claim_chunk(id, 2, Uuid::now_v7(), 3).await.unwrap();
    let Chunk::Refused(changed) = refused else {
        panic!("{refused:?}")
    };
    assert_eq!(changed.ready, [], "another chunk is still to be done");
    let three = claimed(&storage, id, 3, Uuid::now_v7()).await.unwrap();
    assert_eq!(finished(&storage, &three, &piece(3)).await, ready(id, &[4]));
    assert_eq!(storage.failed_chunks(id).await.unwrap(), [vec![3..7]]);
}

#[tokio::test]
async fn a_chunk_that_nobody_can_work_off_fails_and_the_last_of_the_others_calls_for_the_look() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    cut(&storage, id).await;
    let (two, three) = (
        claimed(&storage, id, 2, Uuid::now_v7()).await.unwrap(),
        claimed(&storage, id, 3, Uuid::now_v7()).await.unwrap(),
    );
    assert_eq!(finished(&storage, &two, &ChunkResult::GivenUp).await, []);
    assert_eq!(
        storage.finish_chunk(&two, &piece(4)).await.unwrap(),
        None,
        "it has failed"
    );
    assert_eq!(finished(&storage, &three, &piece(3)).await, ready(id, &[4]));
    assert_eq!(storage.failed_chunks(id).await.unwrap(), [vec![3..7]]);
}

#[tokio::test]
async fn a_look_that_kills_ends_the_campaign() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    let pilot = claimed(&storage, id, 0, Uuid::now_v7()).await.unwrap();
    storage.finish_chunk(&pilot, &piece(10)).await.unwrap();
    for _ in 0..3 {
        assert!(claimed(&storage, id, 1, Uuid::now_v7()).await.is_some());
        storage.recover().await.unwrap();
    }
    assert!(matches!(
        storage.claim_chunk(id, 1, Uuid::now_v7(), 3).await.unwrap(),
        Chunk::Refused(_)
    ));
    let job = job_of(&storage, id).await;
    assert_eq!(
        (job.state, job.error.unwrap().code.as_str()),
        (JobState::Failed, "crashed")
    );
}

#[tokio::test]
async fn a_canceled_campaign_leaves_its_runs_to_the_one_that_runs_it_again() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    cut(&storage, id).await;
    let two = claimed(&storage, id, 2, Uuid::now_v7()).await.unwrap();
    assert!(matches!(
        storage.cancel(id).await.unwrap(),
        Cancellation::Canceled(_)
    ));
    assert_eq!(storage.finish_chunk(&two, &piece(4)).await.unwrap(), None);
    assert!(claimed(&storage, id, 3, Uuid::now_v7()).await.is_none());
    assert!(storage.ready(false).await.unwrap().is_empty());
    let (again, first) = started(&storage, Some(id)).await;
    assert_eq!(
        first,
        ready(again, &[1]),
        "no pilot, but a look at what is there"
    );
    assert_eq!(pieces(&storage, again).await, ["piece of 3"]);
    let look = claimed(&storage, again, 1, Uuid::now_v7()).await.unwrap();
    assert_eq!(
        (look.kind, look.runs_done, look.outcomes.as_deref()),
        (ChunkKind::Look, 3, Some("[]"))
    );
}

#[tokio::test]
async fn a_wish_to_cancel_that_comes_while_a_campaign_begins_ends_it() {
    let (storage, _directory) = storage().await;
    let id = admitted(&storage, None).await;
    let Claim::Run(job) = storage.claim(id, Uuid::now_v7(), 3).await.unwrap() else {
        panic!("it is not claimed")
    };
    assert!(matches!(
        storage.cancel(id).await.unwrap(),
        Cancellation::Requested(_)
    ));
    let changed = storage.start_campaign(&job, 10).await.unwrap().unwrap();
    assert_eq!((changed.touched, changed.ready), (vec![id], vec![]));
    assert_eq!(job_of(&storage, id).await.state, JobState::Canceled);
}

#[tokio::test]
async fn more_chunks_than_one_statement_takes_are_all_there() {
    let (storage, _directory) = storage().await;
    let (id, _) = started(&storage, None).await;
    let pilot = claimed(&storage, id, 0, Uuid::now_v7()).await.unwrap();
    storage.finish_chunk(&pilot, &piece(1)).await.unwrap();
    let look = claimed(&storage, id, 1, Uuid::now_v7()).await.unwrap();
    let chunks: Vec<NewChunk> = (1..1301)
        .map(|item| NewChunk(vec![item..item + 1]))
        .collect();
    let more = ChunkResult::More {
        chunks,
        runs_total: 1301,
    };
    let ready = finished(&storage, &look, &more).await;
    assert_eq!(
        ready
            .iter()
            .map(|ready| ready.chunk.unwrap())
            .collect::<Vec<_>>(),
        (2..1302).collect::<Vec<_>>()
    );
    assert_eq!(storage.ready(false).await.unwrap(), ready);
    assert_eq!(
        claimed(&storage, id, 1301, Uuid::now_v7())
            .await
            .unwrap()
            .items,
        [1300..1301]
    );
}
