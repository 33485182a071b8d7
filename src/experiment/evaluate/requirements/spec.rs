//! The type of the field, and what no table can see.

use super::presets::items_of;
use crate::evaluation::credit::Credit;
use crate::evaluation::surveillance::{Check, Pairing, Radar, Requirement, Sector, Settings};
use crate::experiment::evaluate::within::{AreaSpec, Seen};
use crate::model::fault::Fault;
use crate::model::truth::TruthSet;
use serde::Deserialize;

/// The sector where none is given.
const EVERYWHERE: &str = "everywhere";

#[derive(Debug, Clone, Deserialize)]
pub struct RequirementsSpec {
    #[serde(default)]
    sectors: Vec<SectorSpec>,
    #[serde(default)]
    presets: Vec<PresetSpec>,
    #[serde(default)]
    items: Vec<Requirement>,
    pairing: Pairing,
    gate_m: Option<f64>,
    reference_reach_s: f64,
    counts_coasted: bool,
}

#[derive(Debug, Clone, Deserialize)]
struct SectorSpec {
    sector_id: String,
    #[serde(default)]
    areas: Vec<AreaSpec>,
    height_min_m: Option<f64>,
    height_max_m: Option<f64>,
}

#[derive(Debug, Clone, Deserialize)]
struct PresetSpec {
    preset: String,
    sectors: Option<Vec<String>>,
}

impl RequirementsSpec {
    /// What no table can see.
    pub fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        if self.presets.is_empty() && self.items.is_empty() {
            let detail = "nothing is required";
            let fault = Fault::new("/requirements", "missing", detail);
            faults.push(fault.allowing("presets, items, or both"));
        }
        for (index, sector) in self.sectors.iter().enumerate() {
            faults.extend(self.sector_faults(index, sector));
        }
        for (index, preset) in self.presets.iter().enumerate() {
            let pointer = format!("/requirements/presets/{index}");
            faults.extend(self.unknown_sectors(&pointer, preset.sectors.as_deref()));
        }
        for (index, item) in self.items.iter().enumerate() {
            let pointer = format!("/requirements/items/{index}");
            faults.extend(self.unknown_sectors(&pointer, item.sectors.as_deref()));
            faults.extend(item_faults(&pointer, item));
        }
        faults
    }

    fn sector_faults(&self, index: usize, sector: &SectorSpec) -> Vec<Fault> {
        let pointer = format!("/requirements/sectors/{index}");
        let mut faults = AreaSpec::faults(&sector.areas, &format!("{pointer}/areas"));
        let heights = sector.height_min_m.zip(sector.height_max_m);
        if heights.is_some_and(|(least_m, most_m)| most_m < least_m) {
            let detail = "it ends before it begins";
            let place = format!("{pointer}/height_max_m");
            faults.push(Fault::new(place, "out_of_range", detail));
        }
        let mut before = self.sectors[..index].iter();
        if before.any(|other| other.sector_id == sector.sector_id) {
            let detail = format!("two sectors are called '{}'", sector.sector_id);
            let place = format!("{pointer}/sector_id");
            faults.push(Fault::new(place, "duplicate", detail).allowing("each name once"));
        }
        faults
    }

    fn unknown_sectors(&self, pointer: &str, names: Option<&[String]>) -> Vec<Fault> {
        let known: Vec<&str> = match self.sectors.as_slice() {
            [] => vec![EVERYWHERE],
            sectors => sectors.iter().map(|one| one.sector_id.as_str()).collect(),
        };
        let mut faults = Vec::new();
        for (index, name) in names.unwrap_or_default().iter().enumerate() {
            if !known.contains(&name.as_str()) {
                let place = format!("{pointer}/sectors/{index}");
                let detail = format!("there is no sector '{name}'");
                faults.push(Fault::new(place, "unknown_value", detail).allowing(known.join(", ")));
            }
        }
        faults
    }

    /// What is required, in the plane of the truth.
    ///
    /// # Errors
    /// Latitudes where the plane has no origin.
    pub fn settings(
        &self,
        (truth, recording): (&TruthSet, Option<Seen>),
        (gate_m, credit): (f64, Credit),
    ) -> Result<Settings, Vec<Fault>> {
        let (mut sectors, mut faults) = (Vec::new(), Vec::new());
        for (index, sector) in self.sectors.iter().enumerate() {
            let pointer = format!("/requirements/sectors/{index}/areas");
            let areas =
                AreaSpec::in_plane(&sector.areas, (truth, recording), &pointer, &mut faults);
            sectors.push(Sector {
                sector_id: sector.sector_id.clone(),
                areas,
                height_m: (sector.height_min_m, sector.height_max_m),
            });
        }
        if sectors.is_empty() {
            sectors.push(Sector {
                sector_id: EVERYWHERE.to_owned(),
                ..Sector::default()
            });
        }
        let mut requirements = self.requirements();
        let first_item = requirements.len() - self.items.len();
        for (index, requirement) in requirements.iter_mut().enumerate() {
            // Presets have no radars and no areas.
            let pointer = format!("/requirements/items/{}", index.saturating_sub(first_item));
            let fault = match requirement.check.radar_mut() {
                Some(radar) => place_radar(radar, recording).err(),
                None => without_area(requirement, &sectors),
            };
            faults.extend(fault.map(|fault| Fault {
                pointer: format!("{pointer}{}", fault.pointer),
                ..fault
            }));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        Ok(Settings {
            sectors,
            requirements,
            pairing: self.pairing,
            gate_m: self.gate_m.unwrap_or(gate_m),
            reference_reach_s: self.reference_reach_s,
            counts_coasted: self.counts_coasted,
            credit,
        })
    }

    /// Those of presets, then those of the request.
    fn requirements(&self) -> Vec<Requirement> {
        let mut requirements = Vec::new();
        for preset in &self.presets {
            for item in items_of(&preset.preset) {
                requirements.push(Requirement {
                    sectors: preset.sectors.clone(),
                    ..item
                });
            }
        }
        requirements.extend(self.items.iter().cloned());
        requirements
    }
}

/// Puts a radar where the job's sensor stands, unless the request says where.
fn place_radar(radar: &mut Radar, recording: Option<Seen>) -> Result<(), Fault> {
    if radar.x_m.is_some() && radar.y_m.is_some() {
        return Ok(());
    }
    let sensors = recording.map_or(&[][..], |(_, sensors)| sensors);
    let names: Vec<&str> = sensors.iter().map(|one| one.sensor_id.as_str()).collect();
    let sensor = match &radar.sensor_id {
        Some(wanted) => sensors.iter().find(|one| one.sensor_id == *wanted),
        None => sensors.first().filter(|_| sensors.len() == 1),
    };
    let Some(sensor) = sensor else {
        let detail = "nothing says where the radar stands";
        let fault = Fault::new("/sensor_id", "missing", detail);
        return Err(fault.allowing(match names.as_slice() {
            [] => "x_m and y_m, or a sensor of the job's detections".to_owned(),
            names => format!("x_m and y_m, or one of {}", names.join(", ")),
        }));
    };
    let place_m = radar.x_m.or(sensor.x_m).zip(radar.y_m.or(sensor.y_m));
    let Some((x_m, y_m)) = place_m else {
        let detail = format!(
            "the place of the sensor '{}' is not known",
            sensor.sensor_id
        );
        return Err(Fault::new("/sensor_id", "missing", detail).allowing("x_m and y_m"));
    };
    (radar.x_m, radar.y_m) = (Some(x_m), Some(y_m));
    Ok(())
}

/// The fault of a rate per area in sectors without one.
fn without_area(requirement: &Requirement, sectors: &[Sector]) -> Option<Fault> {
    let is_asked = matches!(requirement.check, Check::FalseTracks { per_km2: Some(_) });
    let names = requirement.sectors.as_ref();
    let mut due = sectors
        .iter()
        .filter(|sector| names.is_none_or(|names| names.contains(&sector.sector_id)));
    let boundless = due.find(|sector| is_asked && sector.area_km2().is_none())?;
    let detail = format!(
        "the sector '{}' has no area of known size",
        boundless.sector_id
    );
    let fault = Fault::new("/per_km2", "unsupported", detail);
    Some(fault.allowing("sectors with areas of the kinds polygon, polygon_deg and sector"))
}

fn item_faults(pointer: &str, item: &Requirement) -> Vec<Fault> {
    let mut faults = Vec::new();
    let bound = &item.bound;
    let given = [bound.at_least, bound.at_most, bound.above, bound.below];
    if given.iter().flatten().count() > 1 {
        let detail = "a requirement has one threshold";
        let fault = Fault::new(pointer, "conflict", detail);
        faults.push(fault.allowing("one of at_least, at_most, above, below; a second item"));
    }
    let rule = item.check.gap_rule();
    let gaps = rule.and_then(|rule| rule.min_gap_s.zip(rule.max_gap_s));
    if gaps.is_some_and(|(least_s, most_s)| most_s < least_s) {
        let detail = "no gap is as long as the shortest and as short as the longest";
        let place = format!("{pointer}/max_gap_s");
        faults.push(Fault::new(place, "out_of_range", detail));
    }
    faults
}
