use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{ContactMotion, HbmError, PeriodicMotion, PeriodicSettings, PeriodicSystem};
use nlmodes_linalg::{DenseLu, max_norm};
use nlmodes_model::reduction::RestState;

use crate::response::analyses::scales;
use crate::response::{ResponseError, ResponseModel, ResponseSettings};

/// The response at a level so small that it is linear, in the harmonics of the load.
pub(crate) struct SmallMotion {
    pub system: PeriodicSystem,
    /// Unknowns at rest, and what the level one adds to them.
    pub rest: Vec<f64>,
    pub x: Vec<f64>,
    pub level: f64,
}

impl SmallMotion {
    /// At this base frequency, rad/s.
    pub fn new(
        model: &ResponseModel,
        base: f64,
        settings: &ResponseSettings,
        solver: &dyn LcpSolver,
    ) -> Result<Self, ResponseError> {
        let (structure, load) = (model.structure(), model.load(settings)?);
        let few = PeriodicSettings { harmonics: load.highest_harmonic(), ..settings.periodic() };
        let own = scales(structure, base);
        let mut system = PeriodicSystem::force_response(structure, load, base, 1.0, few, own, solver)?;
        let pressed = model.pressed_rest()?;
        let rest = unknowns_at_rest(&system, pressed.as_ref());
        let x = linear_motion(&mut system, &rest)?;
        let level = small_level(&mut system, (&rest, &x), pressed.as_ref().map(|rest| rest.closed.as_slice()))?;
        Ok(Self { system, rest, x, level })
    }

    /// The motion.
    pub fn motion(&mut self) -> Result<PeriodicMotion, ResponseError> {
        Ok(self.system.motion(&beside(&self.rest, &self.x, self.level), self.level)?)
    }
}

/// Unknowns of a response at the level zero, of a structure that its stops press or, without `rest`, of one with open
/// contacts.
pub(crate) fn unknowns_at_rest(system: &PeriodicSystem, rest: Option<&RestState>) -> Vec<f64> {
    let mut x = rest.map_or_else(Vec::new, |rest| system.coefficients_at_rest(&rest.eta, &rest.forces));
    x.resize(system.dim(), 0.0);
    x
}

/// The linear motion per unit of the parameter of a response over the level, from these unknowns at rest: they are
/// linear in the level until a contact changes its state.
fn linear_motion(system: &mut PeriodicSystem, rest: &[f64]) -> Result<Vec<f64>, ResponseError> {
    let n = system.dim();
    let mut at = Linearization::new(n);
    system.linearize(rest, 0.0, &mut at)?;
    let square = at.jacobian.subcols(0, n).to_owned();
    let lu = DenseLu::factor(&square)
        .map_err(|source| HbmError::Linalg { what: "the linear response (an undamped resonance?)", source })?;
    let mut x: Vec<f64> = at.jacobian.col(n).iter().map(|v| -v).collect();
    lu.solve_in_place(&mut x);
    Ok(x)
}

/// Share of the level that first touches at which the linear motion is evaluated.
pub(crate) const SAFE: f64 = 0.25;

/// The unknowns at rest with so many times those of the level one.
pub(crate) fn beside(rest: &[f64], x: &[f64], level: f64) -> Vec<f64> {
    rest.iter().zip(x).map(|(rest, x)| rest + level * x).collect()
}

/// A level at which no contact changes its state: a quarter of that at which the first one does. Of a structure that
/// rests with its contacts open that level follows from the largest motion toward a stop; of one that its stops press,
/// with these contacts `closed`, it is searched.
fn small_level(
    system: &mut PeriodicSystem,
    (rest, x): (&[f64], &[f64]),
    closed: Option<&[bool]>,
) -> Result<f64, ResponseError> {
    if let Some(closed) = closed {
        return searched_level(system, (rest, x), closed);
    }
    let mut level = 1.0;
    for _ in 0..200 {
        let motion = system.motion(&beside(rest, x, level), level)?;
        let gaps = system.structure().gaps();
        let share = |(c, gap): (&ContactMotion, &f64)| if c.touches > 0 { 2.0 } else { c.peak / gap };
        let of_contacts = motion.contacts.iter().zip(gaps).map(share).fold(0.0_f64, f64::max);
        let used = of_contacts.max(bent(system, x, level));
        if used > 1.0 {
            level *= 0.25;
        } else if used > 0.0 {
            return Ok(SAFE * level / used);
        } else {
            level *= 4.0;
        }
    }
    Ok(level)
}

/// Largest displacement of a law in the linear motion, over that at which laws matter.
fn bent(system: &PeriodicSystem, x: &[f64], level: f64) -> f64 {
    if system.structure().laws().is_empty() {
        return 0.0;
    }
    // Displacements are in units of that length, see `scales`.
    level * max_norm(x.iter().copied())
}

/// Halvings by which the level is found at which a contact changes its state.
const HALVINGS: usize = 30;

fn searched_level(
    system: &mut PeriodicSystem,
    (rest, x): (&[f64], &[f64]),
    closed: &[bool],
) -> Result<f64, ResponseError> {
    let mut keeps = |level: f64| -> Result<bool, ResponseError> {
        let motion = system.motion(&beside(rest, x, level), level)?;
        let is_kept = |(of, closed): (&ContactMotion, &bool)| match closed {
            true => of.closed_share >= 1.0,
            false => of.closed_share <= 0.0,
        };
        Ok(motion.contacts.iter().zip(closed).all(is_kept))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        match keeps(high)? {
            true => (low, high) = (high, 4.0 * high),
            false if low == 0.0 && !keeps(0.25 * high)? => high *= 0.25,
            false => break,
        }
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if keeps(middle)? { low = middle } else { high = middle }
    }
    Ok(SAFE * low)
}
