//! Segments of rods and beams as steps of their elements.

use nlmodes::fem::{Beam, FemError, Material, Mesh, Section, Step};

use crate::scene;

/// The steps of a rod; none where it is the same everywhere.
pub fn of_rod(structure: &scene::Structure, mesh: &Mesh) -> Result<Vec<Step<f64>>, FemError> {
    let step = |of: scene::Segment| {
        let material = Material::new(of.youngs_modulus, of.density)?;
        Ok(Step { to_node: of.to_node, material, section: of.section.area(), added_mass: of.added_mass })
    };
    segments(structure, mesh).into_iter().map(step).collect()
}

/// The steps of a beam; none where it is the same everywhere.
pub fn of_beam(structure: &scene::Structure, mesh: &Mesh) -> Result<Vec<Step<Section>>, FemError> {
    let step = |of: scene::Segment| {
        let (material, section) = material_and_section(Material::new(of.youngs_modulus, of.density)?, of.section)?;
        Ok(Step { to_node: of.to_node, material, section, added_mass: of.added_mass })
    };
    segments(structure, mesh).into_iter().map(step).collect()
}

/// Material and section of a beam; the section of a rod has no second moment and is refused.
pub fn material_and_section(material: Material, section: scene::Section) -> Result<(Material, Section), FemError> {
    let scene::Section::Beam { area, second_moment, shear_factor, poissons_ratio, outer_fibre } = section else {
        return Ok((material, Section::new(section.area(), 0.0)?));
    };
    let section = Section::new(area, second_moment)?.with_shear_factor(shear_factor)?;
    let section = outer_fibre.map_or(Ok(section), |distance| section.with_outer_fibre(distance))?;
    Ok((material.with_poissons_ratio(poissons_ratio)?, section))
}

/// The beam with its local properties at a position, on which the shape of an element depends.
pub fn beam_there(beam: &Beam, steps: &[Step<Section>], position: f64) -> Beam {
    let nodes = beam.mesh.nodes();
    let step = steps.iter().find(|step| nodes.get(step.to_node).is_some_and(|end| position < *end));
    match step.or(steps.last().filter(|last| last.to_node == beam.mesh.elements())) {
        Some(step) => Beam { material: step.material, section: step.section, ..beam.clone() },
        None => beam.clone(),
    }
}

/// The segments, and one more for the rest of a structure with added mass.
fn segments(structure: &scene::Structure, mesh: &Mesh) -> Vec<scene::Segment> {
    let mut all = structure.segments.clone();
    let end = all.last().map_or(0, |last| last.to_node);
    if structure.added_mass > 0.0 && end < mesh.elements() {
        all.push(scene::Segment {
            to_node: mesh.elements(),
            to: mesh.length(),
            youngs_modulus: structure.youngs_modulus,
            density: structure.density,
            section: structure.section,
            added_mass: structure.added_mass,
        });
    }
    all
}
