//! The address of a bucket.

use std::fmt;
use std::str::FromStr;

/// `s3://bucket/prefix`; the prefix may be absent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BucketUrl {
    bucket: String,
    /// Without slashes at its ends.
    prefix: String,
}

impl BucketUrl {
    pub fn bucket(&self) -> &str {
        &self.bucket
    }

    /// The key of an object of this name.
    pub fn key(&self, name: &str) -> String {
        if self.prefix.is_empty() {
            name.to_owned()
        } else {
            format!("{}/{name}", self.prefix)
        }
    }
}

impl FromStr for BucketUrl {
    type Err = String;

    fn from_str(text: &str) -> Result<BucketUrl, String> {
        let Some(rest) = text.strip_prefix("s3://") else {
            return Err("it must be s3://BUCKET or s3://BUCKET/PREFIX".to_owned());
        };
        let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
        let is_plain =
            |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '.' | '-' | '_');
        if bucket.is_empty() || !bucket.chars().all(is_plain) {
            return Err("the name of the bucket must be letters, digits, '.', '-' and '_'; keys go into AWS_ACCESS_KEY_ID and \
                AWS_SECRET_ACCESS_KEY"
                .to_owned());
        }
        let prefix = prefix.strip_suffix('/').unwrap_or(prefix);
        let is_folder = |part: &str| {
            !part.is_empty() && part != "." && part != ".." && part.chars().all(is_plain)
        };
        if !prefix.is_empty() && !prefix.split('/').all(is_folder) {
            return Err(
                "the prefix must be folders of letters, digits, '.', '-' and '_'".to_owned(),
            );
        }
        Ok(BucketUrl {
            bucket: bucket.to_owned(),
            prefix: prefix.to_owned(),
        })
    }
}

impl fmt::Display for BucketUrl {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "s3://{}", self.bucket)?;
        if self.prefix.is_empty() {
            Ok(())
        } else {
            write!(formatter, "/{}", self.prefix)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_is_a_bucket_and_perhaps_a_prefix() {
        for (text, shown, key) in [
            ("s3://tracks", "s3://tracks", "ab/abc"),
            ("s3://tracks/", "s3://tracks", "ab/abc"),
            (
                "s3://tracks/lab/2026/",
                "s3://tracks/lab/2026",
                "lab/2026/ab/abc",
            ),
        ] {
            let url: BucketUrl = text.parse().unwrap();
            assert_eq!(
                (
                    url.to_string().as_str(),
                    url.bucket(),
                    url.key("ab/abc").as_str()
                ),
                (shown, "tracks", key)
            );
        }
    }

    #[test]
    fn other_addresses_are_refused() {
        for text in ["", "tracks", "gs://tracks", "https://tracks", "s3:/tracks"] {
            assert_eq!(
                text.parse::<BucketUrl>().unwrap_err(),
                "it must be s3://BUCKET or s3://BUCKET/PREFIX",
                "{text}"
            );
        }
        for text in [
            "s3://",
            "s3:///lab",
            "s3://id:secret@tracks",
            "s3://tracks?region=eu",
        ] {
            assert!(
                text.parse::<BucketUrl>()
                    .unwrap_err()
                    .starts_with("the name of the bucket must be"),
                "{text}"
            );
        }
        for text in [
            "s3://tracks/a//b",
            "s3://tracks/../b",
            "s3://tracks/a b",
            "s3://tracks/a#b",
        ] {
            assert!(
                text.parse::<BucketUrl>()
                    .unwrap_err()
                    .starts_with("the prefix must be"),
                "{text}"
            );
        }
    }
}
