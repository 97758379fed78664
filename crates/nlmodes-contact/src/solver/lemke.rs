mod tableau;

use super::{
    closed_form::OneContact,
    polish::Polish,
    workspace::{Method, Outcome, Workspace},
};
use crate::{LcpError, LcpMatrix, LcpSolver, LcpWorkspace, sample::Sample};
use tableau::{End, Tableau};

pub(crate) const NAME: &str = "lemke";

/// Lemke's complementary pivoting with the lexicographic rule: finite, without cycling, on a dense tableau.
///
/// The reference for small problems: `O(c²)` per pivot, usually about as many pivots as closed contacts. There are
/// problems with exponentially many; they end with [`LcpError::NotConverged`] after `pivots_per_contact · c + 1000`. A
/// guess is not used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lemke {
    /// Maximum number of pivots per contact, beyond the first thousand. Default 50.
    pub pivots_per_contact: usize,
}

impl Default for Lemke {
    fn default() -> Self {
        Self { pivots_per_contact: 50 }
    }
}

impl LcpSolver for Lemke {
    fn name(&self) -> &'static str {
        NAME
    }

    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError> {
        let c = a.n_contacts();
        if c == 0 {
            return Ok(Box::new(Workspace::new(a, OneContact)));
        }
        let (tableau, polish) = (Tableau::new(c), Polish::new(c));
        Ok(Box::new(Workspace::new(a, Pivoting { limit: self.pivots_per_contact * c + 1000, tableau, polish })))
    }
}

struct Pivoting {
    limit: usize,
    tableau: Tableau,
    polish: Polish,
}

impl Method for Pivoting {
    const NAME: &'static str = NAME;

    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        self.tableau.load(sample.matrix(), &sample.b);
        let (end, iterations) = self.tableau.pivot(self.limit);
        self.tableau.unload(&mut sample.lambda);
        closed.iter_mut().zip(&sample.lambda).for_each(|(closed, l)| *closed = *l > 0.0);
        match end {
            End::Solved => Outcome { iterations, ..self.polish.run(sample, closed) },
            End::Limit => Outcome { iterations, verdict: sample.judge(), infeasible: false },
            End::Ray { entering } => {
                self.tableau.unload_ray(entering, &mut sample.ray);
                if sample.is_proven_infeasible() {
                    return Outcome { iterations, verdict: sample.judge(), infeasible: true };
                }
                // A ray due to rounding only, as for opposing stops without clearance: the forces reached may be the
                // solution.
                Outcome { iterations, ..self.polish.run(sample, closed) }
            }
        }
    }
}
