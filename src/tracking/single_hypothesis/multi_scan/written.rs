//! What waits to begin, written down, every number by its bits.

use super::{Beginnings, Counts, Layer, Node, OfSensor};
use crate::filtering::Filter;
use crate::tracking::bits;
use crate::tracking::single_hypothesis::written::{WrittenPoint, read_point, write_point};
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
pub struct WrittenBeginnings {
    layers: Vec<WrittenLayer>,
    scans: u32,
    counts: Counts,
}

#[derive(Serialize, Deserialize)]
struct WrittenLayer {
    number: u32,
    scan_index: u32,
    #[serde(with = "bits")]
    time_s: f64,
    points: Vec<Option<WrittenPoint>>,
    nodes: Vec<WrittenNode>,
}

#[derive(Serialize, Deserialize)]
struct WrittenNode {
    parent: Option<u32>,
    root: u32,
    first: u32,
    origin: Option<u32>,
    detection: Option<u32>,
    hits: u32,
    gap: u32,
    /// Score, what the scan added, share and NIS, which is NaN where there is none; then the belief.
    values: Vec<u64>,
}

impl<B, const K: usize> Beginnings<B, K> {
    pub fn write<F: Filter<K, Belief = B>>(&self) -> Vec<WrittenBeginnings> {
        let of_sensor = |sensor: &OfSensor<B, K>| WrittenBeginnings {
            layers: sensor.layers.iter().map(write_layer::<F, K>).collect(),
            scans: sensor.scans,
            counts: sensor.counts,
        };
        self.0.iter().map(of_sensor).collect()
    }

    /// `None` for what nobody wrote.
    pub fn read<F: Filter<K, Belief = B>>(written: &[WrittenBeginnings]) -> Option<Self> {
        let of_sensor = |sensor: &WrittenBeginnings| {
            let layers = sensor.layers.iter().map(read_layer::<F, K>);
            Some(OfSensor {
                layers: layers.collect::<Option<_>>()?,
                scans: sensor.scans,
                counts: sensor.counts,
            })
        };
        let all: Option<Vec<OfSensor<B, K>>> = written.iter().map(of_sensor).collect();
        let all = all.filter(|all| all.iter().all(is_sound))?;
        Some(Beginnings(all))
    }
}

/// Whether parents, roots and detections are where nodes say.
fn is_sound<B, const K: usize>(sensor: &OfSensor<B, K>) -> bool {
    let mut before = 0;
    for (index, layer) in sensor.layers.iter().enumerate() {
        let follows = layer.number == sensor.layers[0].number + index as u32;
        if !follows
            || !layer
                .nodes
                .iter()
                .all(|node| fits(sensor, index, before, node))
        {
            return false;
        }
        before = layer.nodes.len();
    }
    true
}

/// The same of a node in a layer, with so many nodes in the layer before.
fn fits<B, const K: usize>(
    sensor: &OfSensor<B, K>,
    index: usize,
    before: usize,
    node: &Node<B>,
) -> bool {
    let points = sensor.layers[index].points.len();
    let at = node.root.checked_sub(sensor.layers[0].number);
    let root = at.and_then(|at| {
        sensor
            .layers
            .get(at as usize)
            .filter(|_| at as usize <= index)
    });
    root.is_some_and(|root| (node.first as usize) < root.points.len())
        && node.parent.is_none_or(|parent| (parent as usize) < before)
        && node
            .detection
            .is_none_or(|detection| (detection as usize) < points)
}

fn write_layer<F: Filter<K>, const K: usize>(layer: &Layer<F::Belief, K>) -> WrittenLayer {
    let points = layer.points.iter();
    WrittenLayer {
        number: layer.number,
        scan_index: layer.scan_index,
        time_s: layer.time_s,
        points: points
            .map(|point| point.as_ref().map(|point| write_point(point, 0)))
            .collect(),
        nodes: layer.nodes.iter().map(write_node::<F, K>).collect(),
    }
}

fn read_layer<F: Filter<K>, const K: usize>(layer: &WrittenLayer) -> Option<Layer<F::Belief, K>> {
    let point = |point: &Option<WrittenPoint>| match point {
        None => Some(None),
        Some(point) => Some(Some(read_point(point)?.point)),
    };
    Some(Layer {
        number: layer.number,
        scan_index: layer.scan_index,
        time_s: layer.time_s,
        points: layer.points.iter().map(point).collect::<Option<_>>()?,
        nodes: layer
            .nodes
            .iter()
            .map(read_node::<F, K>)
            .collect::<Option<_>>()?,
    })
}

fn write_node<F: Filter<K>, const K: usize>(node: &Node<F::Belief>) -> WrittenNode {
    let nis = node.nis.unwrap_or(f64::NAN);
    let mut values = vec![node.score, node.log_ratio, node.share, nis];
    F::pack(&node.belief, &mut values);
    WrittenNode {
        parent: node.parent,
        root: node.root,
        first: node.first,
        origin: node.origin,
        detection: node.detection,
        hits: node.hits,
        gap: node.gap,
        values: bits::of(&values),
    }
}

fn read_node<F: Filter<K>, const K: usize>(node: &WrittenNode) -> Option<Node<F::Belief>> {
    let values = bits::values(&node.values);
    let (&[score, log_ratio, share, nis], belief) = values.split_first_chunk()?;
    Some(Node {
        parent: node.parent,
        root: node.root,
        first: node.first,
        origin: node.origin,
        detection: node.detection,
        hits: node.hits,
        gap: node.gap,
        score,
        log_ratio,
        share,
        nis: Some(nis).filter(|nis| !nis.is_nan()),
        belief: F::unpack(belief)?,
    })
}
