//! The one shape of a job, in files and on the wire: the body of a request with its kind.

use crate::experiment::job::JobKind;
use crate::model::fault::Fault;
use serde::Deserialize;
use serde_json::{Value, json};

/// Takes the `kind` out of a job: what is left is the body of a request of that kind.
///
/// # Errors
/// A kind that is absent or unknown.
pub fn take_kind(job: &mut Value) -> Result<JobKind, Vec<Fault>> {
    let known = || JobKind::ALL.map(JobKind::name).join(", ");
    let kind = remove_kind(job).ok_or_else(|| {
        vec![Fault::new("/kind", "missing", "'kind' is required in a job").allowing(known())]
    })?;
    JobKind::deserialize(&kind).map_err(|_| {
        vec![Fault::new("/kind", "unknown_value", format!("unknown kind {kind}")).allowing(known())]
    })
}

/// What stands in `kind`, which is no more there then.
pub fn remove_kind(job: &mut Value) -> Option<Value> {
    job.as_object_mut()?.shift_remove("kind")
}

/// The job as one value: a body with its `kind`, which stands first.
pub fn with_kind(kind: JobKind, body: &Value) -> Value {
    let mut job = json!({"kind": kind});
    if let (Value::Object(members), Value::Object(rest)) = (&mut job, body) {
        members.extend(rest.clone());
    }
    job
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_a_body_with_its_kind() {
        let mut job = with_kind(JobKind::Group, &json!({"seed": 4}));
        assert_eq!(job.to_string(), r#"{"kind":"group","seed":4}"#);
        assert_eq!(take_kind(&mut job), Ok(JobKind::Group));
        assert_eq!(job, json!({"seed": 4}));
        let refused = |mut job: Value| {
            take_kind(&mut job)
                .map_err(|faults| (faults[0].code.clone(), faults[0].detail.clone()))
                .unwrap_err()
        };
        assert_eq!(
            refused(json!({"seed": 4})),
            ("missing".into(), "'kind' is required in a job".into())
        );
        assert_eq!(
            refused(json!({"kind": "owl"})),
            ("unknown_value".into(), "unknown kind \"owl\"".into())
        );
    }
}
