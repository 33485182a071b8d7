//! Units that are older than one before them.

/// How many there are, and the largest step back.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disorder {
    backward: u64,
    largest_s: f64,
    unit: u64,
}

impl Disorder {
    /// Notes a unit's time after the latest one before it, which it becomes if it is later.
    pub fn note(&mut self, latest_s: &mut f64, time_s: f64, unit: u64) {
        let back_s = *latest_s - time_s;
        self.backward += u64::from(back_s > 0.0);
        if back_s > self.largest_s {
            (self.largest_s, self.unit) = (back_s, unit);
        }
        *latest_s = latest_s.max(time_s);
    }

    /// What a user is told; `called` is what a unit is called.
    pub fn warning(&self, called: &str) -> Option<String> {
        let Disorder {
            backward,
            largest_s,
            unit,
        } = self;
        (*backward > 0).then(|| {
            format!(
                "{backward} {called}s are older than one before them and are sorted; the largest step back is {largest_s} s, at {called} {unit}"
            )
        })
    }
}
