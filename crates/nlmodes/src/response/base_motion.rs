use nlmodes_linalg::multiply;
use nlmodes_model::{DofKind, StructuralModel};

/// What the level of a base motion multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseUnit {
    /// Amplitude of the acceleration, 1 m/s².
    Acceleration,
    /// Amplitude of the displacement, 1 m.
    Displacement,
}

/// A base whose displacement is a `cos Ωt` in one direction, and its acceleration a `−cos Ωt`, whichever of them has
/// the level as its amplitude: a motion lags both alike.
///
/// ```text
/// M q̈ + C q̇ + K q = W λ − (M_LL r_L + M_LB r_B) ü        q relative to the base
/// ```
///
/// The mass between supported nodes and free ones, `M_LB`, counts: without it a rod of two elements is 20 % off.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseMotion {
    /// `M_LL r_L + M_LB r_B`, n, kg.
    pub inertia: Vec<f64>,
    /// `r_L`, the motion of the structure with its base by one unit, n.
    pub rigid: Vec<f64>,
    /// What the level multiplies.
    pub unit: BaseUnit,
    /// Whether the stops are fixed in space; otherwise they move with the base.
    pub stop_is_fixed: bool,
}

impl BaseMotion {
    /// For `supported`, where `free` is the same structure without supports: the rows removed by supports contain
    /// `M_LB`. Degrees of freedom of the kind `direction` move with the base; those in `massless` are massless.
    ///
    /// Returns `None` where a degree of freedom of `supported` is not one of `free`.
    pub fn of_supports(
        supported: &StructuralModel,
        free: &StructuralModel,
        direction: DofKind,
        massless: &[usize],
        unit: BaseUnit,
        stop_is_fixed: bool,
    ) -> Option<Self> {
        let place = |i: usize| {
            let dof = supported.dofs()[i];
            free.dofs().iter().position(|d| d.node == dof.node && d.kind == dof.kind)
        };
        let places: Vec<usize> = (0..supported.dofs().len()).map(place).collect::<Option<_>>()?;
        let lost: Vec<usize> = massless.iter().filter_map(|&i| places.get(i).copied()).collect();
        let moves = |i: usize| f64::from(u8::from(free.dofs()[i].kind == direction && !lost.contains(&i)));
        let rigid: Vec<f64> = (0..free.dofs().len()).map(moves).collect();
        let mut inertia = multiply(free.mass(), &rigid);
        lost.iter().for_each(|&i| inertia[i] = 0.0);
        let with_base = |i: &usize| f64::from(u8::from(free.dofs()[*i].kind == direction));
        Some(Self {
            inertia: places.iter().map(|&i| inertia[i]).collect(),
            rigid: places.iter().map(with_base).collect(),
            unit,
            stop_is_fixed,
        })
    }
}
