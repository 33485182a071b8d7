//! What each problem means to who gets it: its cause, and what to do.

/// Cause and remedy of the problem with this code; empty where there is no such problem.
pub fn explanation(code: &str) -> (&'static str, &'static str) {
    EXPLANATIONS
        .iter()
        .find(|(known, ..)| *known == code)
        .map_or(("", ""), |(_, cause, remedy)| (cause, remedy))
}

/// Code, cause, remedy. Plain text that can stand in HTML as it is.
const EXPLANATIONS: &[(&str, &str, &str)] = &[
    (
        "malformed_request",
        "The request is not HTTP as it has to be: the header Host is missing, given twice, or not a host.",
        "Send one header Host with the name and port of the service. Every HTTP library does.",
    ),
    (
        "malformed_json",
        "The body, or the part meta of an upload, is not JSON. The detail names line and column.",
        "Mend the JSON at that place. NaN, comments and trailing commas are not JSON.",
    ),
    (
        "invalid_cursor",
        "The cursor does not come from a page of this list in this order.",
        "Take next_cursor from the page before, and keep sort as it was. Leave cursor out for the first page.",
    ),
    (
        "unauthenticated",
        "The service asks for keys. The request has none, or one that is unknown, has ended or was revoked; the detail says which.",
        "Send Authorization: Bearer and the key, or sign in on the page. Whoever runs the service makes keys with trackloom keys.",
    ),
    (
        "forbidden",
        "The key is good, but does not allow what the detail names.",
        "Ask for a key that allows it.",
    ),
    (
        "foreign_host",
        "The request names a host that the service does not know as its own. So no web page can reach it through a name of its own.",
        "Ask by localhost or by the address of the machine, or start the service with --allow-host and that name.",
    ),
    (
        "cross_site",
        "A web page of another site sent a request that would change something.",
        "Use the dashboard of the service itself, or a program. Behind a reverse proxy, pass the header Host on.",
    ),
    (
        "not_found",
        "There is nothing with this path, id or name. The detail says which.",
        "Look it up in the list of jobs, datasets or files.",
    ),
    (
        "method_not_allowed",
        "The path exists, but not with this method.",
        "Use a method that the header Allow of the answer names.",
    ),
    (
        "not_acceptable",
        "The header Accept of the request does not admit what the path answers with.",
        "Leave Accept out, or admit the media type that the detail names.",
    ),
    (
        "request_timeout",
        "The body of the request came too slowly, or stopped coming.",
        "Send it again over a better connection. Less than 16 KiB in 30 seconds is too slow.",
    ),
    (
        "job_terminal",
        "The job has ended, so it cannot be canceled any more.",
        "Nothing has to be done. Run it again if it is needed.",
    ),
    (
        "job_active",
        "The job is queued or running, so it cannot be deleted.",
        "Cancel it first, or wait for its end.",
    ),
    (
        "in_use",
        "A queued or running job needs what should be deleted.",
        "Wait for the jobs that the detail names, or cancel them.",
    ),
    (
        "result_not_ready",
        "The job is queued or running, so there is no report yet.",
        "Ask again after the time in Retry-After, follow the events of the job, or submit with Prefer: wait.",
    ),
    (
        "job_failed",
        "The job failed or was canceled, so it has no result.",
        "Read error of the job. Mend the request and submit it anew.",
    ),
    (
        "dependency_failed",
        "A job whose result this job reads failed or was canceled.",
        "Look at the job that the detail names. When it has succeeded, submit this one anew.",
    ),
    (
        "session_closed",
        "The session was closed, or its tracker failed: the session itself says which.",
        "Begin another session. What a closed one took is the dataset that it names.",
    ),
    (
        "session_paused",
        "Somebody paused the session; its tracks stay as they are.",
        "Resume it, and push the scan again.",
    ),
    (
        "session_elsewhere",
        "Several processes share the database, and another one has the session.",
        "Ask the process whose address is told. When it has gone, any other takes the session over within 15 seconds.",
    ),
    (
        "gone",
        "It was here and has been deleted.",
        "Upload the dataset or run the job anew.",
    ),
    (
        "payload_too_large",
        "The body is larger than the limit that the detail names.",
        "Send less, or start the service with a larger --max-upload-bytes. JSON bodies have at most 1 MiB.",
    ),
    (
        "memory_limit",
        "The job, or the check of the uploaded file, needs more memory than one process of the service may have.",
        "Give it less data, or start the service with a larger --job-memory.",
    ),
    (
        "unsupported_media_type",
        "The body has a type that the path does not take, or it is compressed.",
        "Send JSON as application/json and uploads as multipart/form-data, neither compressed nor with Content-Encoding.",
    ),
    (
        "range_not_satisfiable",
        "The range that is asked for begins behind the end of the file.",
        "Ask for a range within the size that Content-Range names.",
    ),
    (
        "validation",
        "Something in the request, or in a file, cannot be used. The member errors lists the faults, each with its place.",
        "Mend what errors names. Its pointer says where in the request, allowed says what would do, line and column where in a file; docs/formats.md says what each format of files needs.",
    ),
    (
        "idempotency_mismatch",
        "The Idempotency-Key was used before with another body or another kind of job.",
        "Take a new key for a new request.",
    ),
    (
        "session_full",
        "Scans that were pushed before still wait to be written and taken, as many as a session holds, or scans come faster than its max_scans_per_s.",
        "Push again after the time in Retry-After, and push several scans at once.",
    ),
    (
        "too_many_requests",
        "More requests came with the key than its requests_per_minute allow.",
        "Ask again after the time in Retry-After, and follow events instead of asking again and again.",
    ),
    (
        "internal",
        "Something went wrong inside the service that is no fault of the request.",
        "Try again. If it stays, the log of the service tells more under the request id of the answer.",
    ),
    (
        "damaged",
        "A stored file no longer has the content under whose SHA-256 it was kept. It is neither served nor computed with.",
        "Bring the file that the log of the service names back from a backup, or upload the dataset anew.",
    ),
    (
        "crashed",
        "The process that ran the job died, also when it ran alone, most likely because the system was short of memory.",
        "Give the machine more memory, or the job less data.",
    ),
    (
        "queue_full",
        "As many jobs are queued as the service takes.",
        "Submit again after the time in Retry-After. The option --queue-limit sets the number.",
    ),
    (
        "too_many_connections",
        "As many connections are open as the service takes.",
        "Try again after the time in Retry-After, and close what is not used. The option --max-connections sets the number.",
    ),
    (
        "too_many_streams",
        "As many event streams are open as the service, or one client, may have.",
        "Close streams of jobs that need no watching, or read their history. The options --max-streams and --max-streams-per-client set the numbers.",
    ),
    (
        "shutting_down",
        "The service is about to stop and takes no work.",
        "Submit again after the time in Retry-After, when it has started again.",
    ),
    (
        "unavailable",
        "The database of the service does not answer.",
        "Try again after the time in Retry-After. Whoever runs the service has to look at the database.",
    ),
    (
        "disk",
        "The disk of the data directory is full or cannot be written, so the service takes no uploads and no jobs.",
        "Make room on the disk, or start the service with a smaller --min-free. Reading goes on meanwhile.",
    ),
    (
        "time_limit",
        "The job ran longer than a job may.",
        "Give it less to do, or start the service with a longer --job-time-limit.",
    ),
    (
        "insufficient_storage",
        "There is not enough room on the disk of the service for an upload or a new job.",
        "Delete what is not needed, or make room on the disk. Then try again after the time in Retry-After.",
    ),
];

#[cfg(test)]
mod tests {
    use super::super::PROBLEMS;
    use super::*;

    #[test]
    fn every_problem_is_explained_once_and_in_order() {
        let codes: Vec<&str> = PROBLEMS.iter().map(|(code, ..)| *code).collect();
        let explained: Vec<&str> = EXPLANATIONS.iter().map(|(code, ..)| *code).collect();
        assert_eq!(explained, codes);
    }

    #[test]
    fn explanations_are_sentences_that_can_stand_in_html() {
        for (code, cause, remedy) in EXPLANATIONS {
            for text in [cause, remedy] {
                assert!(
                    text.len() > 20 && text.ends_with('.') && !text.contains(['<', '>', '&']),
                    "{code}: {text}"
                );
            }
        }
    }
}
