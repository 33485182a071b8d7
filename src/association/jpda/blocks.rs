//! The blocks of a cluster: its largest parts that no single track or detection holds together. Every cycle lies within
//! one block, and an edge on no cycle is a block of its own. Blocks share single vertices only, and hang together as a tree.
//!
//! # Reference
//! J. Hopcroft, R. Tarjan, Algorithm 447: efficient algorithms for graph manipulation, Comm. ACM 16(6), 1973.
//!
//! # Method
//! 1. Depth first, each vertex gets its number, and the least number that it or a vertex below it reaches by one edge.
//! 2. When no vertex below an edge reaches beyond the upper end of the edge, the edges met since then are a block, and it
//!    hangs in that end.

use super::cluster::Cluster;

#[derive(Debug, Clone, Default)]
pub(super) struct Blocks {
    /// Edges, grouped by block; every edge is in one.
    edges: Vec<u32>,
    /// For each block, the end of its part of `edges`. Whatever hangs in a block comes before it.
    ends: Vec<u32>,
    /// The vertex in which each block hangs.
    tops: Vec<u32>,
    /// For each vertex its number in the order of the search, from 1; 0 before it is met.
    order: Vec<u32>,
    /// The least number that it or a vertex below it reaches.
    reach: Vec<u32>,
    /// From the first vertex down to the one at hand.
    path: Vec<Visit>,
    /// Edges met that are in no block yet.
    open: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Visit {
    vertex: u32,
    /// The edge that led here; [`NONE`] for the first vertex.
    by: u32,
    /// How many of the vertex's edges were looked at.
    looked: u32,
}

const NONE: u32 = u32::MAX;

impl Blocks {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The edges of a block.
    pub(super) fn edges_of(&self, block: usize) -> &[u32] {
        &self.edges[self.range(block)]
    }

    /// The same, to be put in another order.
    pub(super) fn edges_of_mut(&mut self, block: usize) -> &mut [u32] {
        let range = self.range(block);
        &mut self.edges[range]
    }

    /// The vertex in which a block hangs: it shares that with its parent and with others that hang there.
    pub(super) fn top_of(&self, block: usize) -> u32 {
        self.tops[block]
    }

    fn range(&self, block: usize) -> std::ops::Range<usize> {
        let start = if block == 0 { 0 } else { self.ends[block - 1] };
        start as usize..self.ends[block] as usize
    }

    /// Finds the blocks of a connected cluster.
    pub(super) fn find(&mut self, cluster: &Cluster) {
        for list in [
            &mut self.edges,
            &mut self.ends,
            &mut self.tops,
            &mut self.order,
            &mut self.reach,
        ] {
            list.clear();
        }
        self.order.resize(cluster.vertices(), 0);
        self.reach.resize(cluster.vertices(), 0);
        let mut met = 0;
        self.enter(0, NONE, &mut met);
        while let Some(visit) = self.path.last_mut() {
            match cluster.edges_at(visit.vertex).get(visit.looked as usize) {
                Some(&edge) => {
                    visit.looked += 1;
                    let visit = *visit;
                    self.look(cluster, visit, edge, &mut met);
                }
                None => self.leave(),
            }
        }
    }

    fn enter(&mut self, vertex: u32, by: u32, met: &mut u32) {
        *met += 1;
        self.order[vertex as usize] = *met;
        self.reach[vertex as usize] = *met;
        self.path.push(Visit {
            vertex,
            by,
            looked: 0,
        });
    }

    fn look(&mut self, cluster: &Cluster, visit: Visit, edge: u32, met: &mut u32) {
        if edge == visit.by {
            return;
        }
        let [track, detection] = cluster.ends_of(edge);
        let other = if visit.vertex == track {
            detection
        } else {
            track
        };
        let (here, there) = (visit.vertex as usize, self.order[other as usize]);
        if there == 0 {
            self.open.push(edge);
            self.enter(other, edge, met);
        } else if there < self.order[here] {
            self.open.push(edge);
            self.reach[here] = self.reach[here].min(there);
        }
    }

    /// Step 2.
    fn leave(&mut self) {
        let below = self.path.pop();
        let (Some(below), Some(above)) = (below, self.path.last()) else {
            return;
        };
        let (from, to) = (below.vertex as usize, above.vertex as usize);
        self.reach[to] = self.reach[to].min(self.reach[from]);
        if self.reach[from] < self.order[to] {
            return;
        }
        while let Some(edge) = self.open.pop() {
            self.edges.push(edge);
            if edge == below.by {
                break;
            }
        }
        self.ends.push(self.edges.len() as u32);
        self.tops.push(above.vertex);
    }
}
