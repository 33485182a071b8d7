//! The queue of one process. That of many is tried with real processes, in `tests/processes`.

use super::*;
use futures::FutureExt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;
use tokio::sync::mpsc;

async fn engine(slots: usize) -> Engine {
    Engine::open(&Database::Sqlite("nowhere/app.db".into()), slots)
        .await
        .unwrap()
}

fn job(job_id: Uuid) -> Ready {
    Ready {
        job_id,
        chunk: None,
        priority: 0,
    }
}

fn telling(sender: mpsc::UnboundedSender<Uuid>) -> Handler {
    Handler::new(move |Entry { job_id: id, .. }| {
        let told = sender.send(id).map_err(anyhow::Error::from);
        async move { told }.boxed()
    })
}

#[tokio::test(flavor = "multi_thread")]
async fn an_idle_queue_is_woken_by_every_entry_and_stops_quickly() {
    let engine = engine(2).await;
    let (sender, mut told) = mpsc::unbounded_channel();
    engine.run(telling(sender));
    let mut took = Vec::new();
    for number in 0..1000 {
        if number % 100 == 0 {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
        let (id, since) = (Uuid::now_v7(), Instant::now());
        engine.enqueue(&[job(id)]).await.unwrap();
        assert_eq!(told.recv().await, Some(id));
        took.push(since.elapsed());
    }
    took.sort();
    // A queue that looks now and then would take half its pause; a busy machine takes less.
    assert!(took[500] < Duration::from_millis(20), "{:?}", took[500]);
    assert!(
        took[999] < Duration::from_secs(2),
        "none waits for a clock: {:?}",
        took[999]
    );
    let since = Instant::now();
    engine.stop().await;
    assert!(
        since.elapsed() < Duration::from_secs(5),
        "{:?}",
        since.elapsed()
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn what_waits_already_is_not_put_in_again() {
    let engine = engine(1).await;
    let (one, two) = (Uuid::now_v7(), Uuid::now_v7());
    let chunk = |number| Ready {
        chunk: Some(number),
        ..job(two)
    };
    for _ in 0..3 {
        engine
            .enqueue(&[job(one), chunk(0), chunk(1)])
            .await
            .unwrap();
    }
    let (sender, mut told) = mpsc::unbounded_channel();
    engine.run(telling(sender));
    let seen = [
        told.recv().await.unwrap(),
        told.recv().await.unwrap(),
        told.recv().await.unwrap(),
    ];
    assert_eq!(seen.iter().filter(|&&id| id == two).count(), 2);
    assert!(
        tokio::time::timeout(Duration::from_millis(100), told.recv())
            .await
            .is_err(),
        "nothing comes twice"
    );
    engine.enqueue(&[job(one)]).await.unwrap();
    assert_eq!(told.recv().await, Some(one), "what was done may come again");
    engine.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn no_more_handlers_run_than_there_are_slots_and_one_that_fails_or_panics_is_called_again() {
    let engine = engine(2).await;
    let (sender, mut told) = mpsc::unbounded_channel();
    let running = Arc::new(AtomicUsize::new(0));
    // Of all calls: one that panics may hold its slot for as long as its trace takes to be written.
    let most = Arc::new(AtomicUsize::new(0));
    let most_of_calls = most.clone();
    let (failed, panicked) = (
        Arc::new(AtomicBool::new(false)),
        Arc::new(AtomicBool::new(false)),
    );
    engine.run(Handler::new(move |entry| {
        let (sender, running, most, failed, panicked) = (
            sender.clone(),
            running.clone(),
            most_of_calls.clone(),
            failed.clone(),
            panicked.clone(),
        );
        async move {
            let at_once = running.fetch_add(1, Ordering::SeqCst) + 1;
            most.fetch_max(at_once, Ordering::SeqCst);
            tokio::time::sleep(Duration::from_millis(100)).await;
            running.fetch_sub(1, Ordering::SeqCst);
            anyhow::ensure!(failed.swap(true, Ordering::SeqCst), "the first call fails");
            assert!(
                panicked.swap(true, Ordering::SeqCst),
                "the second call panics"
            );
            Ok(sender.send(entry.job_id)?)
        }
        .boxed()
    }));
    let ids: Vec<Uuid> = (0..10).map(|_| Uuid::now_v7()).collect();
    engine
        .enqueue(&ids.iter().copied().map(job).collect::<Vec<_>>())
        .await
        .unwrap();
    let mut seen = Vec::new();
    while seen.len() < ids.len() {
        seen.push(told.recv().await.unwrap());
    }
    seen.sort();
    assert_eq!((seen, most.load(Ordering::SeqCst)), (ids, 2));
    engine.stop().await;
}

#[test]
fn the_first_chunk_goes_first_and_what_is_more_urgent_before_it() {
    let chunk = |priority, number| Ready {
        chunk: Some(number),
        priority,
        ..job(Uuid::nil())
    };
    let ready = [
        Ready {
            priority: 100,
            ..job(Uuid::nil())
        },
        chunk(90, 0),
        chunk(90, 1),
        chunk(90, 9_999),
        chunk(80, 0),
        chunk(0, u32::MAX),
    ];
    let places: Vec<i64> = ready.iter().map(place).collect();
    assert!(
        places.is_sorted_by(|before, after| before > after),
        "{places:?}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_urgent_goes_first_and_of_two_the_older() {
    let engine = engine(1).await;
    let ids: Vec<Uuid> = (0..6).map(|_| Uuid::now_v7()).collect();
    let ready: Vec<Ready> = ids
        .iter()
        .zip([3, 50, 4, 100, 0, 50])
        .map(|(&id, priority)| Ready {
            priority,
            ..job(id)
        })
        .collect();
    engine.enqueue(&ready).await.unwrap();
    let (sender, mut told) = mpsc::unbounded_channel();
    engine.run(telling(sender));
    let mut seen = Vec::new();
    while seen.len() < ids.len() {
        seen.push(told.recv().await.unwrap());
    }
    assert_eq!(seen, [ids[3], ids[1], ids[5], ids[2], ids[0], ids[4]]);
    engine.stop().await;
}
