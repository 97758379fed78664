//! Functions of real and complex numbers that `core` lacks: those of `libm`, with the same bits on every machine.

use core::f64::consts::TAU;

use num_complex::Complex64;

/// Cosine and sine, `e^{iθ}`.
pub(crate) fn cis(theta: f64) -> Complex64 {
    let (sin, cos) = libm::sincos(theta);
    Complex64::new(cos, sin)
}

/// `|z|`, without overflow on the way.
pub(crate) fn norm(z: Complex64) -> f64 {
    libm::hypot(z.re, z.im)
}

/// Angle of `z` in (−π, π].
pub(crate) fn arg(z: Complex64) -> f64 {
    libm::atan2(z.im, z.re)
}

/// `angle` in [0, 2π).
pub(crate) fn rem_tau(angle: f64) -> f64 {
    let rest = libm::fmod(angle, TAU);
    if rest < 0.0 { rest + TAU } else { rest }
}

/// `value` between `low` and `high`; unlike `f64::clamp` it has no case in which it panics.
pub(crate) fn between(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high)
}

/// The larger one; not a number if one of them is not.
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}
