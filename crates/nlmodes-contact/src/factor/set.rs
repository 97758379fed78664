/// Eight flags in eight bits, the first one lowest: the product adds the flags, each shifted to its bit in the top
/// byte.
fn eight_bits(flags: &[bool; 8]) -> u64 {
    u64::from_le_bytes(flags.map(u8::from)).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

/// A set of contacts, one bit each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct ClosedSet {
    words: Vec<u64>,
}

impl ClosedSet {
    pub(crate) fn new(c: usize) -> Self {
        Self { words: vec![0; c.div_ceil(64)] }
    }

    pub(crate) fn load(&mut self, closed: &[bool]) {
        for (word, flags) in self.words.iter_mut().zip(closed.chunks(64)) {
            let (eights, rest) = flags.as_chunks::<8>();
            let last = rest.iter().rev().fold(0, |w, flag| w << 1 | u64::from(*flag));
            *word = eights.iter().rev().fold(last, |w, flags| w << 8 | eight_bits(flags));
        }
    }

    pub(crate) fn load_with(&mut self, c: usize, is_closed: impl Fn(usize) -> bool) {
        self.words.fill(0);
        (0..c).filter(|&i| is_closed(i)).for_each(|i| self.toggle(i));
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.words.clone_from(&other.words);
    }

    pub(super) fn clear(&mut self) {
        self.words.fill(0);
    }

    pub(crate) fn contains(&self, contact: usize) -> bool {
        self.words[contact / 64] >> (contact % 64) & 1 == 1
    }

    pub(crate) fn toggle(&mut self, contact: usize) {
        self.words[contact / 64] ^= 1 << (contact % 64);
    }

    pub(crate) fn count(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    pub(super) fn distance(&self, other: &Self) -> usize {
        self.words.iter().zip(&other.words).map(|(a, b)| (a ^ b).count_ones() as usize).sum()
    }

    /// Calls `visit` with every contact in ascending order.
    pub(crate) fn for_each(&self, mut visit: impl FnMut(usize)) {
        for (w, &word) in self.words.iter().enumerate() {
            let mut bits = word;
            while bits != 0 {
                visit(w * 64 + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_the_flags_that_it_was_loaded_with() {
        for c in 0..150 {
            let flags: Vec<bool> = (0..c).map(|i| (i * i + c) % 7 < 3).collect();
            let mut set = ClosedSet::new(c);
            set.load(&flags);
            let mut back = vec![false; c];
            set.for_each(|i| back[i] = true);
            assert_eq!(back, flags);
            assert!((0..c).all(|i| set.contains(i) == flags[i]));
            assert_eq!(set.count(), flags.iter().filter(|f| **f).count());
        }
    }
}
