//! The items of an autoferry file as they come: scans of detections, or lists of positions. Nothing is held of an item but
//! what is read of it.

use super::autoferry_sensors::{FerrySensor, SENSORS};
use super::json_text::FieldNames;
use super::loose::{Loose, own_seed, read_by, visit_scalars, visit_texts};
use super::table::FaultLog;
use crate::model::dataset::DatasetKind;
use crate::model::fault::Fault;
use crate::model::scan::Measurement;
use crate::model::state::Position;
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;

/// One scan of a sensor.
pub(super) struct FerryScan {
    /// Index into [`SENSORS`].
    pub sensor: usize,
    pub time_s: f64,
    /// Of the ferry.
    pub place_m: Position,
    pub measurements: Vec<Measurement>,
    /// Its place in the file.
    pub item: usize,
}

/// A position of a target, and where the file has it.
pub(super) struct Entry {
    pub time_s: f64,
    pub position_m: Position,
    pub item: usize,
    pub nth: usize,
}

/// What was read of a file.
pub(super) struct Items {
    asked: Option<DatasetKind>,
    /// What the first item makes the file.
    pub found: Option<DatasetKind>,
    pub scans: Vec<FerryScan>,
    /// Of each target.
    pub entries: BTreeMap<String, Vec<Entry>>,
    pub faults: FaultLog,
    /// Why the file was not read on.
    pub refusal: Option<Fault>,
    /// The place of the item being read.
    item: usize,
}

impl Items {
    pub fn new(asked: Option<DatasetKind>) -> Self {
        let (scans, entries, faults) = Default::default();
        Items {
            asked,
            found: None,
            scans,
            entries,
            faults,
            refusal: None,
            item: 0,
        }
    }

    /// The first item tells what the file holds.
    fn begin<E: Error>(&mut self, found: DatasetKind) -> Result<(), E> {
        if self.found.is_none() {
            self.found = Some(found);
            if let Some(asked) = self.asked.filter(|asked| *asked != found) {
                let detail = format!("the file holds {}, not {}", found.name(), asked.name());
                return Err(self.refuse(Fault::new("/meta/kind", "conflict", detail)));
            }
        }
        Ok(())
    }

    fn refuse<E: Error>(&mut self, fault: Fault) -> E {
        self.refusal = Some(fault);
        E::custom("refused")
    }

    /// An item that is neither a scan nor a list.
    fn stranger<E: Error>(&mut self) -> Result<(), E> {
        match self.found {
            None => {
                let fault = Fault::new(
                    format!("/file/{}", self.item),
                    "wrong_type",
                    "expected a scan or a list of positions",
                );
                Err(self.refuse(fault))
            }
            Some(found) => {
                self.wrong_item(found);
                Ok(())
            }
        }
    }

    fn wrong_item(&mut self, found: DatasetKind) {
        if found == DatasetKind::Truth {
            self.faults.push(Fault::new(
                format!("/file/{}", self.item),
                "wrong_type",
                "expected a list of positions",
            ));
        } else {
            self.keep_scan(ScanFields::default());
        }
    }

    fn keep_scan(&mut self, fields: ScanFields) {
        let scan = fields.scan(self.item, &mut self.faults);
        self.scans.extend(scan);
    }
}

/// Reads the whole file.
pub(super) struct FileSeed<'a>(pub &'a mut Items);

own_seed!(FileSeed<'_> => ());

impl<'de> Visitor<'de> for FileSeed<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("an array: of scans for detections, of lists for truth")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        while items.next_element_seed(ItemSeed(self.0))?.is_some() {
            self.0.item += 1;
            if self.0.faults.is_full() {
                return Err(A::Error::custom("too many faults"));
            }
        }
        Ok(())
    }
}

struct ItemSeed<'a>(&'a mut Items);

own_seed!(ItemSeed<'_> => ());

impl<'de> Visitor<'de> for ItemSeed<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a scan or a list of positions")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        if self.0.found == Some(DatasetKind::Truth) {
            while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
            self.0.wrong_item(DatasetKind::Truth);
            return Ok(());
        }
        let mut fields = ScanFields::default();
        let mut names = FieldNames::default();
        while let Some(name) = map.next_key::<String>()? {
            fields.read(&name, &mut map)?;
            names.push(name);
        }
        if self.0.found.is_none() && !fields.is_scan {
            return Err(self.0.refuse(names.records_fault()));
        }
        self.0.begin(DatasetKind::Detections)?;
        self.0.keep_scan(fields);
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        self.0.begin(DatasetKind::Truth)?;
        if self.0.found != Some(DatasetKind::Truth) {
            while list.next_element::<IgnoredAny>()?.is_some() {}
            return self.0.stranger();
        }
        let mut nth = 0;
        while let Some(fields) = list.next_element::<EntryFields>()? {
            if let Some((target, entry)) = fields.entry((self.0.item, nth), &mut self.0.faults) {
                self.0.entries.entry(target).or_default().push(entry);
            }
            nth += 1;
            if self.0.faults.is_full() {
                return Err(A::Error::custom("too many faults"));
            }
        }
        Ok(())
    }

    visit_scalars!(self => self.0.stranger());
}

/// The fields of a scan, of any shape; absent ones are [`Loose::Other`].
#[derive(Default)]
struct ScanFields {
    sensor: Loose,
    ownship: Loose,
    time: Loose,
    measurement: Loose,
    /// Whether it has a field that other records do not have.
    is_scan: bool,
}

impl ScanFields {
    /// Reads a field, of whichever name.
    fn read<'de, A: MapAccess<'de>>(&mut self, name: &str, map: &mut A) -> Result<(), A::Error> {
        let field = match name {
            "sensorID" => &mut self.sensor,
            "ownshipPosition" => &mut self.ownship,
            "time" => &mut self.time,
            "measurement" => &mut self.measurement,
            _ => return map.next_value::<IgnoredAny>().map(|_| ()),
        };
        *field = map.next_value()?;
        self.is_scan |= name != "time";
        Ok(())
    }

    /// The scan; `None` for faults.
    fn scan(self, item: usize, faults: &mut FaultLog) -> Option<FerryScan> {
        let pointer = |field: &str| format!("/file/{item}{field}");
        let Loose::Number {
            whole: Some(number),
            ..
        } = self.sensor
        else {
            faults.push(
                Fault::new(
                    pointer("/sensorID"),
                    "wrong_type",
                    "expected a sensor's number",
                )
                .allowing("1, 2, 3, 4"),
            );
            return None;
        };
        let Some(sensor) = SENSORS.iter().position(|known| known.number == number) else {
            let detail = format!("there is no sensor {number}");
            faults.push(
                Fault::new(pointer("/sensorID"), "unknown_value", detail).allowing("1, 2, 3, 4"),
            );
            return None;
        };
        let time_s = self.time.number();
        if time_s.is_none() {
            faults.push(Fault::new(
                pointer("/time"),
                "wrong_type",
                "expected a time in seconds",
            ));
        }
        let ownship = self
            .ownship
            .numbers()
            .and_then(|pair| <[f64; 2]>::try_from(pair).ok());
        if ownship.is_none() {
            faults.push(Fault::new(
                pointer("/ownshipPosition"),
                "wrong_type",
                "expected [north, east]",
            ));
        }
        let FerrySensor { read, expected, .. } = SENSORS[sensor];
        let measurements = read(self.measurement, ownship.unwrap_or_default());
        if measurements.is_none() {
            faults.push(Fault::new(pointer("/measurement"), "wrong_type", expected));
        }
        let (time_s, [north_m, east_m], measurements) = (time_s?, ownship?, measurements?);
        Some(FerryScan {
            sensor,
            time_s,
            place_m: Position::new(east_m, north_m),
            measurements,
            item,
        })
    }
}

/// The fields of a position of a target, of any shape.
#[derive(Default)]
struct EntryFields {
    target: Loose,
    time: Loose,
    position: Loose,
}

read_by!(EntryFields => deserialize_any(EntryVisitor));

struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = EntryFields;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a position of a target")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<EntryFields, A::Error> {
        let mut fields = EntryFields::default();
        while let Some(name) = map.next_key::<String>()? {
            match name.as_str() {
                "targetID" => fields.target = map.next_value()?,
                "time" => fields.time = map.next_value()?,
                "position" => fields.position = map.next_value()?,
                _ => map.next_value::<IgnoredAny>().map(|_| ())?,
            }
        }
        Ok(fields)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<EntryFields, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(EntryFields::default())
    }

    visit_scalars!(self => Ok(EntryFields::default()));
}

impl EntryFields {
    fn entry(self, (item, nth): (usize, usize), faults: &mut FaultLog) -> Option<(String, Entry)> {
        let target = if let Loose::Number { whole, .. } = self.target {
            whole
        } else {
            None
        };
        let time_s = self.time.number();
        let position = self
            .position
            .numbers()
            .filter(|position| (2..=3).contains(&position.len()));
        let mut expect = |present: bool, field: &str, what: &str| {
            if !present {
                faults.push(Fault::new(
                    format!("/file/{item}/{nth}/{field}"),
                    "wrong_type",
                    format!("expected {what}"),
                ));
            }
        };
        expect(target.is_some(), "targetID", "a target's number");
        expect(time_s.is_some(), "time", "a time in seconds");
        expect(position.is_some(), "position", "[north, east, 0]");
        let position = position?;
        Some((
            target?.to_string(),
            Entry {
                time_s: time_s?,
                position_m: Position::new(position[1], position[0]),
                item,
                nth,
            },
        ))
    }
}
