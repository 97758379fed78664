//! Placement of the names of symbols, without overlap as far as possible.

use super::inset::Rectangle;
use crate::svg::{Anchor, Stroke, Svg, text_width};

const FONT: f64 = 13.0;
/// Half the width of a symbol with a rim, pixels.
const SYMBOL: f64 = 7.0;
/// Sampling distance along curves, pixels.
const STEP: f64 = 4.0;
/// Minimum distance of two names on one line, pixels.
const APART: f64 = 10.0;
const LEADER: Stroke = Stroke::solid("#666666", 0.7);

/// Items already in the picture.
#[derive(Debug, Default)]
pub(super) struct Taken {
    places: Vec<(f64, f64)>,
    symbols: Vec<(f64, f64)>,
    boxes: Vec<Rectangle>,
}

/// Position of a name: its rectangle, and the distance above which a line leads to it.
struct Place {
    rectangle: Rectangle,
    is_far: bool,
}

impl Place {
    /// End of the line from the symbol at `at`.
    fn near(&self, at: (f64, f64)) -> (f64, f64) {
        let (x, y, w, h) = self.rectangle;
        (at.0.clamp(x, x + w), at.1.clamp(y, y + h))
    }

    /// Whether that line runs through one of these rectangles.
    fn leads_through(&self, at: (f64, f64), boxes: &[Rectangle]) -> bool {
        let near = self.near(at);
        let on_way = |k: i32| {
            let share = f64::from(k) / 16.0;
            (at.0 + share * (near.0 - at.0), at.1 + share * (near.1 - at.1))
        };
        let holds =
            |(x, y, w, h): &Rectangle, at: (f64, f64)| (*x..=x + w).contains(&at.0) && (*y..=y + h).contains(&at.1);
        self.is_far && (0..=16).map(on_way).any(|at| boxes.iter().any(|one| holds(one, at)))
    }
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

    /// Writes a name beside the symbol at `at`, within `frame`, where it covers least; if `may_go`, it is omitted if it
    /// would cover a symbol or another name.
    pub fn name(&mut self, svg: &mut Svg, frame: Rectangle, at: (f64, f64), name: &str, may_go: bool) {
        let size = (text_width(name, FONT) * 0.92, FONT);
        let candidates = candidates(at, size);
        let Some((cost, place)) =
            candidates.map(|place| (self.cost(&place, at, frame), place)).min_by(|a, b| a.0.total_cmp(&b.0))
        else {
            return;
        };
        if may_go && cost >= HIDES {
            return;
        }
        let (x, y, w, h) = place.rectangle;
        if place.is_far {
            svg.line(at, place.near(at), &LEADER);
        }
        svg.haloed_text((x + 0.5 * w, y + 0.82 * h), Anchor::Middle, FONT, name);
        self.boxes.push(place.rectangle);
    }

    fn cost(&self, place: &Place, at: (f64, f64), frame: Rectangle) -> f64 {
        let (x, y, w, h) = place.rectangle;
        let holds = |margin: f64, (a, b): &(f64, f64)| {
            (x - margin..=x + w + margin).contains(a) && (y - margin..=y + h + margin).contains(b)
        };
        let curves = self.places.iter().filter(|at| holds(1.5, at)).count();
        let symbols = self.symbols.iter().filter(|at| holds(SYMBOL, at)).count();
        // Two adjacent names would read as one.
        let crosses = |(a, b, c, d): &Rectangle| x < a + c + APART && *a < x + w + APART && y < b + d && *b < y + h;
        let boxes = self.boxes.iter().filter(|other| crosses(other)).count();
        let through = usize::from(place.leads_through(at, &self.boxes));
        let (left, top, width, height) = frame;
        let outside = x < left + 2.0 || y < top + 2.0 || x + w > left + width - 2.0 || y + h > top + height - 2.0;
        let far = if place.is_far { 3.0 } else { 0.0 };
        curves as f64 + far + HIDES * (symbols + 2 * boxes + through) as f64 + if outside { 20.0 * HIDES } else { 0.0 }
    }
}

/// Cost of hiding a symbol, in units of hiding a curve at one point.
const HIDES: f64 = 100.0;

/// Positions around a symbol, the preferred ones first.
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
        // Symbols on a descending line, every 24 pixels, and a second line to the right.
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
    fn names_of_one_place_do_not_read_as_one() {
        let mut taken = Taken::default();
        let mut svg = Svg::new(400.0, 300.0);
        taken.symbol((200.0, 150.0));
        // A mark at the tip of an internal-resonance branch, with those of other branches close by.
        for (shift, name, may_go) in
            [(0.0, "4", false), (0.0, "5:mode 2", true), (3.0, "16:mode 2", true), (-4.0, "17:mode 2", true)]
        {
            taken.name(&mut svg, FRAME, (200.0 + shift, 150.0), name, may_go);
        }
        assert_eq!(taken.boxes.len(), 4);
        for (k, (x, y, w, h)) in taken.boxes.iter().enumerate() {
            for (a, b, c, d) in &taken.boxes[..k] {
                let is_beside = y + h > *b && b + d > *y;
                assert!(!is_beside || x - (a + c) >= APART || a - (x + w) >= APART, "{:?}", taken.boxes);
            }
            // No line to a name crosses another name.
            let place = Place { rectangle: (*x, *y, *w, *h), is_far: true };
            let at = (200.0 + [0.0, 0.0, 3.0, -4.0][k], 150.0);
            let far = (at.0 - place.near(at).0).hypot(at.1 - place.near(at).1) > 25.0;
            assert!(!far || !place.leads_through(at, &taken.boxes[..k]), "{:?}", taken.boxes);
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
