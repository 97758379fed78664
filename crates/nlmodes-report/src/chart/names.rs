//! Where the names of symbols stand: on nothing else, as far as there is room.

use super::inset::Rectangle;
use crate::svg::{Anchor, Stroke, Svg, text_width};

const FONT: f64 = 13.0;
/// Half the width of a symbol with a rim, pixels.
const SYMBOL: f64 = 7.0;
/// Distance between the places of a curve at which it is looked for, pixels.
const STEP: f64 = 4.0;
const LEADER: Stroke = Stroke::solid("#666666", 0.7);

/// What is in the picture already.
#[derive(Debug, Default)]
pub(super) struct Taken {
    places: Vec<(f64, f64)>,
    symbols: Vec<(f64, f64)>,
    boxes: Vec<Rectangle>,
}

/// Where a name stands: its rectangle, and from where on it is so far away that a line leads to it.
struct Place {
    rectangle: Rectangle,
    is_far: bool,
}

impl Taken {
    /// A curve through these pixels.
    pub fn curve(&mut self, pixels: &[(f64, f64)]) {
        for pair in pixels.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let n = ((b.0 - a.0).hypot(b.1 - a.1) / STEP).ceil().clamp(1.0, 1000.0);
            self.places.extend((0..n as usize).map(|k| {
                let share = k as f64 / n;
                (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
            }));
        }
        self.places.extend(pixels.last());
    }

    /// A symbol at this pixel.
    pub fn symbol(&mut self, at: (f64, f64)) {
        self.symbols.push(at);
    }

    /// A rectangle, such as that of an inset.
    pub fn rectangle(&mut self, rectangle: Rectangle) {
        self.boxes.push(rectangle);
    }

    pub fn places(&self) -> &[(f64, f64)] {
        &self.places
    }

    /// Writes a name beside the symbol at `at`, within `frame`, where it covers least; one that `may_go` is left out where it would cover a
    /// symbol or another name.
    pub fn name(&mut self, svg: &mut Svg, frame: Rectangle, at: (f64, f64), name: &str, may_go: bool) {
        let size = (text_width(name, FONT) * 0.92, FONT);
        let candidates = candidates(at, size);
        let Some((cost, place)) =
            candidates.map(|place| (self.cost(&place, frame), place)).min_by(|a, b| a.0.total_cmp(&b.0))
        else {
            return;
        };
        if may_go && cost >= HIDES {
            return;
        }
        let (x, y, w, h) = place.rectangle;
        if place.is_far {
            let near = (at.0.clamp(x, x + w), at.1.clamp(y, y + h));
            svg.line(at, near, &LEADER);
        }
        svg.haloed_text((x + 0.5 * w, y + 0.82 * h), Anchor::Middle, FONT, name);
        self.boxes.push(place.rectangle);
    }

    fn cost(&self, place: &Place, frame: Rectangle) -> f64 {
        let (x, y, w, h) = place.rectangle;
        let holds = |margin: f64, (a, b): &(f64, f64)| {
            (x - margin..=x + w + margin).contains(a) && (y - margin..=y + h + margin).contains(b)
        };
        let curves = self.places.iter().filter(|at| holds(1.5, at)).count();
        let symbols = self.symbols.iter().filter(|at| holds(SYMBOL, at)).count();
        let crosses = |(a, b, c, d): &Rectangle| x < a + c && *a < x + w && y < b + d && *b < y + h;
        let boxes = self.boxes.iter().filter(|other| crosses(other)).count();
        let (left, top, width, height) = frame;
        let outside = x < left + 2.0 || y < top + 2.0 || x + w > left + width - 2.0 || y + h > top + height - 2.0;
        let far = if place.is_far { 3.0 } else { 0.0 };
        curves as f64 + far + HIDES * (symbols + 2 * boxes) as f64 + if outside { 20.0 * HIDES } else { 0.0 }
    }
}

/// What a place costs that hides a symbol, in curves hidden at one place.
const HIDES: f64 = 100.0;

/// Places around a symbol, the preferred ones first.
fn candidates(at: (f64, f64), (w, h): (f64, f64)) -> impl Iterator<Item = Place> {
    let sides = [(1.0, 0.6), (1.0, -0.6), (-1.0, -0.6), (-1.0, 0.6), (0.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)];
    [8.0, 18.0, 32.0, 50.0].into_iter().enumerate().flat_map(move |(ring, distance)| {
        sides.map(|(side, up): (f64, f64)| {
            let middle = (at.0 + side * (distance + 0.5 * w), at.1 + up * (distance + 0.5 * h));
            Place { rectangle: (middle.0 - 0.5 * w, middle.1 - 0.5 * h, w, h), is_far: ring > 1 }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Rectangle = (0.0, 0.0, 400.0, 300.0);

    #[test]
    fn names_stand_on_no_curve_no_symbol_and_no_other_name() {
        // Symbols on a line that falls, one each 24 pixels, and a second line right of it.
        let mut taken = Taken::default();
        let line: Vec<(f64, f64)> = (0..12).map(|k| (40.0 + 24.0 * f64::from(k), 20.0 + 22.0 * f64::from(k))).collect();
        taken.curve(&line);
        line.iter().for_each(|at| taken.symbol(*at));
        let mut svg = Svg::new(400.0, 300.0);
        for at in line.iter().step_by(3) {
            taken.name(&mut svg, FRAME, *at, "3:mode 2", false);
        }
        assert_eq!(taken.boxes.len(), 4);
        for (k, (x, y, w, h)) in taken.boxes.iter().enumerate() {
            let inside = |at: &&(f64, f64)| (*x..=x + w).contains(&at.0) && (*y..=y + h).contains(&at.1);
            assert_eq!(taken.places.iter().chain(&taken.symbols).filter(inside).count(), 0, "name {k}");
            assert!(*x >= 0.0 && x + w <= 400.0 && *y >= 0.0 && y + h <= 300.0);
            for (a, b, c, d) in &taken.boxes[..k] {
                assert!(x + w <= *a || a + c <= *x || y + h <= *b || b + d <= *y, "names {k}");
            }
        }
    }

    #[test]
    fn names_without_room_go_if_they_may_and_stay_if_they_must() {
        let mut taken = Taken::default();
        taken.rectangle(FRAME);
        let mut svg = Svg::new(400.0, 300.0);
        taken.name(&mut svg, FRAME, (200.0, 150.0), "5:mode 3", true);
        assert_eq!(taken.boxes.len(), 1);
        taken.name(&mut svg, FRAME, (200.0, 150.0), "P1", false);
        assert_eq!(taken.boxes.len(), 2);
    }
}
