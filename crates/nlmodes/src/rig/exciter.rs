use crate::rig::error::{not_negative, positive};
use crate::rig::{DrivePoint, RigError};

/// The exciter, which converts the drive to a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exciter {
    /// The drive is the force itself, N.
    IdealForce,
    /// The drive is the voltage at the coil of a shaker, V.
    Shaker(Shaker),
}

/// An electrodynamic shaker driven by voltage, with a stinger between armature and structure.
///
/// ```text
/// L di/dt + R i + T v_a = u
/// m_a dv_a/dt + c_a v_a + k_a x_a = T i − f
/// f = k_s (x_a − w) + c_s (v_a − ẇ)
/// ```
///
/// `f` is what a force sensor between stinger and structure measures. A residual flexibility of the drive point is in
/// series with the spring of the stinger; the damper is parallel to both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shaker {
    /// Resistance of the coil `R`, Ω.
    pub resistance: f64,
    /// Inductance of the coil `L`, H.
    pub inductance: f64,
    /// Force constant `T`, N/A, which is also that of the induced voltage, V·s/m.
    pub force_constant: f64,
    /// Mass of armature and table `m_a`, kg.
    pub armature_mass: f64,
    /// Stiffness of the suspension `k_a`, N/m.
    pub suspension_stiffness: f64,
    /// Damping of the suspension `c_a`, N·s/m.
    pub suspension_damping: f64,
    /// Axial stiffness of the stinger `k_s`, N/m.
    pub stinger_stiffness: f64,
    /// Damping of the stinger `c_s`, N·s/m.
    pub stinger_damping: f64,
}

impl Default for Shaker {
    /// A small shaker of the 50 N class: 2 Ω, 0.15 mH, 9.8 N/A, 60 g on 12 kN/m; and a thin steel stinger of 1 mm by
    /// 150 mm (EA/l = 1.0e6 N/m). On a nearly immobile structure it supplies some 4.7 N/V at low frequency.
    ///
    /// The paper names no shaker; these are typical data of such machines, not those of its experiment.
    fn default() -> Self {
        Self {
            resistance: 2.0,
            inductance: 1.5e-4,
            force_constant: 9.8,
            armature_mass: 0.06,
            suspension_stiffness: 12e3,
            suspension_damping: 5.0,
            stinger_stiffness: 1e6,
            stinger_damping: 20.0,
        }
    }
}

impl Shaker {
    /// Spring of the stinger in series with the residual flexibility of the drive point, N/m.
    pub(crate) fn stinger_at(&self, at: &DrivePoint) -> f64 {
        1.0 / (1.0 / self.stinger_stiffness + at.residual)
    }
}

impl Exciter {
    /// Its name for messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::IdealForce => "ideal force",
            Self::Shaker(_) => "shaker",
        }
    }

    /// Unit of the drive.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::IdealForce => "N",
            Self::Shaker(_) => "V",
        }
    }

    /// Number of its states.
    pub(crate) fn states(&self) -> usize {
        match self {
            Self::IdealForce => 0,
            Self::Shaker(_) => 3,
        }
    }

    pub(crate) fn check(&self) -> Result<(), RigError> {
        let Self::Shaker(shaker) = self else { return Ok(()) };
        positive("resistance of the coil (Ω)", shaker.resistance)?;
        positive("inductance of the coil (H)", shaker.inductance)?;
        positive("force constant (N/A)", shaker.force_constant)?;
        positive("mass of the armature (kg)", shaker.armature_mass)?;
        positive("stiffness of the stinger (N/m)", shaker.stinger_stiffness)?;
        not_negative("stiffness of the suspension (N/m)", shaker.suspension_stiffness)?;
        not_negative("damping of the suspension (N·s/m)", shaker.suspension_damping)?;
        not_negative("damping of the stinger (N·s/m)", shaker.stinger_damping).map(drop)
    }
}
