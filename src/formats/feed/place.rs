//! The plane of a feed: where it touches the Earth, and where its reports are in it.

use super::{Feed, Report, Site, Spot};
use crate::formats::Reading;
use crate::geodesy::{Geodetic, Stereographic, at_slant_range, wrap_longitude_deg};
use crate::model::fault::Fault;
use crate::model::space::{Frame, Place};
use crate::model::state::Position;
use std::collections::{BTreeMap, BTreeSet};

/// Farther from the origin lengths in the plane are wrong by more than 0.6 %.
const FAR_M: f64 = 1e6;

/// The plane, and the sites of sensors in it. It is chosen from the reports that are used.
pub(in crate::formats) struct Ground {
    pub frame: Option<Frame>,
    plane: Option<Stereographic>,
    sites: BTreeMap<u32, Site>,
    /// The same in the plane.
    sites_m: BTreeMap<u32, Position>,
    assumed_height_m: Option<f64>,
    /// The longest way from the origin so far (m).
    farthest_m: f64,
}

impl Ground {
    /// # Errors
    /// An origin that cannot be, since no place of the feed is finite.
    pub fn of(feed: &mut Feed, used: &[usize], reading: &Reading) -> Result<Self, Vec<Fault>> {
        let mut sites = std::mem::take(&mut feed.sites);
        for site in &reading.sites {
            let place = Site {
                lat_deg: site.lat_deg,
                lon_deg: site.lon_deg,
                height_m: site.height_m,
            };
            sites.insert(feed.sensors.number(&site.sensor_id), place);
        }
        let frame = match reading.origin {
            Some(frame) => Some(frame),
            None => choose_origin(feed, used, &sites)?,
        };
        let plane = frame.map(Stereographic::from);
        let mut sites_m = BTreeMap::new();
        if let Some(plane) = &plane {
            for (&sensor, site) in &sites {
                sites_m.insert(sensor, plane.project(site.lat_deg, site.lon_deg));
            }
        }
        Ok(Ground {
            frame,
            plane,
            sites,
            sites_m,
            assumed_height_m: reading.assumed_height_m,
            farthest_m: 0.0,
        })
    }

    /// Learns where a sensor stands. Where nothing says the plane, it touches the Earth there.
    pub fn learn(&mut self, sensor: u32, site: Site) {
        if self.frame.is_none()
            && let Ok(frame) = Frame::new(site.lat_deg, site.lon_deg, site.height_m)
        {
            (self.frame, self.plane) = (Some(frame), Some(Stereographic::from(frame)));
        }
        if let Some(plane) = &self.plane {
            let place_m = plane.project(site.lat_deg, site.lon_deg);
            self.sites_m.insert(sensor, place_m);
        }
        self.sites.insert(sensor, site);
    }

    pub fn site(&self, sensor: u32) -> Option<&Site> {
        self.sites.get(&sensor)
    }

    /// Where a sensor stands in the plane.
    pub fn site_m(&self, sensor: u32) -> Option<Position> {
        self.sites_m.get(&sensor).copied()
    }

    /// Where a report puts its object, in the plane (m); of a radar whose site nobody knows there is none.
    pub fn place_m(&mut self, report: &Report) -> Option<Position> {
        let place_m = match report.spot {
            Spot::Plane { x_m, y_m } => Position::new(x_m, y_m),
            Spot::Geographic { lat_deg, lon_deg } => self.plane.as_ref()?.project(lat_deg, lon_deg),
            Spot::Polar { .. } => {
                let there = self.seen_by_radar(report)?;
                self.plane.as_ref()?.project(there.lat_deg, there.lon_deg)
            }
        };
        self.farthest_m = self.farthest_m.max(place_m.norm());
        Some(place_m)
    }

    /// Where a radar of known site saw it.
    fn seen_by_radar(&self, report: &Report) -> Option<Geodetic> {
        let Spot::Polar {
            range_m,
            bearing_rad,
        } = report.spot
        else {
            return None;
        };
        let site = self.sites.get(&report.sensor)?;
        let site = Geodetic {
            lat_deg: site.lat_deg,
            lon_deg: site.lon_deg,
            height_m: site.height_m,
        };
        let height_m = report.height_m.or(self.assumed_height_m);
        Some(at_slant_range(&site, range_m, bearing_rad, height_m))
    }

    /// Range and bearing in the plane, from the radar's own place in it. Of a radar whose site nobody knows, as on level ground of
    /// middle latitudes, and from true north.
    pub fn polar(&mut self, report: &Report) -> Option<(f64, f64)> {
        let Spot::Polar {
            range_m,
            bearing_rad,
        } = report.spot
        else {
            return None;
        };
        if let (Some(place_m), Some(site_m)) = (self.place_m(report), self.site_m(report.sensor)) {
            let away_m = place_m - site_m;
            return Some((away_m.norm(), away_m.x.atan2(away_m.y)));
        }
        let height_m = report.height_m.or(self.assumed_height_m);
        let Some(height_m) = height_m else {
            return Some((range_m, bearing_rad));
        };
        let somewhere = Geodetic {
            lat_deg: 45.0,
            lon_deg: 0.0,
            height_m: 0.0,
        };
        let there = at_slant_range(&somewhere, range_m, 0.0, Some(height_m));
        let level = Geodetic {
            height_m: 0.0,
            ..there
        };
        let along_m = somewhere.enu_of(&level).norm();
        Some((along_m, bearing_rad))
    }

    /// The velocity in the plane, whose y axis points north at its origin alone.
    pub fn velocity(&self, report: &Report) -> Option<Place> {
        let motion = report.motion?;
        let turn_rad = match (report.spot, &self.plane) {
            (Spot::Geographic { lat_deg, lon_deg }, Some(plane)) => {
                plane.turn_rad(lat_deg, lon_deg)
            }
            (Spot::Polar { .. }, Some(plane)) => {
                let there = self.seen_by_radar(report)?;
                plane.turn_rad(there.lat_deg, there.lon_deg)
            }
            _ => 0.0,
        };
        let (sin, cos) = (motion.course_rad + turn_rad).sin_cos();
        Some(Place::new(
            motion.speed_mps * sin,
            motion.speed_mps * cos,
            0.0,
        ))
    }

    /// What a user is told of a plane that is stretched too far.
    pub fn warning(&self) -> Option<String> {
        let far = self.plane.is_some() && self.farthest_m > FAR_M;
        far.then(|| {
            format!(
                "places lie up to {:.0} km from the origin: beyond 1000 km the plane is longer than the Earth by more than 0.6 %",
                self.farthest_m / 1000.0
            )
        })
    }
}

/// Why a report has no place: nobody says where its radar stands.
pub(super) const UNKNOWN_SITE: &str = "unknown site";

/// The radars whose reports have no place.
#[derive(Debug, Default)]
pub(super) struct Unplaced(BTreeSet<u32>);

impl Unplaced {
    /// Counts a report of a path as used, or as left out for want of a place.
    pub fn count(&mut self, feed: &mut Feed, report: usize, is_placed: bool) {
        let Report { sensor, units, .. } = feed.reports[report];
        if is_placed {
            feed.units.use_up(units.into());
        } else {
            feed.units.ignore(UNKNOWN_SITE, units.into());
            self.0.insert(sensor);
        }
    }

    /// What a user is told of them.
    pub fn warning(&self, feed: &Feed) -> Option<String> {
        let names: Vec<&str> = self.0.iter().map(|&one| feed.sensors.name(one)).collect();
        (!names.is_empty()).then(|| {
            format!(
                "reports of these radars are left out, since nobody says where they stand: {}; `sites` does",
                names.join(", ")
            )
        })
    }
}

/// The site of the only sensor, else the middle of all places, rounded to a hundredth of a degree; `None` where nothing says where
/// on the Earth anything is.
fn choose_origin(
    feed: &Feed,
    used: &[usize],
    sites: &BTreeMap<u32, Site>,
) -> Result<Option<Frame>, Vec<Fault>> {
    let mut middle = Middle::default();
    for &index in used {
        if let Spot::Geographic { lat_deg, lon_deg } = feed.reports[index].spot {
            middle.add(lat_deg, lon_deg);
        }
    }
    if let (Some(site), 1) = (sites.values().next(), sites.len()) {
        return Frame::new(site.lat_deg, site.lon_deg, site.height_m).map(Some);
    }
    for site in sites.values() {
        middle.add(site.lat_deg, site.lon_deg);
    }
    middle.frame()
}

/// How far places may lie from their middle (degrees of a great circle): where one lies farther, it may be wild.
const FAR_DEG: f64 = 9.0;

/// The middle of places, the shorter way round the Earth: of the box around them, or where some are far from that, the median.
#[derive(Debug, Default)]
pub(in crate::formats) struct Middle {
    lat_deg: Option<(f64, f64)>,
    /// The first longitude, and the least and greatest difference from it.
    lon_deg: Option<(f64, f64, f64)>,
    /// Latitudes, and differences of longitudes from the first.
    sample: Sample,
}

impl Middle {
    pub fn add(&mut self, lat_deg: f64, lon_deg: f64) {
        let (least, greatest) = self.lat_deg.get_or_insert((lat_deg, lat_deg));
        (*least, *greatest) = (least.min(lat_deg), greatest.max(lat_deg));
        let (first, least, greatest) = self.lon_deg.get_or_insert((lon_deg, 0.0, 0.0));
        let away = wrap_longitude_deg(lon_deg - *first);
        (*least, *greatest) = (least.min(away), greatest.max(away));
        self.sample.add([lat_deg, away]);
    }

    /// # Errors
    /// Places that are not on the Earth.
    pub fn frame(&self) -> Result<Option<Frame>, Vec<Fault>> {
        let (Some(lat), Some((first, least, greatest))) = (self.lat_deg, self.lon_deg) else {
            return Ok(None);
        };
        let mut lat_deg = f64::midpoint(lat.0, lat.1);
        let mut away_deg = f64::midpoint(least, greatest);
        let narrow = lat_deg.to_radians().cos();
        if (lat.1 - lat_deg).max((greatest - away_deg) * narrow) > FAR_DEG {
            (lat_deg, away_deg) = (self.sample.median(0), self.sample.median(1));
        }
        let rounded = |value: f64| (value * 100.0).round() / 100.0;
        let lon_deg = rounded(wrap_longitude_deg(first + away_deg));
        Frame::new(rounded(lat_deg), lon_deg, 0.0).map(Some)
    }
}

/// Every so many of the values, more and more sparsely as they go on.
#[derive(Debug, Default)]
struct Sample {
    seen: u64,
    /// The logarithm of how many values go by for one that is kept.
    sparsity: u32,
    kept: Vec<[f64; 2]>,
}

/// Values that are kept.
const MOST_KEPT: usize = 4096;

impl Sample {
    fn add(&mut self, value: [f64; 2]) {
        if self.seen.trailing_zeros() >= self.sparsity {
            if self.kept.len() == MOST_KEPT {
                let mut at = 0;
                self.kept.retain(|_| {
                    at += 1;
                    at % 2 == 1
                });
                self.sparsity += 1;
            }
            if self.seen.trailing_zeros() >= self.sparsity {
                self.kept.push(value);
            }
        }
        self.seen += 1;
    }

    /// Of one of the two; 0 of none.
    fn median(&self, of: usize) -> f64 {
        let mut values: Vec<f64> = self.kept.iter().map(|value| value[of]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wild_place_does_not_move_the_origin_of_many() {
        let origin = |wild: Option<[f64; 2]>, places: u32| {
            let mut middle = Middle::default();
            for at in 0..places {
                let away = f64::from(at % 11) * 0.1;
                middle.add(50.0 + away, (179.5 + away + 180.0) % 360.0 - 180.0);
                if let Some([lat_deg, lon_deg]) = wild.filter(|_| at == 7) {
                    middle.add(lat_deg, lon_deg);
                }
            }
            let frame = middle.frame().unwrap().unwrap();
            (frame.latitude_deg(), frame.longitude_deg())
        };
        let (lat_deg, lon_deg) = origin(None, 1100);
        assert_eq!((lat_deg, lon_deg.abs()), (50.5, 180.0));
        for places in [1100, 100_000] {
            let (lat_deg, lon_deg) = origin(Some([0.0, 26.0]), places);
            assert!((lat_deg - 50.5).abs() <= 0.1, "{lat_deg}");
            assert!(
                wrap_longitude_deg(lon_deg - 180.0).abs() <= 0.1,
                "{lon_deg}"
            );
        }
    }
}
