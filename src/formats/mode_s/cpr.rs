//! Compact position reporting: a frame says where in a zone it is, and zones of even and of odd frames differ in size.
//!
//! # Reference
//! RTCA DO-260B, appendix A.1.7.

/// Mean radius.
const EARTH_RADIUS_M: f64 = 6_371_008.8;

/// Zones of even frames from pole to pole and back.
const ZONES: f64 = 60.0;

/// Latitude and longitude, degrees.
pub(super) type Place = (f64, f64);

/// What a frame says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coded {
    pub is_odd: bool,
    pub is_surface: bool,
    /// Parts of a zone, from 0 to 1.
    pub lat: f64,
    pub lon: f64,
}

impl Coded {
    pub fn of(is_odd: bool, is_surface: bool, lat: u32, lon: u32) -> Self {
        const PARTS: f64 = 131_072.0;
        Coded {
            is_odd,
            is_surface,
            lat: f64::from(lat) / PARTS,
            lon: f64::from(lon) / PARTS,
        }
    }

    /// Degrees that the zones divide.
    fn circle_deg(&self) -> f64 {
        if self.is_surface { 90.0 } else { 360.0 }
    }

    fn lat_zone_deg(&self) -> f64 {
        self.circle_deg() / if self.is_odd { ZONES - 1.0 } else { ZONES }
    }

    fn lon_zone_deg(&self, lat_deg: f64) -> f64 {
        let zones = lon_zones(lat_deg) - if self.is_odd { 1.0 } else { 0.0 };
        self.circle_deg() / zones.max(1.0)
    }
}

/// The place nearest to one that is known: right within half a zone, which is 180 NM, on the surface 45 NM.
pub(super) fn near(coded: &Coded, (lat_deg, lon_deg): Place) -> Option<Place> {
    let nearest = |known: f64, zone: f64, part: f64| {
        let zones = (known / zone).floor() + (0.5 + known.rem_euclid(zone) / zone - part).floor();
        zone * (zones + part)
    };
    let found_lat_deg = nearest(lat_deg, coded.lat_zone_deg(), coded.lat);
    if found_lat_deg.abs() > 90.0 {
        return None;
    }
    let lon_zone_deg = coded.lon_zone_deg(found_lat_deg);
    Some((
        found_lat_deg,
        wrapped(nearest(lon_deg, lon_zone_deg, coded.lon)),
    ))
}

/// The place of the later of two frames, one even and one odd. On the surface it is the one nearest to `receiver` of eight.
/// `None` where the two lie in different zones of longitude, so that they cannot be put together.
pub(super) fn from_pair(before: &Coded, latest: &Coded, receiver: Option<Place>) -> Option<Place> {
    let (even, odd) = if latest.is_odd {
        (before, latest)
    } else {
        (latest, before)
    };
    let zone = ((ZONES - 1.0) * even.lat - ZONES * odd.lat + 0.5).floor();
    let lat_of = |coded: &Coded, zones: f64| {
        southern(
            coded.lat_zone_deg() * (zone.rem_euclid(zones) + coded.lat),
            coded.is_surface,
            receiver,
        )
    };
    let (even_deg, odd_deg) = (lat_of(even, ZONES), lat_of(odd, ZONES - 1.0));
    let zones = lon_zones(even_deg);
    if zones != lon_zones(odd_deg) || even_deg.abs() > 90.0 || odd_deg.abs() > 90.0 {
        return None;
    }
    let lat_deg = if latest.is_odd { odd_deg } else { even_deg };
    let lon_zone_deg = latest.lon_zone_deg(lat_deg);
    let count = (latest.circle_deg() / lon_zone_deg).round();
    let zone = (even.lon * (zones - 1.0) - odd.lon * zones + 0.5).floor();
    let lon_deg = lon_zone_deg * (zone.rem_euclid(count) + latest.lon);
    let quarters = match (latest.is_surface, receiver) {
        (true, Some((_, receiver_deg))) => ((receiver_deg - lon_deg) / 90.0).round(),
        _ => 0.0,
    };
    Some((lat_deg, wrapped(lon_deg + quarters * 90.0)))
}

/// Latitudes from 270 degrees on are southern. On the surface they are known but for 90 degrees.
fn southern(lat_deg: f64, is_surface: bool, receiver: Option<Place>) -> f64 {
    match receiver {
        Some((receiver_deg, _)) if is_surface => {
            let is_nearer = (lat_deg - 90.0 - receiver_deg).abs() < (lat_deg - receiver_deg).abs();
            if is_nearer { lat_deg - 90.0 } else { lat_deg }
        }
        _ if lat_deg >= 270.0 => lat_deg - 360.0,
        _ => lat_deg,
    }
}

/// How many zones of longitude even frames have at a latitude.
fn lon_zones(lat_deg: f64) -> f64 {
    let lat_deg = lat_deg.abs();
    if lat_deg < 1e-9 {
        return ZONES - 1.0;
    }
    if lat_deg >= 87.0 {
        return if lat_deg > 87.0 { 1.0 } else { 2.0 };
    }
    let step = 1.0 - (std::f64::consts::PI / (ZONES / 2.0)).cos();
    let cos = lat_deg.to_radians().cos();
    (std::f64::consts::TAU / (1.0 - step / (cos * cos)).acos()).floor()
}

fn wrapped(lon_deg: f64) -> f64 {
    if (-180.0..=180.0).contains(&lon_deg) {
        lon_deg
    } else {
        (lon_deg + 180.0).rem_euclid(360.0) - 180.0
    }
}

/// Metres between two places, on a sphere.
pub(super) fn distance_m((lat_a, lon_a): Place, (lat_b, lon_b): Place) -> f64 {
    let half = |a: f64, b: f64| ((a - b).to_radians() / 2.0).sin().powi(2);
    let across = lat_a.to_radians().cos() * lat_b.to_radians().cos() * half(lon_a, lon_b);
    2.0 * EARTH_RADIUS_M * (half(lat_a, lat_b) + across).clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Latitudes of DO-260B, table A-21, at which a zone is lost.
    #[test]
    fn zones_of_longitude() {
        let at = [
            (10.470_471_30, 59.0),
            (14.828_174_37, 58.0),
            (52.257_20, 36.0),
            (59.954_592_77, 30.0),
            (86.535_369_98, 3.0),
            (87.0, 2.0),
            (90.0, 1.0),
            (0.0, 59.0),
        ];
        for (lat_deg, zones) in at {
            assert_eq!(lon_zones(lat_deg - 1e-7), zones, "{lat_deg}");
            assert_eq!(lon_zones(1e-7 - lat_deg), zones, "{lat_deg}");
        }
        assert_eq!((lon_zones(10.470_472), lon_zones(86.535_371)), (58.0, 2.0));
    }

    /// What an aircraft sends, by the standard's equations.
    fn coded(place: Place, is_odd: bool, is_surface: bool) -> Coded {
        let circle_deg = if is_surface { 90.0 } else { 360.0 };
        let odd = f64::from(is_odd);
        let part =
            |degrees: f64, zone: f64| (131_072.0 * degrees.rem_euclid(zone) / zone + 0.5).floor();
        let lat_zone = circle_deg / (60.0 - odd);
        let lat = part(place.0, lat_zone);
        let sent_lat = lat_zone * (lat / 131_072.0 + (place.0 / lat_zone).floor());
        let lon_zone = circle_deg / (lon_zones(sent_lat) - odd).max(1.0);
        let lon = part(place.1, lon_zone);
        Coded::of(
            is_odd,
            is_surface,
            lat as u32 % 131_072,
            lon as u32 % 131_072,
        )
    }

    proptest! {
        /// A step is 5.1 m in the air and 1.3 m on the ground, and more in longitude near a pole.
        #[test]
        fn pairs_and_neighbours_lead_back(
            lat_deg in -86.9..86.9, lon_deg in -180.0..180.0, away in (-1.4..1.4, -1.4..1.4), is_surface: bool, is_odd: bool,
        ) {
            let place = (lat_deg, lon_deg);
            let [before, latest] = [!is_odd, is_odd].map(|is_odd| coded(place, is_odd, is_surface));
            let near_by = (lat_deg + away.0 / 4.0, lon_deg + away.1 / 4.0);
            let most_m = if is_surface { 3.0 } else { 12.0 };
            if let Some(found) = from_pair(&before, &latest, is_surface.then_some(near_by)) {
                prop_assert!(distance_m(found, place) < most_m, "{found:?}");
            }
            let found = near(&latest, near_by).unwrap();
            prop_assert!(distance_m(found, place) < most_m, "{found:?}");
            prop_assert!(found.1.abs() <= 180.0);
        }
    }
}
