use crate::{kernel, sample::Sample};

/// Projected Gauss-Seidel from zero forces: `λ_i ← max(0, λ_i − g_i / A_ii)`, one contact after the other, at most
/// `sweeps` times over all; ends when a sweep neither opens nor closes a contact. The gaps follow along.
pub(super) fn run(sample: &mut Sample, sweeps: usize) {
    let matrix = sample.matrix().clone();
    let (lambda, gap) = (&mut sample.lambda, &mut sample.gap);
    lambda.fill(0.0);
    gap.copy_from_slice(&sample.b);
    for _ in 0..sweeps {
        let mut exchanges = 0;
        for i in 0..lambda.len() {
            let old = lambda[i];
            let compliance = matrix.diagonal(i);
            if compliance == 0.0 {
                continue;
            }
            let moved = old - gap[i] / compliance;
            let new = if moved > 0.0 { moved } else { 0.0 };
            if new != old {
                exchanges += usize::from((new > 0.0) != (old > 0.0));
                lambda[i] = new;
                kernel::axpy(new - old, matrix.column(i), gap);
            }
        }
        if exchanges == 0 {
            break;
        }
    }
}
