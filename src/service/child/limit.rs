//! How much memory a child may have, and whose death it does not survive. What Linux knows; other systems keep no such limit.

use std::fs;

/// Whether this system keeps the limit.
pub const IS_LIMITED: bool = cfg!(target_os = "linux");

/// With less nothing can be done.
pub const SMALLEST_BYTES: u64 = 64 << 20;

/// Processes besides the slots that want their share of the memory: the service itself, and one that checks an upload.
const OTHERS: u64 = 2;

/// What a job may have where nobody says it: its share of the memory of the machine, or of the container.
pub fn default_memory(slots: usize) -> Option<u64> {
    let machine = fs::read_to_string("/proc/meminfo")
        .ok()
        .and_then(|text| kilobytes(&text, "MemTotal:"))?;
    let container = fs::read_to_string("/sys/fs/cgroup/memory.max")
        .ok()
        .and_then(|text| text.trim().parse().ok());
    let shared = container.map_or(machine, |container: u64| container.min(machine));
    Some((shared / (slots as u64 + OTHERS)).max(SMALLEST_BYTES))
}

/// Bytes for a sentence.
pub fn size_text(bytes: u64) -> String {
    let (mebibyte, gibibyte) = (f64::from(1 << 20), f64::from(1 << 30));
    let bytes = bytes as f64;
    if bytes < gibibyte {
        format!("{:.0} MiB", bytes / mebibyte)
    } else {
        format!("{:.1} GiB", bytes / gibibyte)
    }
}

/// Bytes of addresses that this process uses, which is what is limited; 0 where the system does not tell.
pub(super) fn used_bytes() -> u64 {
    fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|text| kilobytes(&text, "VmSize:"))
        .unwrap_or(0)
}

/// The value in kB of a line of a file in `/proc`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim()
        .strip_suffix("kB")?
        .trim()
        .parse::<u64>()
        .ok()?
        .checked_mul(1024)
}

/// From now on this process may use so many bytes more; what it asks for beyond is refused. It leaves no image of its memory when it dies.
///
/// # Errors
/// When the system refuses the limit.
#[cfg(target_os = "linux")]
pub(super) fn limit_memory(bytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let no_image = getrlimit(Resource::Core);
    setrlimit(
        Resource::Core,
        Rlimit {
            current: Some(0),
            ..no_image
        },
    )?;
    let given = getrlimit(Resource::As);
    let wanted = used_bytes().saturating_add(bytes);
    let current = given.maximum.map_or(wanted, |maximum| maximum.min(wanted));
    Ok(setrlimit(
        Resource::As,
        Rlimit {
            current: Some(current),
            ..given
        },
    )?)
}

#[cfg(not(target_os = "linux"))]
pub(super) fn limit_memory(_bytes: u64) -> std::io::Result<()> {
    Ok(())
}

/// From now on the system kills this process when whoever started it dies, and kills it before the service where memory is short.
#[cfg(target_os = "linux")]
pub(super) fn depend_on_parent() -> std::io::Result<()> {
    rustix::process::set_parent_process_death_signal(Some(rustix::process::Signal::KILL))?;
    // Where the file cannot be written, the system chooses by itself.
    let _ = fs::write("/proc/self/oom_score_adj", "500");
    Ok(())
}

#[cfg(not(target_os = "linux"))]
pub(super) fn depend_on_parent() -> std::io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_system_are_read_in_bytes() {
        let text = "Name:\ttrackloom\nVmPeak:\t  12 kB\nVmSize:\t    9176 kB\n";
        assert_eq!(kilobytes(text, "VmSize:"), Some(9176 * 1024));
        assert_eq!(kilobytes(text, "VmSwap:"), None);
        assert_eq!(kilobytes("VmSize: 9 pages", "VmSize:"), None);
    }

    #[test]
    fn the_memory_is_shared_by_the_slots_the_service_and_an_upload() {
        let Some(of_one) = default_memory(1) else {
            return;
        };
        let of_four = default_memory(4).unwrap();
        assert!(
            of_one.abs_diff(2 * of_four) < 8,
            "{of_one} is a third, {of_four} a sixth"
        );
        assert_eq!(default_memory(1 << 40).unwrap(), SMALLEST_BYTES);
    }

    #[test]
    fn sizes_are_told_in_the_unit_that_fits() {
        assert_eq!(
            (size_text(64 << 20), size_text(3 << 29)),
            ("64 MiB".to_owned(), "1.5 GiB".to_owned())
        );
    }
}
