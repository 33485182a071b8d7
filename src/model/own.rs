//! What a single report has of its own, where it is not as its sensor's others are: when it was made, and how well.

use super::fault::Fault;

/// Of one detection.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Own {
    /// How long after the time of its scan it was made (s); below 0 before it.
    pub after_s: f64,
    pub noise: OwnNoise,
    /// Over the ground, east and north, where the report says it.
    pub velocity_mps: Option<[f64; 2]>,
}

/// As a scan keeps it: nothing where no detection has any.
pub fn whole(own: Vec<Own>) -> Vec<Own> {
    if own.iter().all(|own| *own == Own::default()) {
        Vec::new()
    } else {
        own
    }
}

/// A fault for each scan whose detections have not one sound entry each, nor none; of each scan its entries and its detections.
pub fn faults<'o>(scans: impl Iterator<Item = (&'o [Own], usize)>) -> impl Iterator<Item = Fault> {
    let is_sound = |own: &Own| own.after_s.is_finite() && own.noise.is_sound();
    scans
        .enumerate()
        .filter_map(move |(index, (own, detections))| {
            let is_whole = own.is_empty() || own.len() == detections;
            (!is_whole || !own.iter().all(is_sound)).then(|| {
                let detail = "what detections have of their own is not one sound entry each";
                Fault::new(format!("/scans/{index}/own"), "malformed", detail)
            })
        })
}

/// Standard deviations of what was measured; what is absent is as the sensor's.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OwnNoise {
    pub sigma_x_m: Option<f64>,
    pub sigma_y_m: Option<f64>,
    /// Correlation of the errors of x and y, above -1 and below 1; 0 when absent.
    pub correlation_xy: Option<f64>,
    pub sigma_z_m: Option<f64>,
    pub sigma_range_m: Option<f64>,
    pub sigma_bearing_rad: Option<f64>,
    pub sigma_elevation_rad: Option<f64>,
    pub sigma_range_rate_mps: Option<f64>,
    /// Along the velocity.
    pub sigma_speed_mps: Option<f64>,
    pub sigma_course_rad: Option<f64>,
}

/// Those in degrees of [`OwnNoise::NAMES`].
const IN_DEGREES: [usize; 3] = [5, 6, 9];

impl OwnNoise {
    /// What the values are called in files and on the wire, where angles are in degrees.
    pub const NAMES: [&str; 10] = [
        "sigma_x_m",
        "sigma_y_m",
        "correlation_xy",
        "sigma_z_m",
        "sigma_range_m",
        "sigma_bearing_deg",
        "sigma_elevation_deg",
        "sigma_range_rate_mps",
        "sigma_speed_mps",
        "sigma_course_deg",
    ];

    /// Of values as they are named, in that order.
    pub fn from_named(mut values: [Option<f64>; 10]) -> Self {
        for index in IN_DEGREES {
            values[index] = values[index].map(f64::to_radians);
        }
        OwnNoise::from_values(values)
    }

    /// The values in the order in which they are named.
    pub fn values(&self) -> [Option<f64>; 10] {
        [
            self.sigma_x_m,
            self.sigma_y_m,
            self.correlation_xy,
            self.sigma_z_m,
            self.sigma_range_m,
            self.sigma_bearing_rad,
            self.sigma_elevation_rad,
            self.sigma_range_rate_mps,
            self.sigma_speed_mps,
            self.sigma_course_rad,
        ]
    }

    /// Undoes [`OwnNoise::values`].
    pub fn from_values(values: [Option<f64>; 10]) -> Self {
        let [
            x,
            y,
            xy,
            z,
            range,
            bearing,
            elevation,
            range_rate,
            speed,
            course,
        ] = values;
        OwnNoise {
            sigma_x_m: x,
            sigma_y_m: y,
            correlation_xy: xy,
            sigma_z_m: z,
            sigma_range_m: range,
            sigma_bearing_rad: bearing,
            sigma_elevation_rad: elevation,
            sigma_range_rate_mps: range_rate,
            sigma_speed_mps: speed,
            sigma_course_rad: course,
        }
    }

    /// Standard deviations times a factor, but for those of velocities.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let times = |sigma: Option<f64>| sigma.map(|sigma| sigma * factor);
        OwnNoise {
            sigma_x_m: times(self.sigma_x_m),
            sigma_y_m: times(self.sigma_y_m),
            sigma_z_m: times(self.sigma_z_m),
            sigma_range_m: times(self.sigma_range_m),
            sigma_bearing_rad: times(self.sigma_bearing_rad),
            sigma_elevation_rad: times(self.sigma_elevation_rad),
            sigma_range_rate_mps: times(self.sigma_range_rate_mps),
            ..*self
        }
    }

    /// Of the three coordinates, where a sensor has these.
    pub fn sigmas_m(&self, [x_m, y_m, z_m]: [f64; 3]) -> [f64; 3] {
        [
            self.sigma_x_m.unwrap_or(x_m),
            self.sigma_y_m.unwrap_or(y_m),
            self.sigma_z_m.unwrap_or(z_m),
        ]
    }

    /// Whether it is one: deviations above 0, a correlation between -1 and 1.
    pub fn is_sound(&self) -> bool {
        let sigmas = OwnNoise {
            correlation_xy: None,
            ..*self
        };
        let mut values = sigmas.values().into_iter().flatten();
        values.all(|value| value > 0.0 && value.is_finite())
            && self.correlation_xy.is_none_or(|value| value.abs() < 1.0)
    }

    /// The larger of each, with no correlation: the noise of a report that is no better than either.
    #[must_use]
    pub fn widest(&self, other: &OwnNoise) -> OwnNoise {
        let (of_one, of_other) = (self.uncorrelated().values(), other.uncorrelated().values());
        OwnNoise::from_values(std::array::from_fn(|index| {
            match (of_one[index], of_other[index]) {
                (Some(one), Some(other)) => Some(one.max(other)),
                (one, other) => one.or(other),
            }
        }))
    }

    /// A noise on independent axes that is at least this one in every direction: with a correlation ρ the variances grow by 1 + |ρ|.
    #[must_use]
    pub fn uncorrelated(&self) -> OwnNoise {
        let factor = (1.0 + self.correlation_xy.unwrap_or(0.0).abs()).sqrt();
        OwnNoise {
            sigma_x_m: self.sigma_x_m.map(|sigma_m| sigma_m * factor),
            sigma_y_m: self.sigma_y_m.map(|sigma_m| sigma_m * factor),
            correlation_xy: None,
            ..*self
        }
    }
}
