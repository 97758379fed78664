use nlmodes_modal::{Event, ModalBranch};

/// Four points that tell the story of a branch in pictures of its motion (Fig. 4): the first touch, two on the way, and
/// the first branch point; the last point where there is none. Fewer for a shorter branch.
pub fn figure_points(branch: &ModalBranch) -> Vec<usize> {
    let last = branch.points.iter().position(|point| point.has_event(Event::BranchPoint));
    way_points(branch, last.unwrap_or(branch.points.len().saturating_sub(1)))
}

/// Four points on the way from the first one to point `last`, both among them; fewer on a shorter way.
pub fn way_points(branch: &ModalBranch, last: usize) -> Vec<usize> {
    spread(branch, last, &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
}

/// Two points for time histories (Fig. 9): at four tenths of the way along the branch, and its last.
pub fn reference_points(branch: &ModalBranch) -> Vec<usize> {
    spread(branch, branch.points.len().saturating_sub(1), &[0.4, 1.0])
}

/// Points nearest to the given shares of the way to point `last`, measured in the logarithms of frequency and energy.
fn spread(branch: &ModalBranch, last: usize, shares: &[f64]) -> Vec<usize> {
    let points = &branch.points;
    if points.is_empty() {
        return Vec::new();
    }
    let mut way = vec![0.0];
    for pair in points[..=last].windows(2) {
        let energy = (pair[1].kinetic_energy / pair[0].kinetic_energy).ln();
        // From rest on there is no way in the logarithm.
        let energy = if energy.is_finite() { energy } else { 0.0 };
        let frequency = (pair[1].omega / pair[0].omega).ln();
        way.push(way[way.len() - 1] + energy.hypot(frequency));
    }
    let total = way[last];
    let nearest = |share: f64| {
        (0..=last).min_by(|&i, &j| (way[i] - share * total).abs().total_cmp(&(way[j] - share * total).abs()))
    };
    let mut found: Vec<usize> = shares.iter().filter_map(|s| nearest(*s)).collect();
    found.dedup();
    found
}
