//! Grid points and their coordinate systems.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::BulkCard;
use crate::error::{Place, Problem, ReadError, Result, shown};
use crate::text::{real, signed, unsigned};

/// A point along the basic axes, or an axis.
type Vector = [f64; 3];

/// What the numbers of a place mean.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Curve {
    /// x, y, z.
    Rectangular,
    /// Radius, angle in degrees, z.
    Cylindrical,
    /// Radius, angle from z and angle around it in degrees.
    Spherical,
}

/// Origin, a point on the z axis, a point in the plane of x and z.
#[derive(Debug, Clone)]
enum Definition {
    /// In another system (`CORD2R`, `CORD2C`, `CORD2S`).
    Places { reference: u64, places: [Vector; 3] },
    /// Grid points (`CORD1R`, `CORD1C`, `CORD1S`).
    Grids([u64; 3]),
}

struct System {
    curve: Curve,
    definition: Definition,
    line: u64,
}

/// Origin and axes of a system, along the basic axes.
#[derive(Clone, Copy)]
struct Frame {
    curve: Curve,
    origin: Vector,
    axes: [Vector; 3],
}

struct Grid {
    line: u64,
    system: u64,
    place: Vector,
    directions: i64,
}

/// Grid points as they come, with their systems.
#[derive(Default)]
pub(crate) struct Points {
    grids: HashMap<u64, Grid>,
    order: Vec<u64>,
    systems: HashMap<u64, System>,
    default_system: Option<u64>,
    default_directions: Option<i64>,
}

/// Axes along which the displacements of a node are, as rows along the global axes; none where they are not known.
pub(crate) type Directions = Option<[Vector; 3]>;

/// Grid points along the basic axes.
#[derive(Debug, Default)]
pub(crate) struct Located {
    /// Number and place, in the order of the file.
    pub(crate) places: Vec<(u64, Vector)>,
    /// Directions of those for which they are not the basic axes.
    pub(crate) directions: HashMap<u64, Directions>,
    /// Why the first of those that have no place has none.
    pub(crate) unplaced: Option<ReadError>,
}

fn wrong(path: &Path, line: u64, expected: impl Into<String>, found: impl Into<String>) -> ReadError {
    ReadError::new(path, Place::Line(line), Problem::Expected { expected: expected.into(), found: found.into() })
}

impl Points {
    /// Whether a card of this name is one of a grid point or of a coordinate system.
    pub(crate) fn knows(name: &str) -> bool {
        matches!(name, "GRID" | "GRDSET") || curve(name).is_some()
    }

    /// Takes a card that [`knows`](Self::knows) accepts.
    pub(crate) fn take(&mut self, path: &Path, card: &BulkCard) -> Result<()> {
        match (card.name.as_str(), curve(&card.name)) {
            ("GRID", _) => self.grid(path, card),
            ("GRDSET", _) => {
                self.default_system = optional(path, card, 1)?;
                self.default_directions = whole(path, card, 5)?;
                Ok(())
            }
            (_, Some((true, curve))) => self.by_places(path, card, curve),
            (_, Some((false, curve))) => self.by_grids(path, card, curve),
            (_, None) => Ok(()),
        }
    }

    fn grid(&mut self, path: &Path, card: &BulkCard) -> Result<()> {
        let number = number(path, card, 0)?;
        let grid = Grid {
            line: card.line,
            // The default of all grid points may follow them: it is inserted at the end.
            system: optional(path, card, 1)?.unwrap_or(u64::MAX),
            place: vector(path, card, 2)?,
            directions: whole(path, card, 5)?.unwrap_or(i64::MAX),
        };
        let place = grid.place;
        if let Some(before) = self.grids.insert(number, grid) {
            if before.place != place {
                let expected = format!("node {number} at {:?}, as in line {}", before.place, before.line);
                return Err(wrong(path, card.line, expected, format!("{place:?}")));
            }
        } else {
            self.order.push(number);
        }
        Ok(())
    }

    fn by_places(&mut self, path: &Path, card: &BulkCard, curve: Curve) -> Result<()> {
        let reference = optional(path, card, 1)?.unwrap_or(0);
        let places = [vector(path, card, 2)?, vector(path, card, 5)?, vector(path, card, 8)?];
        let definition = Definition::Places { reference, places };
        self.systems.insert(number(path, card, 0)?, System { curve, definition, line: card.line });
        Ok(())
    }

    /// One or two systems in a card.
    fn by_grids(&mut self, path: &Path, card: &BulkCard, curve: Curve) -> Result<()> {
        for first in [0, 4] {
            if first == 4 && card.field(4).is_empty() {
                break;
            }
            let [a, b, c] = [1, 2, 3].map(|k| number(path, card, first + k));
            let definition = Definition::Grids([a?, b?, c?]);
            self.systems.insert(number(path, card, first)?, System { curve, definition, line: card.line });
        }
        Ok(())
    }

    /// All points along the basic axes.
    pub(crate) fn locate(&self, path: &Path) -> Located {
        let mut located = Located::default();
        let mut frames = HashMap::new();
        for number in &self.order {
            match self.place(path, *number, &mut frames, &mut HashSet::new()) {
                Ok(place) => located.places.push((*number, place)),
                Err(error) => _ = located.unplaced.get_or_insert(error),
            }
        }
        for (number, place) in &located.places {
            if let Some(system) = self.directions(*number) {
                let frame = self.frame(path, system, &mut frames, &mut HashSet::new()).ok();
                let axes = frame.map(|frame| frame.axes_at(*place));
                if axes.is_none_or(|axes| !are_basic(&axes)) {
                    located.directions.insert(*number, axes);
                }
            }
        }
        located
    }

    /// The system of the directions of a point, if that is not the basic one; −1 is a point of a fluid, without any.
    fn directions(&self, number: u64) -> Option<u64> {
        let given = self.grids.get(&number).map_or(0, |grid| grid.directions);
        let system = if given == i64::MAX { self.default_directions.unwrap_or(0) } else { given };
        u64::try_from(system).ok().filter(|system| *system > 0)
    }

    fn place(
        &self,
        path: &Path,
        number: u64,
        frames: &mut HashMap<u64, Frame>,
        within: &mut HashSet<u64>,
    ) -> Result<Vector> {
        let grid = self.grids.get(&number).ok_or_else(|| {
            let found = format!("node {number}, which is not there");
            ReadError::whole(path, Problem::Expected { expected: "grid points that are in the file".into(), found })
        })?;
        let system = if grid.system == u64::MAX { self.default_system.unwrap_or(0) } else { grid.system };
        if system == 0 {
            return Ok(grid.place);
        }
        if !self.systems.contains_key(&system) {
            let expected = "places along the basic axes or in a coordinate system that is in the file (CORD1*, CORD2*)";
            let found = format!("node {number} in system {system}, which is not there");
            return Err(wrong(path, grid.line, expected, found));
        }
        Ok(self.frame(path, system, frames, within)?.place(grid.place))
    }

    /// A system along the basic axes; `within` are those that wait for it.
    fn frame(
        &self,
        path: &Path,
        number: u64,
        frames: &mut HashMap<u64, Frame>,
        within: &mut HashSet<u64>,
    ) -> Result<Frame> {
        const DEEPEST: usize = 200;
        if let Some(frame) = frames.get(&number) {
            return Ok(*frame);
        }
        let Some(system) = self.systems.get(&number) else {
            let found = format!("system {number}, which is not there");
            let expected = "coordinate systems that are in the file".into();
            return Err(ReadError::whole(path, Problem::Expected { expected, found }));
        };
        if !within.insert(number) || within.len() > DEEPEST {
            let expected = "coordinate systems that are defined in others, and at last in the basic one";
            return Err(wrong(path, system.line, expected, format!("system {number}, which is defined in itself")));
        }
        let [origin, axis, plane] = match &system.definition {
            Definition::Places { reference: 0, places } => *places,
            Definition::Places { reference, places } => {
                let frame = self.frame(path, *reference, frames, within)?;
                places.map(|place| frame.place(place))
            }
            Definition::Grids(grids) => {
                let [a, b, c] = grids.map(|grid| self.place(path, grid, frames, within));
                [a?, b?, c?]
            }
        };
        within.remove(&number);
        let axes = axes(origin, axis, plane).ok_or_else(|| {
            let expected = "three points of a coordinate system that do not lie on one line";
            wrong(path, system.line, expected, format!("those of system {number}"))
        })?;
        let frame = Frame { curve: system.curve, origin, axes };
        frames.insert(number, frame);
        Ok(frame)
    }
}

impl Frame {
    fn place(&self, [a, b, c]: Vector) -> Vector {
        let along = match self.curve {
            Curve::Rectangular => [a, b, c],
            Curve::Cylindrical => [a * b.to_radians().cos(), a * b.to_radians().sin(), c],
            Curve::Spherical => {
                let (from, around) = (b.to_radians(), c.to_radians());
                [a * from.sin() * around.cos(), a * from.sin() * around.sin(), a * from.cos()]
            }
        };
        let sum = |k: usize| (0..3).map(|axis| along[axis] * self.axes[axis][k]).sum::<f64>();
        std::array::from_fn(|k| self.origin[k] + sum(k))
    }

    /// Directions of the numbers at a place along the basic axes: those of a curved system turn with it.
    fn axes_at(&self, place: Vector) -> [Vector; 3] {
        let from = std::array::from_fn::<f64, 3, _>(|k| place[k] - self.origin[k]);
        let [x, y, z] = self.axes.map(|axis| (0..3).map(|k| axis[k] * from[k]).sum::<f64>());
        let along = |local: Vector| -> Vector {
            std::array::from_fn(|k| (0..3).map(|axis| local[axis] * self.axes[axis][k]).sum())
        };
        let around = y.atan2(x);
        let (sin, cos) = around.sin_cos();
        let (radial, tangent) = ([cos, sin, 0.0], [-sin, cos, 0.0]);
        match self.curve {
            Curve::Rectangular => self.axes,
            Curve::Cylindrical => [radial, tangent, [0.0, 0.0, 1.0]].map(along),
            Curve::Spherical => {
                let (s, c) = x.hypot(y).atan2(z).sin_cos();
                [[s * cos, s * sin, c], [c * cos, c * sin, -s], tangent].map(along)
            }
        }
    }
}

fn are_basic(axes: &[Vector; 3]) -> bool {
    (0..3).all(|i| (0..3).all(|j| (axes[i][j] - f64::from(u8::from(i == j))).abs() < 1e-12))
}

/// Unit vectors of x, y and z; none if the points lie on one line.
fn axes(origin: Vector, axis: Vector, plane: Vector) -> Option<[Vector; 3]> {
    let minus = |a: Vector, b: Vector| std::array::from_fn(|k| a[k] - b[k]);
    let cross = |a: Vector, b: Vector| {
        std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    };
    let unit = |a: Vector| {
        let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
        (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
    };
    let z = unit(minus(axis, origin))?;
    let y = unit(cross(z, minus(plane, origin)))?;
    Some([cross(y, z), y, z])
}

/// Whether a card is one of a system by places, else by grid points, and what its numbers mean.
fn curve(name: &str) -> Option<(bool, Curve)> {
    let curve = match name.as_bytes().last()? {
        b'R' => Curve::Rectangular,
        b'C' => Curve::Cylindrical,
        b'S' => Curve::Spherical,
        _ => return None,
    };
    match name.get(..5)? {
        "CORD1" if name.len() == 6 => Some((false, curve)),
        "CORD2" if name.len() == 6 => Some((true, curve)),
        _ => None,
    }
}

fn number(path: &Path, card: &BulkCard, k: usize) -> Result<u64> {
    let found = unsigned(card.field(k)).filter(|number| *number > 0);
    found.ok_or_else(|| {
        wrong(path, card.line, format!("a number from 1 on in field {} of {}", k + 2, card.name), shown(card.field(k)))
    })
}

/// A system, if the field has one.
fn optional(path: &Path, card: &BulkCard, k: usize) -> Result<Option<u64>> {
    if card.field(k).is_empty() {
        return Ok(None);
    }
    let system = || format!("a coordinate system in field {} of {}", k + 2, card.name);
    unsigned(card.field(k)).map(Some).ok_or_else(|| wrong(path, card.line, system(), shown(card.field(k))))
}

fn whole(path: &Path, card: &BulkCard, k: usize) -> Result<Option<i64>> {
    if card.field(k).is_empty() {
        return Ok(None);
    }
    let system = || format!("a coordinate system in field {} of {}", k + 2, card.name);
    signed(card.field(k)).map(Some).ok_or_else(|| wrong(path, card.line, system(), shown(card.field(k))))
}

fn vector(path: &Path, card: &BulkCard, first: usize) -> Result<Vector> {
    let coordinate = |k: usize| {
        let field = card.field(first + k);
        if field.is_empty() {
            return Ok(0.0);
        }
        real(field).filter(|value| value.is_finite()).ok_or_else(|| {
            wrong(path, card.line, format!("a coordinate in field {} of {}", first + k + 2, card.name), shown(field))
        })
    };
    Ok([coordinate(0)?, coordinate(1)?, coordinate(2)?])
}

#[cfg(test)]
mod tests {
    use super::super::{BulkLine, Start};
    use super::*;

    fn located(text: &str) -> Located {
        let (mut points, mut card) = (Points::default(), None::<BulkCard>);
        let path = Path::new("x.bdf");
        for (line, number) in text.lines().zip(1..) {
            let line = BulkLine::read(line.as_bytes());
            if line.start == Start::More {
                card.iter_mut().for_each(|card| card.extend(&line));
            } else {
                card.replace(BulkCard::begin(&line, number)).iter().for_each(|card| points.take(path, card).unwrap());
            }
        }
        card.iter().for_each(|card| points.take(path, card).unwrap());
        points.locate(path)
    }

    #[track_caller]
    fn close(found: Vector, expected: Vector) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
    }

    /// A cylinder about the global y axis, in a system that is displaced along x; a point on it, and one that has its
    /// directions.
    #[test]
    fn places_and_directions_of_curved_systems_are_along_the_basic_axes() {
        let found = located(
            "CORD2R,1,,10.,0.,0.,10.,0.,1.,\n,11.,0.,0.\nCORD2C,2,1,0.,0.,0.,0.,1.,0.\n,0.,0.,1.\n\
             GRID,5,2,2.,90.,3.,2\nGRID,6,,1.,2.,3.,1\n",
        );
        // The axis is y, the angle counts from z toward x.
        close(found.places[0].1, [12.0, 3.0, 0.0]);
        let axes = found.directions[&5].unwrap();
        close(axes[0], [1.0, 0.0, 0.0]);
        close(axes[1], [0.0, 0.0, -1.0]);
        close(axes[2], [0.0, 1.0, 0.0]);
        close(found.places[1].1, [1.0, 2.0, 3.0]);
        assert!(!found.directions.contains_key(&6), "a system that is only moved turns nothing");
    }

    #[test]
    fn spheres_defaults_and_systems_by_grid_points_are_read() {
        let found = located(
            "GRDSET,,7,,,,8\nGRID,1,0,0.,0.,0.,0\nGRID,2,0,0.,0.,1.,0\nGRID,3,0,1.,0.,0.,0\nCORD1S,7,1,2,3\n\
             GRID,4,,2.,90.,90.\n",
        );
        close(found.places[3].1, [0.0, 2.0, 0.0]);
        assert_eq!(found.directions.get(&4), Some(&None), "system 8 is not there");
        let circle = located(
            "CORD2R,1,2,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,1,0.,0.,0.\n",
        );
        let refused = circle.unplaced.unwrap().to_string();
        assert!(refused.contains("which is defined in itself"), "{refused}");
    }
}
