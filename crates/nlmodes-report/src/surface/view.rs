/// Half edges of the box.
const HALF: [f64; 3] = [1.0, 0.95, 0.62];
/// Direction of the viewer: front right, above.
const AZIMUTH: f64 = -0.92;
const ELEVATION: f64 = 0.42;

/// Parallel projection of a box with edges along `x`, `y` (backwards) and `z` (up) onto the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    ends: [(f64, f64); 3],
    origin: (f64, f64),
    scale: f64,
}

impl View {
    /// Fits the box, which spans `ends` along each axis, into a rectangle of the picture.
    pub fn new(ends: [(f64, f64); 3], corner: (f64, f64), size: (f64, f64)) -> Self {
        let unit = Self { ends, origin: (0.0, 0.0), scale: 1.0 };
        let corners =
            (0..8).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { ends[axis].0 } else { ends[axis].1 }));
        let places: Vec<(f64, f64)> = corners.map(|corner| unit.place(corner)).collect();
        let half = |values: fn(&(f64, f64)) -> f64| places.iter().map(values).fold(0.0, |m: f64, v| m.max(v.abs()));
        let (half_width, half_height) = (half(|place| place.0), half(|place| place.1));
        let scale = (0.5 * size.0 / half_width).min(0.5 * size.1 / half_height);
        Self { ends, origin: (corner.0 + 0.5 * size.0, corner.1 + 0.5 * size.1), scale }
    }

    /// Pixel of a point.
    pub fn place(&self, point: [f64; 3]) -> (f64, f64) {
        let [x, y, z] = self.centred(point);
        let ((sin_a, cos_a), (sin_e, cos_e)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
        let right = -sin_a * x + cos_a * y;
        let up = -sin_e * (cos_a * x + sin_a * y) + cos_e * z;
        (self.origin.0 + self.scale * right, self.origin.1 - self.scale * up)
    }

    /// Nearness of a point to the viewer.
    pub fn nearness(&self, point: [f64; 3]) -> f64 {
        let [x, y, z] = self.centred(point);
        let ((sin_a, cos_a), (sin_e, cos_e)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
        cos_e * (cos_a * x + sin_a * y) + sin_e * z
    }

    fn centred(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let (low, high) = self.ends[axis];
            HALF[axis] * (2.0 * (point[axis] - low) / (high - low) - 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_stays_within_its_rectangle_and_touches_two_sides() {
        let ends = [(0.0, 20.0), (0.0, 16.0), (-0.5, 0.5)];
        let view = View::new(ends, (80.0, 40.0), (560.0, 400.0));
        let corners = (0..8).map(|k| [0, 1, 2].map(|a| if k >> a & 1 == 0 { ends[a].0 } else { ends[a].1 }));
        let places: Vec<(f64, f64)> = corners.map(|corner| view.place(corner)).collect();
        let left = places.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
        let top = places.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        assert!(left > 79.999 && top > 39.999 && (left < 80.001 || top < 40.001), "{left} {top}");
    }

    #[test]
    fn front_right_and_top_are_near() {
        let view = View::new([(0.0, 1.0); 3], (0.0, 0.0), (1.0, 1.0));
        let middle = view.nearness([0.5; 3]);
        for near in [[1.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 1.0]] {
            assert!(view.nearness(near) > middle, "{near:?}");
        }
    }
}
