//! The lines of `*BOUNDARY`: displacements that a deck holds.

use super::Deck;
use crate::keyword;
use crate::mesh::source::Source;
use crate::text::{commas, unsigned};

/// Abaqus' names of supports, and the displacements that they hold.
const NAMED: [(&str, [bool; 3]); 8] = [
    ("ENCASTRE", [true; 3]),
    ("PINNED", [true; 3]),
    ("XSYMM", [true, false, false]),
    ("YSYMM", [false, true, false]),
    ("ZSYMM", [false, false, true]),
    ("XASYMM", [false, true, true]),
    ("YASYMM", [true, false, true]),
    ("ZASYMM", [true, true, false]),
];

impl Deck {
    /// `node or set, first, last`, or `node or set, PINNED`. Any other line fixes nothing known here: the matrices
    /// determine what moves.
    pub(super) fn support(&mut self, source: &Source) {
        let fields: Vec<&[u8]> = commas(source.line()).collect();
        let (Some(what), Some(first)) = (fields.first(), fields.get(1)) else { return };
        let held = match unsigned(first) {
            Some(first) => {
                let last = fields.get(2).and_then(|field| unsigned(field)).unwrap_or(first);
                [1, 2, 3].map(|direction| (first..=last).contains(&direction))
            }
            None => {
                let name = keyword::name(first);
                NAMED.iter().find(|(known, _)| *known == name).map_or([false; 3], |(_, held)| *held)
            }
        };
        let nodes = match unsigned(what) {
            Some(node) => vec![node],
            None => self.mesh.node_set(&keyword::name(what)).map(<[u64]>::to_vec).unwrap_or_default(),
        };
        let supports = self.mesh.supports.get_or_insert_default();
        for node in nodes {
            supports.entry(node).or_default().iter_mut().zip(held).for_each(|(own, held)| *own |= held);
        }
    }
}
