//! CLEAR, Identity and HOTA the plain way: full matrices, every matching tried.

use trackloom_domain::model::boxes::BoxSet;

/// Similarities of all truths with all tracks at each step; `None` where one of the two is absent.
pub struct Scene {
    steps: Vec<Vec<Vec<Option<f64>>>>,
    truth_points: Vec<f64>,
    track_points: Vec<f64>,
    /// Whether each exists at each step.
    truths: Vec<Vec<bool>>,
    tracks: Vec<Vec<bool>>,
}

pub struct Clear {
    pub matches: f64,
    pub switches: f64,
    pub fragments: f64,
}

impl Scene {
    pub fn new(truth: &BoxSet, tracks: &BoxSet, frames: u32) -> Scene {
        let find = |set: &BoxSet, frame: u32, object: usize| {
            set.boxes()
                .iter()
                .find(|one| one.frame == frame && one.object as usize == object)
                .copied()
        };
        let (truth_count, track_count) = (truth.object_ids().len(), tracks.object_ids().len());
        let similarity = |frame, i, j| {
            let (a, b) = (find(truth, frame, i)?, find(tracks, frame, j)?);
            let side = |a_from: f64, a_size: f64, b_from: f64, b_size: f64| {
                ((a_from + a_size).min(b_from + b_size) - a_from.max(b_from)).max(0.0)
            };
            let shared = side(a.left_px, a.width_px, b.left_px, b.width_px)
                * side(a.top_px, a.height_px, b.top_px, b.height_px);
            Some(shared / (a.width_px * a.height_px + b.width_px * b.height_px - shared))
        };
        let matrix = |frame| {
            (0..truth_count)
                .map(|i| (0..track_count).map(|j| similarity(frame, i, j)).collect())
                .collect()
        };
        let presence = |set: &BoxSet, count: usize| -> Vec<Vec<bool>> {
            (1..=frames)
                .map(|frame| {
                    (0..count)
                        .map(|object| find(set, frame, object).is_some())
                        .collect()
                })
                .collect()
        };
        let points = |set: &BoxSet, count: usize| {
            (0..count)
                .map(|object| {
                    set.boxes()
                        .iter()
                        .filter(|one| one.object as usize == object)
                        .count() as f64
                })
                .collect()
        };
        Scene {
            steps: (1..=frames).map(matrix).collect(),
            truth_points: points(truth, truth_count),
            track_points: points(tracks, track_count),
            truths: presence(truth, truth_count),
            tracks: presence(tracks, track_count),
        }
    }

    fn zeros(&self) -> Vec<Vec<f64>> {
        vec![vec![0.0; self.track_points.len()]; self.truth_points.len()]
    }

    pub fn idtp(&self) -> f64 {
        let mut near = self.zeros();
        for step in &self.steps {
            for (i, row) in step.iter().enumerate() {
                for (j, similarity) in row.iter().enumerate() {
                    near[i][j] += f64::from(u8::from(
                        similarity.is_some_and(|similarity| similarity >= 0.5),
                    ));
                }
            }
        }
        best(&near).iter().map(|&(i, j)| near[i][j]).sum()
    }

    pub fn clear(&self) -> Clear {
        let mut counts = Clear {
            matches: 0.0,
            switches: 0.0,
            fragments: 0.0,
        };
        let truths = self.truth_points.len();
        let (mut before, mut last, mut runs) =
            (vec![None; truths], vec![None; truths], vec![0.0; truths]);
        for (number, step) in self.steps.iter().enumerate() {
            if !self.truths[number].contains(&true) || !self.tracks[number].contains(&true) {
                continue;
            }
            let mut worth = self.zeros();
            for (i, row) in step.iter().enumerate() {
                for (j, similarity) in row.iter().enumerate() {
                    if let Some(similarity) = similarity.filter(|similarity| *similarity >= 0.5) {
                        worth[i][j] = similarity + if before[i] == Some(j) { 1000.0 } else { 0.0 };
                    }
                }
            }
            let mut now = vec![None; truths];
            for (i, j) in best(&worth) {
                counts.matches += 1.0;
                counts.switches += f64::from(u8::from(last[i].is_some_and(|track| track != j)));
                runs[i] += f64::from(u8::from(before[i].is_none()));
                (now[i], last[i]) = (Some(j), Some(j));
            }
            before = now;
        }
        counts.fragments = runs.iter().map(|runs| (runs - 1.0f64).max(0.0)).sum();
        counts
    }

    /// The curves over the thresholds, by name.
    pub fn hota(&self) -> Vec<(&'static str, Vec<f64>)> {
        let alignment = self.alignment();
        let matches: Vec<(usize, usize, f64)> = self
            .steps
            .iter()
            .flat_map(|step| aligned(step, &alignment))
            .collect();
        let truth_points: f64 = self.truth_points.iter().sum();
        let track_points: f64 = self.track_points.iter().sum();
        let names = [
            "tp", "det_a", "det_re", "det_pr", "ass_a", "ass_re", "ass_pr", "loc_a", "hota", "owta",
        ];
        let mut curves: Vec<(&'static str, Vec<f64>)> =
            names.map(|name| (name, Vec::new())).to_vec();
        for number in 1..20 {
            let alpha = f64::from(number) * 0.05 - 1e-12;
            let kept: Vec<_> = matches.iter().filter(|found| found.2 >= alpha).collect();
            let tp = kept.len() as f64;
            let together = |i: usize, j: usize| {
                kept.iter()
                    .filter(|found| (found.0, found.1) == (i, j))
                    .count() as f64
            };
            let mean = |part: &dyn Fn(usize, usize, f64) -> f64, alone: f64| {
                let sum: f64 = kept
                    .iter()
                    .map(|&&(i, j, similarity)| part(i, j, similarity))
                    .sum();
                if tp > 0.0 { sum / tp } else { alone }
            };
            let ass_a = mean(
                &|i, j, _| {
                    together(i, j) / (self.truth_points[i] + self.track_points[j] - together(i, j))
                },
                0.0,
            );
            let det_a = tp / (truth_points + track_points - tp);
            let det_re = tp / truth_points.max(1.0);
            let values = [
                tp,
                det_a,
                det_re,
                tp / track_points.max(1.0),
                ass_a,
                mean(&|i, j, _| together(i, j) / self.truth_points[i], 0.0),
                mean(&|i, j, _| together(i, j) / self.track_points[j], 0.0),
                mean(&|_, _, similarity| similarity, 1.0),
                (det_a * ass_a).sqrt(),
                (det_re * ass_a).sqrt(),
            ];
            curves
                .iter_mut()
                .zip(values)
                .for_each(|(curve, value)| curve.1.push(value));
        }
        curves
    }

    fn alignment(&self) -> Vec<Vec<f64>> {
        let mut shares = self.zeros();
        for step in &self.steps {
            let at = |i: usize, j: usize| step[i][j].unwrap_or(0.0);
            for (i, row) in shares.iter_mut().enumerate() {
                for (j, share) in row.iter_mut().enumerate() {
                    let of_row: f64 = (0..self.track_points.len()).map(|other| at(i, other)).sum();
                    let of_column: f64 =
                        (0..self.truth_points.len()).map(|other| at(other, j)).sum();
                    if at(i, j) > 0.0 {
                        *share += at(i, j) / (of_row + of_column - at(i, j));
                    }
                }
            }
        }
        for (i, row) in shares.iter_mut().enumerate() {
            for (j, share) in row.iter_mut().enumerate() {
                *share /= (self.truth_points[i] + self.track_points[j] - *share).max(1.0);
            }
        }
        shares
    }
}

/// The matching of a step by alignment times similarity.
fn aligned(step: &[Vec<Option<f64>>], alignment: &[Vec<f64>]) -> Vec<(usize, usize, f64)> {
    let worth = |(row, alignments): (&Vec<Option<f64>>, &Vec<f64>)| -> Vec<f64> {
        row.iter()
            .zip(alignments)
            .map(|(similarity, alignment)| similarity.unwrap_or(0.0) * alignment)
            .collect()
    };
    let worth: Vec<Vec<f64>> = step.iter().zip(alignment).map(worth).collect();
    best(&worth)
        .into_iter()
        .map(|(i, j)| (i, j, step[i][j].expect("what is matched exists")))
        .collect()
}

/// The matching with the greatest sum, of pairs with a worth above 0: every one is tried.
fn best(worth: &[Vec<f64>]) -> Vec<(usize, usize)> {
    fn search(
        worth: &[Vec<f64>],
        i: usize,
        taken: &mut Vec<(usize, usize)>,
        sum: f64,
        found: &mut (f64, Vec<(usize, usize)>),
    ) {
        if i == worth.len() {
            if sum > found.0 {
                *found = (sum, taken.clone());
            }
            return;
        }
        search(worth, i + 1, taken, sum, found);
        for (j, &gain) in worth[i].iter().enumerate() {
            if gain > 0.0 && taken.iter().all(|pair| pair.1 != j) {
                taken.push((i, j));
                search(worth, i + 1, taken, sum + gain, found);
                taken.pop();
            }
        }
    }
    let mut found = (0.0, Vec::new());
    search(worth, 0, &mut Vec::new(), 0.0, &mut found);
    found.1
}
