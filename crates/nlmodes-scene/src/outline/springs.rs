//! Springs and dampers with a law of force.

use super::responses::place;
use super::{Row, list, row};
use crate::number;
use crate::scene::{LawSpring, Scene, SpringLaw};

/// A row for each.
pub fn rows(scene: &Scene) -> impl Iterator<Item = Row> {
    let several = scene.structure.bodies().len() > 1;
    scene.springs.iter().enumerate().map(move |(i, spring)| row(format!("spring {i}"), text(spring, several)))
}

fn text(spring: &LawSpring, several: bool) -> String {
    let other = spring.against.as_ref().map_or("the ground".to_owned(), |other| place(other, several));
    format!("{} to {other}, {}", place(&spring.at, several), law(&spring.law))
}

fn law(law: &SpringLaw) -> String {
    match law {
        SpringLaw::Polynomial(coefficients) => {
            format!("polynomial with [{}] N/m, N/m², N/m³ …", list(coefficients))
        }
        SpringLaw::Table(path) => format!("table {}", path.display()),
        SpringLaw::Function(name) => format!("function {name} of a program"),
        SpringLaw::DamperTable(path) => format!("damper by the table {}", path.display()),
        SpringLaw::Power { stiffness, exponent, one_sided } => {
            let side = if *one_sided { ", against positive displacements alone" } else { "" };
            format!("power {} of the displacement times {}{side}", number(*exponent), number(*stiffness))
        }
        SpringLaw::Exponential { force, length } => {
            format!("{} N times (exp(v / {} m) - 1)", number(*force), number(*length))
        }
        SpringLaw::Bilinear { inner, outer, knee } => {
            format!("{} N/m up to {} m, {} N/m beyond", number(*inner), number(*knee), number(*outer))
        }
        SpringLaw::Damper { coefficient, exponent } => {
            format!("damper, power {} of the velocity times {}", number(*exponent), number(*coefficient))
        }
    }
}
