//! Motion that is not in phase: more than one mode takes part in the fundamental.

use nlmodes_modal::HarmonicCoefficients;
use num_complex::Complex64;

use crate::extraction::Finding;
use crate::extraction::layout::Place;

/// Share of the fundamental in quadrature to the phase `anchor` (rad), by mass where modal coordinates are known.
/// Without an anchor it is the phase for which the share is smallest.
pub fn share(fundamental: &[Complex64], anchor: Option<f64>) -> f64 {
    let anchor = anchor.unwrap_or_else(|| best_phase(fundamental));
    let total: f64 = fundamental.iter().map(Complex64::norm_sqr).sum();
    let out: f64 = fundamental.iter().map(|q| (q * Complex64::cis(-anchor)).im.powi(2)).sum();
    (out / total).sqrt()
}

/// Phase along which most of the motion is.
fn best_phase(fundamental: &[Complex64]) -> f64 {
    0.5 * fundamental.iter().map(|q| q * q).sum::<Complex64>().arg()
}

/// Reports a share beyond the tolerance with the place that has most of it. `modal` are the modal coordinates of the
/// fundamental, if known.
pub fn report(
    motion: &HarmonicCoefficients,
    modal: Option<&[Complex64]>,
    anchor: Option<f64>,
    tolerance: f64,
    name: impl Fn(&Place) -> String,
    places: &[Place],
    findings: &mut Vec<Finding>,
) {
    let fundamental: Vec<Complex64> = (0..motion.n_coordinates()).map(|d| motion.of(d)[1]).collect();
    let share = share(modal.unwrap_or(&fundamental), anchor);
    let anchor = anchor.unwrap_or_else(|| best_phase(&fundamental));
    let out = |q: &Complex64| (q * Complex64::cis(-anchor)).im.abs();
    let worst = fundamental.iter().zip(places).max_by(|a, b| out(a.0).total_cmp(&out(b.0)));
    if let Some((q, place)) = worst.filter(|_| share > tolerance) {
        // A mode shape has both signs: half a turn is no phase.
        let turned = (q * Complex64::cis(-anchor)).arg();
        let degrees = (turned - std::f64::consts::PI * (turned / std::f64::consts::PI).round()).to_degrees();
        findings.push(Finding::Quadrature { channel: name(place), degrees, share });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_zero_in_phase_and_does_not_depend_on_the_time_origin() {
        for turn in [0.0, 0.7, -2.5] {
            let q: Vec<Complex64> = [1.0, -0.4, 2.0].iter().map(|x| Complex64::from_polar(*x, turn)).collect();
            assert!(share(&q, None) < 1e-12 && share(&q, Some(turn)) < 1e-12);
            let two = [Complex64::cis(turn), Complex64::cis(turn + 0.2)];
            // Half the angle on either side of the best phase; all of it on one side of the first.
            assert!((share(&two, None) - 0.1f64.sin()).abs() < 1e-12);
            assert!((share(&two, Some(turn)) - 0.2f64.sin() / 2f64.sqrt()).abs() < 1e-12);
        }
    }

    /// The angle at the position with the largest motion out of phase, modulo half a turn.
    #[test]
    fn the_angle_out_of_phase_is_that_from_the_nearer_sense_of_the_shape() {
        for (angle, expected) in
            [(20.0, 20.0), (80.0, 80.0), (100.0, -80.0), (170.0, -10.0), (-100.0, 80.0), (-170.0, 10.0)]
        {
            for anchor in [0.0, 2.0] {
                let mut motion = HarmonicCoefficients::zeros(2, 1);
                motion.of_mut(0)[1] = Complex64::from_polar(1.0, anchor);
                motion.of_mut(1)[1] = Complex64::from_polar(2.0, anchor + f64::to_radians(angle));
                let places = [0, 1].map(|i| Place { position: Some(f64::from(i)), members: vec![] });
                let name = |place: &Place| format!("{:?}", place.position);
                let mut findings = vec![];
                report(&motion, None, Some(anchor), 0.1, name, &places, &mut findings);
                let [Finding::Quadrature { channel, degrees, share }] = &findings[..] else { panic!("{findings:?}") };
                assert!((degrees - expected).abs() < 1e-9 && channel == "Some(1.0)", "{angle}: {degrees} {channel}");
                assert!((share - 2.0 * f64::to_radians(angle).sin().abs() / 5f64.sqrt()).abs() < 1e-12);
                report(&motion, None, Some(anchor), 1.0, name, &places, &mut findings);
                assert_eq!(findings.len(), 1, "within the tolerance nothing is said");
            }
        }
    }
}
