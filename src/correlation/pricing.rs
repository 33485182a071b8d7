//! Prices of the tracks of a cluster whose tuples are too many to be listed: those that matter are looked for, as prices ask for them.
//!
//! # Reference
//! M. E. Lübbecke, J. Desrosiers, Selected topics in column generation, Operations Research 53, 2005, 1007–1023.
//!
//! # Symbols
//! c(T), u(t), r(T), r*(t), L(u) as in [`super::tuples`]; a(t) = Σ c(t, m) − u(t) over the members m of a tuple that t may join.
//!
//! # Method
//! For costs that are sums over all pairs.
//! 1. The first prices share the cost of each tuple of an answer that is known among its members: u(t) = ½ Σ c(t, m).
//! 2. For each track the tuple of r*(t) is looked for, sensor by sensor, the best candidate first. What is begun is given up
//!    where r(T) + Σ min(0, min (a(t) + ½ Σ best links of t)) over the sensors yet to come undercuts nothing.
//! 3. L(u) is a bound; the best one counts. The tuples with r(T) < 0 that the search came by join those known, and the subgradient
//!    steps of [`super::tuples`] on these bring the next prices. It ends when L has reached the answer, or after some searches.

use super::cluster::{Cluster, Edge};
use super::partition::Partition;
use super::tuples::{Relaxation, TooLarge, Tuple, better_prices};

/// Subgradient steps on the tuples known, from one search to the next.
const STEPS: usize = 150;

/// Searches of all tracks; more have hardly ever made the bound better.
const SEARCHES: usize = 30;

/// Above this r(T) is not negative but rounded.
const ROUNDING: f64 = -1e-9;

/// Prices with their bound, and the tuples that were found. `nodes` is what may be looked at; `None` where they do not suffice for a
/// bound.
pub(super) fn price(cluster: &Cluster, known: &Partition, mut nodes: u64) -> Option<Relaxation> {
    let mut search = PricingSearch::new(cluster, shared(cluster, known));
    let mut tuples: Vec<Vec<Tuple>> = (0..cluster.len()).map(|_| Vec::new()).collect();
    known
        .tuples()
        .filter(|tuple| tuple.len() > 1)
        .for_each(|members| add(cluster, &members, &mut tuples));
    let known = known.cost();
    let mut found = Relaxation {
        bound: f64::NEG_INFINITY,
        multipliers: search.prices.clone(),
        bounds: Vec::new(),
        tuples: Vec::new(),
    };
    while found.bounds.len() < SEARCHES && known - found.bound > 1e-9 * known.abs() {
        let Ok(value) = search.find(&mut nodes, &mut tuples) else {
            break;
        };
        found.bounds.push(value);
        if value > found.bound {
            found.bound = value;
            found.multipliers.copy_from_slice(&search.prices);
        }
        search.prices = better_prices(search.prices.clone(), &tuples, known, STEPS);
    }
    (found.bound > f64::NEG_INFINITY).then_some(Relaxation { tuples, ..found })
}

/// Puts a tuple among those known, unless it is there.
fn add(cluster: &Cluster, members: &[u32], tuples: &mut [Vec<Tuple>]) {
    let of_lowest = &mut tuples[members[0] as usize];
    if of_lowest.iter().all(|tuple| tuple.members != members) {
        of_lowest.push(Tuple {
            members: members.to_vec(),
            cost: cluster.cost(members),
        });
    }
}

/// Step 1.
fn shared(cluster: &Cluster, known: &Partition) -> Vec<f64> {
    let mut prices = vec![0.0; cluster.len()];
    for tuple in known.tuples() {
        for &track in &tuple {
            let links = tuple
                .iter()
                .filter(|&&other| other != track)
                .filter_map(|&other| cluster.link(track, other));
            prices[track as usize] = (0.5 * links.sum::<f64>()).min(0.0);
        }
    }
    prices
}

/// The search for r*(t).
struct PricingSearch<'a> {
    cluster: &'a Cluster<'a>,
    prices: Vec<f64>,
    /// [`Cluster::best_links`].
    rests: Vec<f64>,
    members: Vec<u32>,
    /// For each number of members the candidates.
    levels: Vec<Candidates>,
    least: f64,
    /// The tuples that were the best of the search for a time, one behind the other.
    found: Vec<u32>,
    found_ends: Vec<usize>,
}

/// Tracks that all members are linked with, by sensor, with their a(t).
#[derive(Debug, Clone, Default)]
struct Candidates {
    edges: Vec<Edge>,
    /// Where those of each sensor end.
    ends: Vec<usize>,
}

impl Candidates {
    fn of_sensor(&self, sensor: usize) -> &[Edge] {
        let begin = if sensor == 0 {
            0
        } else {
            self.ends[sensor - 1]
        };
        &self.edges[begin..self.ends[sensor]]
    }
}

impl<'a> PricingSearch<'a> {
    fn new(cluster: &'a Cluster<'a>, prices: Vec<f64>) -> Self {
        let levels = vec![Candidates::default(); cluster.sensors() + 1];
        PricingSearch {
            cluster,
            prices,
            rests: cluster.best_links(),
            members: Vec::new(),
            levels,
            least: 0.0,
            found: Vec::new(),
            found_ends: Vec::new(),
        }
    }

    /// Step 2 for every track: L. The tuples found join those known.
    fn find(&mut self, nodes: &mut u64, tuples: &mut [Vec<Tuple>]) -> Result<f64, TooLarge> {
        let mut value: f64 = self.prices.iter().sum();
        for track in 0..self.cluster.len() as u32 {
            self.search(track, nodes)?;
            value += self.least;
            let mut begin = 0;
            for &end in &self.found_ends {
                add(self.cluster, &self.found[begin..end], tuples);
                begin = end;
            }
        }
        Ok(value)
    }

    /// Looks for r*(t), `least`, at most 0.
    fn search(&mut self, track: u32, nodes: &mut u64) -> Result<(), TooLarge> {
        let sensor = self.cluster.sensor_of(track);
        self.least = 0.0;
        self.found.clear();
        self.found_ends.clear();
        self.members.clear();
        self.members.push(track);
        let level = &mut self.levels[1];
        level.edges.clear();
        level.ends.clear();
        for later in 0..self.cluster.sensors() {
            let edges = if later > sensor {
                self.cluster.edges_to(track, later)
            } else {
                &[]
            };
            let with_price = |edge: &Edge| Edge {
                track: edge.track,
                cost: edge.cost - self.prices[edge.track as usize],
            };
            level.edges.extend(edges.iter().map(with_price));
            level.ends.push(level.edges.len());
        }
        self.descend(sensor + 1, -self.prices[track as usize], nodes)
    }

    /// `rest` is r of the members.
    fn descend(&mut self, next: usize, rest: f64, nodes: &mut u64) -> Result<(), TooLarge> {
        *nodes = nodes.checked_sub(1).ok_or(TooLarge)?;
        if rest < self.least + ROUNDING && self.members.len() > 1 {
            self.least = rest;
            self.found.extend_from_slice(&self.members);
            self.found_ends.push(self.found.len());
        }
        let depth = self.members.len();
        let Some(sensor) = (next..self.cluster.sensors())
            .find(|&sensor| !self.levels[depth].of_sensor(sensor).is_empty())
        else {
            return Ok(());
        };
        if rest + self.at_best(sensor) >= self.least + ROUNDING {
            return Ok(());
        }
        let mut tried = f64::NEG_INFINITY;
        let mut last = None;
        // The candidates in the order of their a(t), of equals the lower track first.
        while let Some(edge) = next_of(self.levels[depth].of_sensor(sensor), tried, last) {
            (tried, last) = (edge.cost, Some(edge.track));
            self.join(edge.track, sensor);
            self.members.push(edge.track);
            self.descend(sensor + 1, rest + edge.cost, nodes)?;
            self.members.pop();
        }
        self.descend(sensor + 1, rest, nodes)
    }

    /// What the sensors from one on can bring at best.
    fn at_best(&self, next: usize) -> f64 {
        let (level, stride) = (&self.levels[self.members.len()], self.cluster.sensors() + 1);
        let mut begin = if next == 0 { 0 } else { level.ends[next - 1] };
        let mut sum = 0.0;
        for &end in &level.ends[next..] {
            let mut least = 0.0;
            for edge in &level.edges[begin..end] {
                let at_best = edge.cost + 0.5 * self.rests[edge.track as usize * stride + next];
                least = if at_best < least { at_best } else { least };
            }
            sum += least;
            begin = end;
        }
        sum
    }

    /// The candidates when a track of a sensor joins.
    fn join(&mut self, track: u32, sensor: usize) {
        let (before, after) = self.levels.split_at_mut(self.members.len() + 1);
        let (before, level) = (&before[self.members.len()], &mut after[0]);
        level.edges.clear();
        level.ends.clear();
        for later in 0..self.cluster.sensors() {
            if later > sensor {
                let links = self.cluster.edges_to(track, later);
                let mut place = 0;
                for candidate in before.of_sensor(later) {
                    while place < links.len() && links[place].track < candidate.track {
                        place += 1;
                    }
                    if place < links.len() && links[place].track == candidate.track {
                        level.edges.push(Edge {
                            track: candidate.track,
                            cost: candidate.cost + links[place].cost,
                        });
                    }
                }
            }
            level.ends.push(level.edges.len());
        }
    }
}

/// The candidate after the one last tried.
fn next_of(candidates: &[Edge], tried: f64, last: Option<u32>) -> Option<Edge> {
    let is_later = |edge: &&Edge| {
        edge.cost > tried || (edge.cost == tried && last.is_some_and(|last| edge.track > last))
    };
    candidates
        .iter()
        .filter(is_later)
        .copied()
        .reduce(|best, edge| if edge.cost < best.cost { edge } else { best })
}
