//! One way, as far as a layer, and how it goes on.

use super::MultiScan;
use super::links::Links;

/// A way, as far as a layer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// In the layer before; none of a root.
    pub parent: Option<u32>,
    /// The number of its root, its layer, and the detection there.
    pub root: u32,
    pub root_layer: u32,
    pub first: u32,
    /// The number of its second detection.
    pub second: Option<u32>,
    /// Of the root.
    pub origin: Option<u32>,
    /// Its index in its layer; none where the scan missed it.
    pub detection: Option<u32>,
    pub hits: u32,
    /// Scans since the last detection.
    pub gap: u32,
    /// The number of the last detection that may be its next one, as long as it has fewer than three.
    pub until: u32,
    pub score: f64,
    /// What the scan added to the score.
    pub log_ratio: f64,
    /// P_D there over the highest of the sensors.
    pub share: f64,
    pub nis: Option<f64>,
    /// What is believed of it: its row of the layer's problem, and the edge of its detection.
    pub row: u32,
    pub edge: Option<u32>,
}

/// A way that goes on into a layer.
pub(super) struct Way<'a> {
    pub rule: &'a MultiScan,
    pub links: &'a Links,
    pub layer: usize,
    /// After that one.
    pub layers_left: u32,
    pub node: Node,
}

impl Way<'_> {
    pub fn missed(&self, log_missed: f64) -> Option<Node> {
        let node = Node {
            detection: None,
            gap: self.node.gap + 1,
            score: self.node.score + log_missed,
            log_ratio: log_missed,
            nis: None,
            edge: None,
            ..self.node
        };
        let may_last = node.gap <= self.rule.max_gap_scans && self.may_suffice(&node);
        let has_more = node.hits > 2 || node.until >= self.links.firsts[self.layer + 1];
        (may_last && has_more).then_some(node)
    }

    pub fn hit(&self, detection: u32, log_likelihood: f64) -> Option<Node> {
        let number = self.links.firsts[self.layer] + detection;
        let is_second = self.node.hits == 1;
        let node = Node {
            detection: Some(detection),
            second: if is_second {
                Some(number)
            } else {
                self.node.second
            },
            hits: self.node.hits + 1,
            gap: 0,
            until: if is_second {
                self.links.pair_until(self.node.root, number)?
            } else {
                self.node.until
            },
            score: self.node.score + log_likelihood,
            log_ratio: log_likelihood,
            ..self.node
        };
        self.may_suffice(&node).then_some(node)
    }

    /// Whether enough detections may still come.
    fn may_suffice(&self, node: &Node) -> bool {
        node.hits + self.layers_left >= self.rule.min_detections
    }
}

/// Keeps so many ways: of each root the best first. Tells how many were cut.
pub(super) fn cut(nodes: &mut Vec<Node>, most: usize) -> u64 {
    if nodes.len() <= most {
        return 0;
    }
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    let root = |at: usize| nodes[at].root;
    order.sort_by(|&a, &b| {
        root(a)
            .cmp(&root(b))
            .then(nodes[b].score.total_cmp(&nodes[a].score))
    });
    let mut rank_of = vec![0; nodes.len()];
    for (place, &at) in order.iter().enumerate().skip(1) {
        let before = order[place - 1];
        rank_of[at] = if root(at) == root(before) {
            rank_of[before] + 1
        } else {
            0
        };
    }
    order.sort_by(|&a, &b| {
        let by_rank = rank_of[a].cmp(&rank_of[b]);
        by_rank
            .then(nodes[b].score.total_cmp(&nodes[a].score))
            .then(a.cmp(&b))
    });
    let mut is_kept = vec![false; nodes.len()];
    order.iter().take(most).for_each(|&at| is_kept[at] = true);
    let cut = nodes.len() - most;
    let mut at = 0;
    nodes.retain(|_| {
        at += 1;
        is_kept[at - 1]
    });
    cut as u64
}
