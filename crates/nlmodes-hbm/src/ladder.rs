/// Numbers of harmonics from which a refinement begins, in the order in which they are tried: the fewer, the less
/// interrupts a curve.
pub const FEW_HARMONICS: [usize; 4] = [1, 2, 3, 5];

/// Numbers of harmonics on the way from `first`, which is left out, to `last`: each half as many again as the one
/// before.
pub fn harmonics_on_the_way(first: usize, last: usize) -> Vec<usize> {
    let steps = std::iter::successors(Some(first), |h| Some(h + h.div_ceil(2))).skip(1);
    steps.take_while(|h| *h < last).chain((last > first).then_some(last)).collect()
}
