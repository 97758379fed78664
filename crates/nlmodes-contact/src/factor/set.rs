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
            *word = flags.iter().rev().fold(0, |w, flag| w << 1 | u64::from(*flag));
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
