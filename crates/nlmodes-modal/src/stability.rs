use crate::Event;

/// Share of the imaginary part in a multiplier above which it is complex.
const COMPLEX: f64 = 1e-6;

/// Stability of a periodic motion by its Floquet multipliers `μ`: a disturbance is `μ` times as large after each
/// period.
///
/// Of a conservative system they come in pairs `μ`, `1/μ`, so that a motion is stable if and only if all lie on the
/// unit circle; the double multiplier +1, along the motion and toward its neighbour of another energy, does not count.
/// Of a damped one the disturbances of a stable motion die out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stability {
    /// Whether small disturbances stay small, or die out; none where the largest multiplier is as close to the unit
    /// circle as it is uncertain.
    pub stable: Option<bool>,
    /// The multiplier of largest magnitude: real and imaginary part, the latter not negative.
    pub largest_multiplier: [f64; 2],
    /// Estimated error of its magnitude; none of a conservative motion.
    pub error: Option<f64>,
}

impl Stability {
    /// Of a conservative motion.
    pub fn conservative(stable: bool, largest_multiplier: [f64; 2]) -> Self {
        Self { stable: Some(stable), largest_multiplier, error: None }
    }

    /// Of a damped motion whose largest multiplier has a magnitude of this uncertainty.
    pub fn damped([re, im]: [f64; 2], error: f64) -> Self {
        let beyond = re.hypot(im) - 1.0;
        let stable = (beyond.abs() > error).then_some(beyond < 0.0);
        Self { stable, largest_multiplier: [re, im.abs()], error: Some(error) }
    }

    /// Error of the largest multiplier over its distance from the unit circle, or over itself where that is less; zero
    /// for a conservative motion, whose multipliers have none.
    pub fn doubt(&self) -> f64 {
        let size = self.magnitude();
        self.error.map_or(0.0, |error| error / size.min((size - 1.0).abs()).max(f64::MIN_POSITIVE))
    }

    /// Magnitude of the largest multiplier, unless its error is as large: then it is no number to be shown.
    pub fn known_magnitude(&self) -> Option<f64> {
        let size = self.magnitude();
        self.error.is_none_or(|error| error < size).then_some(size)
    }

    /// Whether the motion is known to be unstable.
    pub fn is_unstable(&self) -> bool {
        self.stable == Some(false)
    }

    /// Magnitude of the largest multiplier.
    pub fn magnitude(&self) -> f64 {
        self.largest_multiplier[0].hypot(self.largest_multiplier[1])
    }

    /// Its angle in the complex plane, degrees from 0 to 180: a motion that lost its stability at 0 did so at a fold or
    /// a branch point, at 180 by a doubling of its period, and between by a collision of two pairs. None where all lie
    /// on the unit circle, so that none is the largest.
    pub fn angle_deg(&self) -> Option<f64> {
        let [re, im] = self.largest_multiplier;
        (self.error.is_some() || self.is_unstable()).then(|| im.abs().atan2(re).to_degrees())
    }

    /// What happens where the largest multiplier leaves the unit circle; none at +1, which is a fold or a branch point.
    pub fn loss(&self) -> Option<Event> {
        let [re, im] = self.largest_multiplier;
        if im.abs() > COMPLEX * self.magnitude() {
            Some(Event::NeimarkSacker)
        } else {
            (re <= 0.0).then_some(Event::PeriodDoubling)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multiplier_has_magnitude_angle_and_kind_of_loss_whatever_the_sign_of_its_imaginary_part() {
        for (multiplier, magnitude, angle, loss) in [
            ([1.5, 0.0], 1.5, 0.0, None),
            ([0.0, 2.0], 2.0, 90.0, Some(Event::NeimarkSacker)),
            ([-3.0, 0.0], 3.0, 180.0, Some(Event::PeriodDoubling)),
            ([1.0, -1.0], 2f64.sqrt(), 45.0, Some(Event::NeimarkSacker)),
        ] {
            for stability in [Stability::conservative(false, multiplier), Stability::damped(multiplier, 1e-3)] {
                assert!((stability.magnitude() - magnitude).abs() < 1e-15 && stability.is_unstable());
                let found = stability.angle_deg().unwrap();
                assert!((found - angle).abs() < 1e-13, "{multiplier:?}: {found}");
                assert_eq!(stability.loss(), loss);
            }
        }
        assert_eq!(Stability::conservative(true, [0.6, 0.8]).angle_deg(), None);
        let near = Stability::damped([0.9999, 0.0], 1e-3);
        assert_eq!((near.stable, near.angle_deg()), (None, Some(0.0)));
    }

    #[test]
    fn a_multiplier_is_certain_far_from_the_unit_circle_and_shown_unless_its_error_is_as_large() {
        let certain = |size, error| Stability::damped([0.0, size], error).doubt() <= 0.25;
        assert!(certain(1.5, 0.1) && !certain(1.3, 0.1) && certain(0.5, 0.12) && !certain(0.5, 0.13));
        // Far inside, the multiplier itself is the measure.
        assert!(certain(0.1, 0.025) && !certain(0.1, 0.03));
        assert_eq!(Stability::conservative(true, [1.0, 0.0]).doubt(), 0.0);
        assert_eq!(Stability::damped([-678.0, 0.0], 677.0).known_magnitude(), Some(678.0));
        assert_eq!(Stability::damped([-678.0, 0.0], 678.0).known_magnitude(), None);
        assert_eq!(Stability::conservative(false, [2.0, 0.0]).known_magnitude(), Some(2.0));
    }
}
