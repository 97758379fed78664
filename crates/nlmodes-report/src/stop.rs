use nlmodes_modal::ModalBranch;

/// A stop for figures and pages; stops are numbered from 0, in the order of the structure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopLine {
    /// Index of the coordinate that it limits, among those of the first branch.
    pub coordinate: usize,
    /// Its signed position along that coordinate, m.
    pub position: f64,
    /// Whether it is on the positive side.
    pub positive: bool,
}

impl StopLine {
    /// The first stop of a branch, the only one stored in the branch itself.
    pub(crate) fn first_of(branch: &ModalBranch) -> Option<Self> {
        let (coordinate, position) = branch.contact_coordinate.zip(branch.stop)?;
        Some(Self { coordinate, position, positive: position >= 0.0 })
    }
}
