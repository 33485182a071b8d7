//! Datasets: checked, kept once, read again, and deleted only when nobody needs them.

use crate::support::{long, sha256, start, start_with};
use serde_json::{Value, json};
use trackloom::model::dataset::DatasetKind;
use trackloom::model::sensor::SensorSettings;
use trackloom::service::datasets::DatasetFilter;
use trackloom::service::datasets::DatasetMeta;
use trackloom::service::error::ServiceError;
use trackloom::service::jobs::Paging;
use trackloom::service::types::{DatasetOrigin, JobKind, JobState};
use uuid::Uuid;

const DETECTIONS: &str = "time_s,scan,sensor_id,detection_id,x_m,y_m,truth_id\n\
    0,1,radar,a,0,0,t1\n0,1,radar,b,5000,5000,\n1,2,radar,c,10,0,t1\n2,3,radar,d,20,0,t1\n3,4,radar,e,30,0,t1\n";

fn named(name: &str) -> DatasetMeta {
    let sensor = SensorSettings {
        p_d: Some(0.9),
        clutter_per_m2: Some(1e-9),
        sigma_x_m: Some(5.0),
        sigma_y_m: Some(5.0),
        ..SensorSettings::named("radar")
    };
    DatasetMeta {
        name: Some(name.to_owned()),
        sensors: vec![sensor],
        file_name: Some("d.csv".into()),
        ..Default::default()
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn an_upload_is_checked_described_and_kept_once() {
    let service = start().await;
    let (info, is_new) = service.upload(DETECTIONS, named("trial")).await.unwrap();
    assert!(is_new);
    assert_eq!(
        (info.name.as_str(), info.format.as_str(), info.bytes),
        ("trial", "csv", DETECTIONS.len() as u64)
    );
    assert_eq!(
        (
            info.scans,
            info.rows,
            info.objects,
            info.start_s,
            info.end_s
        ),
        (4, 5, 1, Some(0.0), Some(3.0))
    );
    assert_eq!(
        (info.sensor_ids.as_slice(), info.sensors[0].p_d),
        (["radar".to_owned()].as_slice(), Some(0.9))
    );
    assert!(
        matches!(&info.origin, DatasetOrigin::Upload(upload) if upload.file_name.as_deref() == Some("d.csv"))
    );
    let (same, is_new) = service.upload(DETECTIONS, named("trial")).await.unwrap();
    assert!(!is_new && same == info);
    let (other, is_new) = service.upload(DETECTIONS, named("other")).await.unwrap();
    assert!(is_new && other.id != info.id && other.sha256 == info.sha256);

    let content = service.datasets().file(info.id).await.unwrap();
    assert_eq!(&*content.content.read().unwrap(), DETECTIONS.as_bytes());
    assert_eq!(
        (content.sha256.as_str(), content.file_name.as_str()),
        (sha256(DETECTIONS.as_bytes()).as_str(), "d.csv")
    );
    let preview: Value =
        serde_json::from_str(service.datasets().preview(info.id, 4).await.unwrap().get()).unwrap();
    assert_eq!(
        (
            &preview["total_rows"],
            &preview["columns"][3],
            &preview["rows"][3][3]
        ),
        (&json!(5), &json!("detection_id"), &json!("d"))
    );
    assert_eq!(
        std::fs::read_dir(service.datasets().temp_dir())
            .unwrap()
            .count(),
        0,
        "received files have moved on"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_broken_file_is_refused_with_line_and_column_and_leaves_nothing() {
    let service = start().await;
    let broken = DETECTIONS
        .replace("10,0,t1", "ten,0,t1")
        .replace("20,0,t1", "NaN,0,t1");
    let Err(ServiceError::Invalid(faults)) = service.upload(&broken, named("x")).await else {
        panic!("accepted")
    };
    let places: Vec<(Option<u64>, Option<&str>)> = faults
        .iter()
        .map(|fault| (fault.line, fault.column.as_deref()))
        .collect();
    assert_eq!(places, [(Some(4), Some("x_m")), (Some(5), Some("x_m"))]);
    assert!(
        service
            .datasets()
            .list(DatasetFilter::default())
            .await
            .unwrap()
            .items
            .is_empty()
    );
    let unknown = DatasetMeta {
        format: Some("xml".into()),
        ..Default::default()
    };
    let Err(ServiceError::Invalid(faults)) = service.upload(DETECTIONS, unknown).await else {
        panic!("accepted")
    };
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/meta/format", "unknown_value")
    );
    assert!(
        faults[0]
            .allowed
            .as_deref()
            .unwrap()
            .starts_with("csv, json")
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_reads_a_dataset_and_leaves_datasets() {
    let service = start().await;
    let (info, _) = service.upload(DETECTIONS, named("trial")).await.unwrap();
    let body = json!({"input": {"source": "dataset", "dataset_id": info.id}, "name": "first try"});
    let job = service.submit_ok(JobKind::Associate, body).await;
    service.succeeded(job.id).await;
    let report = service.report_of(job.id).await;
    assert_eq!(
        report["inputs"],
        json!([{"role": "detections", "source": "dataset", "dataset_id": info.id, "sha256": info.sha256}])
    );
    let artifacts = service.artifacts(job.id).await.unwrap().items;
    let tracks = artifacts
        .iter()
        .find(|artifact| artifact.name == "tracks.csv")
        .unwrap();
    let made = service
        .datasets()
        .get(tracks.dataset_id.unwrap())
        .await
        .unwrap();
    assert_eq!(
        (made.name.as_str(), &made.sha256),
        ("tracks of first try", &tracks.sha256)
    );
    assert!(matches!(&made.origin, DatasetOrigin::Job(origin) if origin.job_id == job.id));
    let filter = DatasetFilter {
        kinds: vec![DatasetKind::Tracks],
        paging: Paging {
            count: true,
            ..Default::default()
        },
        ..Default::default()
    };
    let page = service.datasets().list(filter).await.unwrap();
    assert_eq!((page.total, page.items), (Some(1), vec![made]));

    let wrong = json!({"tracks": {"source": "dataset", "dataset_id": info.id}, "detections": {"source": "dataset", "dataset_id": info.id}});
    let faults = service.refused(JobKind::Evaluate, wrong).await;
    assert_eq!(
        (
            faults.len(),
            faults[0].pointer.as_str(),
            faults[0].code.as_str()
        ),
        (1, "/tracks/dataset_id", "conflict")
    );
    assert_eq!(faults[0].allowed.as_deref(), Some("tracks"));
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dataset_is_deleted_when_no_queued_or_running_job_needs_it() {
    let service = start_with(|config| config.slots = 1).await;
    let (info, _) = service.upload(DETECTIONS, named("trial")).await.unwrap();
    let (twin, _) = service.upload(DETECTIONS, named("twin")).await.unwrap();
    let blocker = service.submit_ok(JobKind::Simulate, long()).await;
    let body = json!({"input": {"source": "dataset", "dataset_id": info.id}});
    let reader = service.submit_ok(JobKind::Associate, body.clone()).await;
    let error = service.datasets().delete(info.id).await.unwrap_err();
    assert!(
        matches!(&error, ServiceError::Conflict { code: "in_use", detail } if detail.contains(&reader.id.to_string())),
        "{error}"
    );
    service.cancel(reader.id).await.unwrap();
    let blob = service.blob(&info.sha256);
    service.datasets().delete(info.id).await.unwrap();
    assert!(blob.exists(), "its twin has the same content");
    assert!(matches!(
        service.datasets().get(info.id).await,
        Err(ServiceError::Gone("dataset"))
    ));
    assert!(matches!(
        service.datasets().get(Uuid::now_v7()).await,
        Err(ServiceError::NotFound("dataset"))
    ));
    let faults = service.refused(JobKind::Associate, body).await;
    assert_eq!(
        (faults[0].pointer.as_str(), faults[0].code.as_str()),
        ("/input/dataset_id", "not_found")
    );
    service.datasets().delete(twin.id).await.unwrap();
    assert!(!blob.exists());
    let (again, is_new) = service.upload(DETECTIONS, named("trial")).await.unwrap();
    assert!(is_new && again.id != info.id && blob.exists());
    service.cancel(blocker.id).await.unwrap();
    assert_eq!(service.ended(blocker.id).await.state, JobState::Canceled);
}
