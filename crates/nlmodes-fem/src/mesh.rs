use crate::FemError;
use crate::error::positive;

/// A node is at a position if its distance is at most this fraction of the length of the mesh.
const TOLERANCE: f64 = 1e-9;

/// Share of the shorter element nearer than which no node is put beside one that stays: shorter elements would cost the
/// others their digits.
pub const NEAREST: f64 = 1e-2;

/// Nodes along a straight line from 0 to L.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    nodes: Vec<f64>,
    lengths: Vec<f64>,
}

impl Mesh {
    /// Equal elements.
    ///
    /// # Errors
    /// As [`Mesh::graded`].
    pub fn uniform(length: f64, elements: usize) -> Result<Self, FemError> {
        Self::graded(length, elements, 1.0)
    }

    /// Element lengths in geometric progression: `h_i = h_0 q^i` with `h_0 / h_(n−1) = grading` and `Σ h_i = L`.
    ///
    /// The nodes are at `x_i = L (1 − q^i) / (1 − q^n)`, the last one exactly at `L`. A `grading` above one refines
    /// towards the end. One element has no grading.
    ///
    /// ```
    /// let mesh = nlmodes_fem::Mesh::graded(7.0, 3, 4.0)?;
    /// for (x, expected) in mesh.nodes().iter().zip([0.0, 4.0, 6.0, 7.0]) {
    ///     assert!((x - expected).abs() < 1e-14);
    /// }
    /// # Ok::<(), nlmodes_fem::FemError>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::NotPositive`] for `length` and `grading`, [`FemError::NoElements`], [`FemError::DegenerateMesh`] if
    /// neighbouring nodes coincide.
    pub fn graded(length: f64, elements: usize, grading: f64) -> Result<Self, FemError> {
        let (length, grading) = (positive("length", length)?, positive("mesh grading", grading)?);
        let n = match elements {
            0 => return Err(FemError::NoElements),
            n => n as f64,
        };
        let log_q = if elements > 1 { -grading.ln() / (n - 1.0) } else { 0.0 };
        // (1 − q^i) / (1 − q^n), without cancellation for q near one; i/n for q = 1.
        let share = |i: usize| match log_q {
            0.0 => i as f64 / n,
            log_q => (i as f64 * log_q).exp_m1() / (n * log_q).exp_m1(),
        };
        let mut nodes: Vec<f64> = (0..=elements).map(|i| length * share(i)).collect();
        nodes[elements] = length;
        let first = length * share(1);
        let lengths = (0..elements).map(|i| first * (i as f64 * log_q).exp()).collect();
        let apart = |pair: &[f64]| pair[0].is_finite() && pair[1] > pair[0];
        match nodes.windows(2).position(|pair| !apart(pair)) {
            Some(element) => Err(FemError::DegenerateMesh { element, elements, grading }),
            None => Ok(Self { nodes, lengths }),
        }
    }

    /// Nodes at these positions, m.
    ///
    /// # Errors
    /// [`FemError::NoElements`], or [`FemError::Nodes`] where they do not ascend from 0.
    pub fn of_nodes(nodes: Vec<f64>) -> Result<Self, FemError> {
        if nodes.len() < 2 {
            return Err(FemError::NoElements);
        }
        let lengths: Vec<f64> = nodes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let wrong = lengths.iter().position(|h| !(h.is_finite() && *h > 0.0));
        match wrong.or((nodes[0] != 0.0).then_some(0)) {
            Some(element) => Err(FemError::Nodes { element }),
            None => Ok(Self { nodes, lengths }),
        }
    }

    /// The same mesh with nodes at these positions as well, m: the nearest node is moved there or, where that is an end
    /// or at another of the positions, one is put there. A position where there is a node, to `tolerance` of the
    /// shorter element beside it, keeps that. No node comes nearer than a hundredth of the shorter element to one that
    /// stays, and none beyond the ends: such positions are left out.
    ///
    /// ```
    /// let mesh = nlmodes_fem::Mesh::uniform(1.0, 4)?.with_nodes_at(&[0.3, 0.9], 1e-4);
    /// assert_eq!(mesh.nodes(), [0.0, 0.3, 0.5, 0.75, 0.9, 1.0]);
    /// # Ok::<(), nlmodes_fem::FemError>(())
    /// ```
    pub fn with_nodes_at(&self, positions: &[f64], tolerance: f64) -> Self {
        let mut sorted: Vec<f64> = positions.iter().copied().filter(|x| *x > 0.0 && *x < self.length()).collect();
        sorted.sort_by(f64::total_cmp);
        let mut nodes: Vec<(f64, bool)> = self.nodes.iter().map(|x| (*x, false)).collect();
        let nearest = |nodes: &[(f64, bool)], x: f64| {
            let after = nodes.partition_point(|(node, _)| *node < x).clamp(1, nodes.len() - 1);
            let node = if x - nodes[after - 1].0 < nodes[after].0 - x { after - 1 } else { after };
            let beside = nodes[node.saturating_sub(1)..(node + 2).min(nodes.len())].windows(2);
            let shorter = beside.map(|pair| pair[1].0 - pair[0].0).fold(f64::INFINITY, f64::min);
            (node, (nodes[node].0 - x).abs() / shorter, after)
        };
        let last = nodes.len() - 1;
        (nodes[0].1, nodes[last].1) = (true, true);
        for x in &sorted {
            let (node, distance, _) = nearest(&nodes, *x);
            nodes[node].1 |= distance <= tolerance;
        }
        for x in sorted {
            match nearest(&nodes, x) {
                (_, distance, _) if distance <= tolerance => {}
                (node, ..) if !nodes[node].1 => nodes[node] = (x, true),
                (_, distance, after) if distance >= NEAREST => nodes.insert(after, (x, true)),
                _ => {}
            }
        }
        let nodes: Vec<f64> = nodes.into_iter().map(|(x, _)| x).collect();
        if nodes == self.nodes {
            return self.clone();
        }
        let lengths = nodes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Self { nodes, lengths }
    }

    /// Each element halved.
    pub fn halved(&self) -> Self {
        let inner = self.nodes.windows(2).flat_map(|pair| [pair[0], 0.5 * (pair[0] + pair[1])]);
        let nodes = inner.chain(self.nodes.last().copied()).collect();
        Self { nodes, lengths: self.lengths.iter().flat_map(|h| [0.5 * h; 2]).collect() }
    }

    /// The same mesh refined toward some nodes: each adjacent element is halved, then the half next to the node again,
    /// until that is shorter than the element by `factor`. All nodes are kept. An element between two such nodes is
    /// halved toward both.
    ///
    /// ```
    /// let mesh = nlmodes_fem::Mesh::uniform(2.0, 2)?.refined(&[2], 4.0)?;
    /// assert_eq!(mesh.nodes(), [0.0, 1.0, 1.5, 1.75, 2.0]);
    /// # Ok::<(), nlmodes_fem::FemError>(())
    /// ```
    ///
    /// # Errors
    /// [`FemError::NotPositive`] for the factor, [`FemError::DegenerateMesh`] if neighbouring nodes coincide.
    pub fn refined(&self, beside: &[usize], factor: f64) -> Result<Self, FemError> {
        let times = positive("refinement", factor)?.log2().ceil().max(0.0) as i32;
        let is = |node: usize| beside.contains(&node);
        let (mut nodes, mut lengths) = (vec![0.0], Vec::new());
        for (i, &h) in self.lengths.iter().enumerate() {
            let shares = shares(is(i), is(i + 1), times);
            let inner = shares.iter().scan(0.0, |at, share| {
                *at += share;
                Some(self.nodes[i] + h * *at)
            });
            nodes.extend(inner.take(shares.len() - 1));
            nodes.push(self.nodes[i + 1]);
            lengths.extend(shares.iter().map(|share| h * share));
        }
        match nodes.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(element) => Err(FemError::DegenerateMesh { element, elements: lengths.len(), grading: factor }),
            None => Ok(Self { nodes, lengths }),
        }
    }

    /// Positions of the nodes, m, ascending from 0 to L.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Lengths of the elements, m.
    pub fn element_lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Length `L`, m.
    pub fn length(&self) -> f64 {
        self.nodes[self.lengths.len()]
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.lengths.len()
    }

    /// Index of the node at `position` (m), to 1e-9 of the length.
    ///
    /// # Errors
    /// [`FemError::NotANode`] with the nearest one.
    pub fn find_node(&self, position: f64) -> Result<usize, FemError> {
        let distance = |i: usize| (self.nodes[i] - position).abs();
        let after = self.nodes.partition_point(|x| *x < position).min(self.elements());
        let before = after.saturating_sub(1);
        let node = if distance(before) < distance(after) { before } else { after };
        if distance(node) <= TOLERANCE * self.length() {
            Ok(node)
        } else {
            Err(FemError::NotANode { asked: position, nearest: self.nodes[node], node })
        }
    }
}

/// Fractions into which an element is split by repeated halving toward its start, its end, or both; sums of powers of
/// two, which are exact.
fn shares(toward_start: bool, toward_end: bool, times: i32) -> Vec<f64> {
    match (toward_start, toward_end) {
        _ if times == 0 => vec![1.0],
        (false, false) => vec![1.0],
        (false, true) => (1..=times).map(|i| 0.5_f64.powi(i)).chain([0.5_f64.powi(times)]).collect(),
        (true, false) => shares(false, true, times).into_iter().rev().collect(),
        (true, true) => {
            let halves = |start, end| shares(start, end, times - 1).into_iter().map(|share| 0.5 * share);
            halves(true, false).chain(halves(false, true)).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_geometric_and_fill_the_line() {
        for (elements, grading) in
            [(1, 1.0), (1, 3.0), (100, 1.0), (21, 9.1958536), (21, 1.0 / 9.1958536), (7, 1.0 + 1e-12)]
        {
            let mesh = Mesh::graded(0.62975520, elements, grading).unwrap();
            assert_eq!((mesh.nodes()[0], mesh.length(), mesh.elements()), (0.0, 0.62975520, elements));
            let h = mesh.element_lengths();
            assert!((h.iter().sum::<f64>() / mesh.length() - 1.0).abs() < 1e-14);
            for (i, pair) in mesh.nodes().windows(2).enumerate() {
                assert!(((pair[1] - pair[0]) / h[i] - 1.0).abs() < 1e-12);
            }
            if elements > 1 {
                assert!((h[0] / h[elements - 1] / grading - 1.0).abs() < 1e-13);
                assert!(h.windows(2).all(|w| (w[1] / w[0] / (h[1] / h[0]) - 1.0).abs() < 1e-13));
            }
        }
    }

    #[test]
    fn nodes_are_found_to_a_billionth_of_the_length() {
        let mesh = Mesh::uniform(20.0, 100).unwrap();
        for (position, node) in
            [(0.0, 0), (20.0, 100), (0.2, 1), (7.4, 37), (7.4 + 1e-8, 37), (20.0 - 1e-8, 100), (-1e-9, 0)]
        {
            assert_eq!(mesh.find_node(position), Ok(node));
        }
        for (asked, nearest, node) in [(7.45, 7.4, 37), (25.0, 20.0, 100), (-3.0, 0.0, 0)] {
            match mesh.find_node(asked).unwrap_err() {
                FemError::NotANode { asked: a, nearest: x, node: i } => {
                    assert!(a == asked && (x - nearest).abs() < 0.051 && i.abs_diff(node) <= 1);
                }
                other => panic!("{other}"),
            }
        }
        assert!(mesh.find_node(f64::NAN).is_err());
    }

    #[test]
    fn elements_beside_a_node_are_halved_toward_it() {
        for length in [2.0, 2e-3, 2e3] {
            let mesh = Mesh::uniform(length, 4).unwrap();
            let fine = mesh.refined(&[2], 8.0).unwrap();
            let h: Vec<f64> = fine.element_lengths().iter().map(|h| 8.0 * h / mesh.element_lengths()[0]).collect();
            assert_eq!(h, [8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 4.0, 8.0]);
            assert!(mesh.nodes().iter().all(|x| fine.nodes().contains(x)));
            for (pair, h) in fine.nodes().windows(2).zip(fine.element_lengths()) {
                assert!((pair[1] - pair[0] - h).abs() < 1e-15 * length);
            }
            // Between two such nodes toward both, and no split for 1.
            let both = mesh.refined(&[1, 2], 4.0).unwrap();
            let h: Vec<f64> = both.element_lengths().iter().map(|h| 4.0 * h / mesh.element_lengths()[0]).collect();
            assert_eq!(h, [2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 4.0]);
            assert_eq!(mesh.refined(&[2], 1.0).unwrap(), mesh);
        }
        assert!(matches!(Mesh::uniform(1.0, 1).unwrap().refined(&[1], 0.0), Err(FemError::NotPositive { .. })));
        assert!(matches!(Mesh::uniform(1.0, 1).unwrap().refined(&[1], 1e30), Err(FemError::DegenerateMesh { .. })));
    }

    #[test]
    fn nodes_are_moved_or_put_where_they_are_wanted() {
        let mesh = Mesh::graded(2.0, 10, 5.0).unwrap();
        // Nothing changes where there are nodes, or for positions beyond the ends.
        let own = [mesh.nodes()[3], mesh.nodes()[7], -0.1, 0.0, 2.0, 2.5];
        assert_eq!(mesh.with_nodes_at(&own, 1e-4), mesh);
        let wanted = [0.31, 0.32, mesh.nodes()[4], 1.0, 1.9999, 1.97];
        let fitted = mesh.with_nodes_at(&wanted, 1e-4);
        let is_node = |x: f64| fitted.nodes().contains(&x);
        for x in [0.31, 0.32, mesh.nodes()[4], 1.0, 1.97] {
            assert!(is_node(x), "{x}: {:?}", fitted.nodes());
        }
        // Too near to the end.
        assert!(!is_node(1.9999));
        assert!(fitted.nodes().is_sorted() && fitted.length() == 2.0 && fitted.nodes()[0] == 0.0);
        assert!((10..=13).contains(&fitted.elements()));
        let shortest = fitted.element_lengths().iter().copied().fold(f64::INFINITY, f64::min);
        assert!(shortest > 0.9e-2, "{shortest}");
        for (pair, h) in fitted.nodes().windows(2).zip(fitted.element_lengths()) {
            assert_eq!(pair[1] - pair[0], *h);
        }
        assert_eq!(Mesh::of_nodes(fitted.nodes().to_vec()), Ok(fitted.clone()));
        let halves = fitted.halved();
        assert_eq!(halves.elements(), 2 * fitted.elements());
        assert!(fitted.nodes().iter().enumerate().all(|(i, x)| halves.nodes()[2 * i] == *x));
        assert!(matches!(Mesh::of_nodes(vec![0.0, 1.0, 1.0]), Err(FemError::Nodes { element: 1 })));
        assert!(matches!(Mesh::of_nodes(vec![0.1, 1.0]), Err(FemError::Nodes { element: 0 })));
    }

    #[test]
    fn impossible_meshes_are_refused() {
        assert!(matches!(Mesh::uniform(-1.0, 3), Err(FemError::NotPositive { what: "length", value: -1.0 })));
        assert!(matches!(Mesh::graded(1.0, 3, 0.0), Err(FemError::NotPositive { what: "mesh grading", .. })));
        assert_eq!(Mesh::uniform(1.0, 0), Err(FemError::NoElements));
        assert!(matches!(Mesh::graded(1.0, 3, 1e300), Err(FemError::DegenerateMesh { element: 1, .. })));
    }
}
