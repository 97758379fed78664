//! Frequencies at which the truncated motions and the exact one lie side by side, to choose the point of a case.

use std::f64::consts::TAU;

use nlmodes::hbm::{CondensedStructure, Switching, grazing};
use nlmodes_benchmarks::Failure;

use crate::cases::{Case, cases};
use crate::methods::{Method, Neighbours, Setting, descent, errors, starts};
use crate::reference::{Reference, backbone};
use crate::tables::figure;

/// `STRUCTURE FROM TO STEP [MOST]`: frequencies over that at grazing, most harmonics.
pub fn survey(arguments: &[String]) -> Result<(), Failure> {
    let [slug, from, to, step, most @ ..] = arguments else {
        return Err("survey STRUCTURE FROM TO STEP [MOST]".into());
    };
    let (from, to, step): (f64, f64, f64) = (from.parse()?, to.parse()?, step.parse()?);
    let mut case = cases()?.into_iter().find(|case| case.slug == slug).ok_or("no such structure")?;
    if let Some(most) = most.first() {
        case.most_harmonics = most.parse()?;
    }
    let most = case.most_harmonics;
    let places = ((to - from) / step).round() as usize;
    println!("frequency over grazing | from | E_av over grazing | stretches | closed | found from `N_h` | errors");
    let (mut exact, mut all) = (0, 0);
    for place in 0..=places {
        let ratio = from + step * place as f64;
        match at(&case, ratio) {
            Ok(rows) => {
                exact += usize::from(!rows.is_empty());
                all += usize::from(rows.iter().any(|row| row.0 <= 20));
                rows.iter().for_each(|row| println!("{ratio:.4} | {}", row.1));
            }
            Err(error) => println!("{ratio:.4} | {error}"),
        }
    }
    println!(
        "{} frequencies; an exact motion at {exact}; found with every N_h of the study from 20 to {most}: {all}",
        places + 1
    );
    Ok(())
}

/// Each exact motion to which a number of harmonics leads: from which `N_h` on all find it, and a line of text.
fn at(case: &Case, ratio: f64) -> Result<Vec<(usize, String)>, Failure> {
    let structure = CondensedStructure::new(Reference::model(case)?, usize::MAX)?;
    let start = grazing(&structure, 1)?;
    let z = backbone(case, structure.model(), ratio * start.omega / TAU)?;
    let mut motions: Vec<Reference> = Vec::new();
    let mut rows = Vec::new();
    for seed in [case.leading_harmonics, 7, 10, 20, 40, 80].into_iter().filter(|seed| *seed <= case.most_harmonics) {
        let Ok(reference) = Reference::beside(&structure, &start, &z, case.leading_harmonics, seed) else { continue };
        let energy = reference.parameter();
        if energy < 1e-6 || motions.iter().any(|other| (other.parameter() - energy).abs() < 1e-7) {
            continue;
        }
        let (mut known, mut from, mut text) = (Neighbours::new(), usize::MAX, String::new());
        let mut complete = true;
        for (h, wanted) in descent(case) {
            let setting =
                Setting { method: Method::Exact, harmonics: h, switching: Switching::Exact, solver: "active-set" };
            let (m, found) = errors(&structure, &reference, &setting, &starts(&structure, &reference, &known, h)?)?;
            known.insert(h, found);
            if !wanted {
                continue;
            }
            complete &= m.displacement.is_finite() && m.frequency.is_finite();
            if complete {
                from = h;
            }
            text = format!(" {h}:{}/{}", figure(m.displacement), figure(m.frequency)) + &text;
        }
        let mark = if from == usize::MAX { "–".to_owned() } else { from.to_string() };
        rows.push((from, format!("{seed} | {} | {mark} |{text}", reference.brief())));
        motions.push(reference);
    }
    Ok(rows)
}
