use crate::{kernel, sample::Sample};

/// Contacts whose changes are applied to the gaps of all others together.
const GROUP: usize = 4;

/// Projected Gauss-Seidel from zero forces: `λ_i ← max(0, λ_i − g_i / A_ii)`, one contact after the other, at most
/// `sweeps` times over all; it ends when a sweep neither opens nor closes a contact. The gaps are updated.
pub(super) fn run(sample: &mut Sample, sweeps: usize) {
    let matrix = sample.matrix().clone();
    let (lambda, gap) = (&mut sample.lambda, &mut sample.gap);
    lambda.fill(0.0);
    gap.copy_from_slice(&sample.b);
    for _ in 0..sweeps {
        let mut exchanges = 0;
        for (group, lambda) in lambda.chunks_mut(GROUP).enumerate() {
            let first = GROUP * group;
            let mut moved = [0.0; GROUP];
            for (k, force) in lambda.iter_mut().enumerate() {
                let compliance = matrix.diagonal(first + k);
                if compliance == 0.0 {
                    continue;
                }
                // The effect of the previous ones in the group.
                let of_group = (0..k).map(|l| moved[l] * matrix.column(first + l)[first + k]).sum::<f64>();
                let next = *force - (gap[first + k] + of_group) / compliance;
                let next = if next > 0.0 { next } else { 0.0 };
                exchanges += usize::from((next > 0.0) != (*force > 0.0));
                moved[k] = next - *force;
                *force = next;
            }
            kernel::add_columns(&moved[..lambda.len()], |l| matrix.column(first + l), gap);
        }
        if exchanges == 0 {
            break;
        }
    }
}
