//! Which program this is: its version, the revision it was built from, the features it was built with.

/// Version of the package, with the revision where it is known: `0.1.0+46dc801a2b3c`.
pub const VERSION: &str = env!("TRACKLOOM_VERSION");

/// What `--version` prints after the name: `0.1.0+46dc801a2b3c (features: s3 parquet)`.
pub const LONG_VERSION: &str = concat!(
    env!("TRACKLOOM_VERSION"),
    " (features: ",
    env!("TRACKLOOM_FEATURES"),
    ")"
);

/// Optional features of this build.
pub fn features() -> Vec<&'static str> {
    env!("TRACKLOOM_FEATURES")
        .split(' ')
        .filter(|name| *name != "none")
        .collect()
}
