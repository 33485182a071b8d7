//! Boxes in the frames of a video: what an annotator or a tracker says of the objects in sight.

use super::fault::Fault;

/// One object in one frame: a rectangle whose left and top edges count from the picture's left and top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectBox {
    /// From 1.
    pub frame: u32,
    /// Index into [`BoxSet::object_ids`].
    pub object: u32,
    pub left_px: f64,
    pub top_px: f64,
    pub width_px: f64,
    pub height_px: f64,
    pub confidence: f64,
}

impl ObjectBox {
    pub fn area_px2(&self) -> f64 {
        self.width_px * self.height_px
    }

    /// Intersection over union: 0 where they do not touch, 1 for equal boxes.
    pub fn overlap(&self, other: &ObjectBox) -> f64 {
        let right = (self.left_px + self.width_px).min(other.left_px + other.width_px);
        let bottom = (self.top_px + self.height_px).min(other.top_px + other.height_px);
        let (width, height) = (
            right - self.left_px.max(other.left_px),
            bottom - self.top_px.max(other.top_px),
        );
        let shared = width.max(0.0) * height.max(0.0);
        shared / (self.area_px2() + other.area_px2() - shared)
    }

    /// What is wrong with it, as field, code and detail.
    pub fn faults(&self) -> impl Iterator<Item = (&'static str, &'static str, String)> + use<> {
        let fields = [
            ("left", self.left_px, false),
            ("top", self.top_px, false),
            ("width", self.width_px, true),
            ("height", self.height_px, true),
            ("confidence", self.confidence, false),
        ];
        let frame = (self.frame == 0).then(|| {
            (
                "frame",
                "out_of_range",
                "frames are counted from 1, found 0".to_owned(),
            )
        });
        let of_field = |(name, value, is_size): (&'static str, f64, bool)| match value {
            _ if !value.is_finite() => Some((
                name,
                "not_finite",
                format!("'{value}' is not a finite number"),
            )),
            _ if is_size && value <= 0.0 => Some((
                name,
                "out_of_range",
                format!("the {name} must be above 0, found {value}"),
            )),
            _ => None,
        };
        frame
            .into_iter()
            .chain(fields.into_iter().filter_map(of_field))
    }
}

/// What an annotator saw that no tracker has to find; its [`ObjectBox::object`] says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherBox {
    pub one: ObjectBox,
    /// Whether a track on it is neither right nor false.
    pub forgives: bool,
}

/// The objects of one video and their boxes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BoxSet {
    object_ids: Vec<String>,
    boxes: Vec<ObjectBox>,
    others: Vec<OtherBox>,
}

impl BoxSet {
    /// Boxes may come in any order.
    ///
    /// # Errors
    /// All faults: values that are not finite, sizes not above 0, frame 0, an object twice in one frame.
    pub fn new(object_ids: Vec<String>, mut boxes: Vec<ObjectBox>) -> Result<Self, Vec<Fault>> {
        boxes.sort_by_key(|one| (one.frame, one.object));
        let pointer =
            |one: &ObjectBox| format!("/objects/{}/{}", name_of(&object_ids, one), one.frame);
        let mut faults = Vec::new();
        for one in &boxes {
            faults.extend(one.faults().map(|(field, code, detail)| {
                Fault::new(format!("{}/{field}", pointer(one)), code, detail)
            }));
            if one.object as usize >= object_ids.len() {
                faults.push(Fault::new(
                    pointer(one),
                    "not_found",
                    format!("there is no object number {}", one.object),
                ));
            }
        }
        for pair in boxes
            .windows(2)
            .filter(|pair| (pair[0].frame, pair[0].object) == (pair[1].frame, pair[1].object))
        {
            let detail = format!(
                "object '{}' is in frame {} twice",
                name_of(&object_ids, &pair[1]),
                pair[1].frame
            );
            faults.push(Fault::new(pointer(&pair[1]), "duplicate", detail));
        }
        if faults.is_empty() {
            Ok(BoxSet {
                object_ids,
                boxes,
                others: Vec::new(),
            })
        } else {
            Err(faults)
        }
    }

    pub fn object_ids(&self) -> &[String] {
        &self.object_ids
    }

    /// Frame by frame, in each by object.
    pub fn boxes(&self) -> &[ObjectBox] {
        &self.boxes
    }

    /// Frame by frame.
    pub fn others(&self) -> &[OtherBox] {
        &self.others
    }

    /// Adds what nobody has to find.
    pub fn add_others(&mut self, others: Vec<OtherBox>) {
        self.others.extend(others);
        self.others.sort_by_key(|other| other.one.frame);
    }

    /// Without the boxes of these indices, which rise, and without objects that then have none.
    #[must_use]
    pub fn without(&self, left_out: &[u32]) -> BoxSet {
        let is_kept = |index: usize| left_out.binary_search(&(index as u32)).is_err();
        let mut numbers: Vec<Option<u32>> = vec![None; self.object_ids.len()];
        let mut boxes: Vec<ObjectBox> = Vec::with_capacity(self.boxes.len());
        for (index, one) in self.boxes.iter().enumerate() {
            if is_kept(index) {
                numbers[one.object as usize] = Some(0);
                boxes.push(*one);
            }
        }
        let mut object_ids = Vec::new();
        for (number, id) in numbers.iter_mut().zip(&self.object_ids) {
            if number.is_some() {
                *number = Some(object_ids.len() as u32);
                object_ids.push(id.clone());
            }
        }
        for one in &mut boxes {
            one.object = numbers[one.object as usize].unwrap_or_default();
        }
        BoxSet {
            object_ids,
            boxes,
            others: self.others.clone(),
        }
    }

    /// How many frames have a box.
    pub fn frames(&self) -> usize {
        self.boxes
            .chunk_by(|one, next| one.frame == next.frame)
            .count()
    }

    /// The first boxes, with the names of all objects.
    #[must_use]
    pub fn head(&self, limit: usize) -> BoxSet {
        BoxSet {
            object_ids: self.object_ids.clone(),
            boxes: self.boxes.iter().take(limit).copied().collect(),
            others: Vec::new(),
        }
    }
}

fn name_of<'n>(object_ids: &'n [String], one: &ObjectBox) -> &'n str {
    let id = object_ids.get(one.object as usize);
    id.map_or("?", String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(frame: u32, object: u32, left_px: f64, width_px: f64) -> ObjectBox {
        ObjectBox {
            frame,
            object,
            left_px,
            top_px: 0.0,
            width_px,
            height_px: 2.0,
            confidence: 1.0,
        }
    }

    #[test]
    fn overlap_is_intersection_over_union() {
        // 4 × 2 and 4 × 2, shifted by 1: 6 over 10. Shifted by 4: they touch, no more.
        assert_eq!(one(1, 0, 0.0, 4.0).overlap(&one(1, 1, 1.0, 4.0)), 0.6);
        assert_eq!(one(1, 0, 0.0, 4.0).overlap(&one(1, 1, 4.0, 4.0)), 0.0);
        assert_eq!(
            one(1, 0, 0.0, 4.0).overlap(&ObjectBox {
                top_px: 9.0,
                ..one(1, 1, 0.0, 4.0)
            }),
            0.0
        );
        assert_eq!(one(1, 0, 0.5, 4.0).overlap(&one(1, 1, 0.5, 4.0)), 1.0);
    }

    #[test]
    fn boxes_are_sorted_and_counted() {
        let set = BoxSet::new(
            vec!["a".into(), "b".into()],
            vec![
                one(7, 1, 0.0, 1.0),
                one(3, 0, 0.0, 1.0),
                one(7, 0, 0.0, 1.0),
            ],
        )
        .unwrap();
        assert_eq!(
            set.boxes()
                .iter()
                .map(|one| (one.frame, one.object))
                .collect::<Vec<_>>(),
            [(3, 0), (7, 0), (7, 1)]
        );
        assert_eq!((set.frames(), set.head(2).boxes().len()), (2, 2));
    }

    #[test]
    fn every_fault_is_named() {
        let boxes = vec![
            one(1, 0, f64::NAN, -1.0),
            one(0, 0, 0.0, 1.0),
            one(2, 0, 0.0, 1.0),
            one(2, 0, 5.0, 1.0),
            one(3, 4, 0.0, 1.0),
        ];
        let faults = BoxSet::new(vec!["a".into()], boxes).unwrap_err();
        let found: Vec<(&str, &str)> = faults
            .iter()
            .map(|fault| (fault.pointer.as_str(), fault.code.as_str()))
            .collect();
        let expected = [
            ("/objects/a/0/frame", "out_of_range"),
            ("/objects/a/1/left", "not_finite"),
            ("/objects/a/1/width", "out_of_range"),
            ("/objects/?/3", "not_found"),
            ("/objects/a/2", "duplicate"),
        ];
        assert_eq!(found, expected);
    }
}
