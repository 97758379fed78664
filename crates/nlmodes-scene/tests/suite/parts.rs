//! Parts of rods and beams, and several of them in one scene.

use std::error::Error;
use std::f64::consts::TAU;

use nlmodes::model::{DofKind, StructuralModel, linear_modes};
use nlmodes_scene::assemble::{Elements, Structures, element_model, structural_model};
use nlmodes_scene::{Scene, SceneError, parse};

type Outcome = Result<(), Box<dyn Error>>;

const REST: &str = "[method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 3.0\n";

fn scene(structure: &str, more: &str) -> Result<Scene, String> {
    let text = format!("{structure}\n{more}\n{REST}");
    parse("scene.toml", &text, &[]).map(|file| file.scene).map_err(|refused: SceneError| refused.text(false))
}

/// The structure as its elements give it.
fn elements(scene: &Scene) -> Result<StructuralModel, Box<dyn Error>> {
    let structure = scene.structure.straight().ok_or("several structures")?;
    Ok(element_model(structure, &scene.contacts)?)
}

fn refused(structure: &str, more: &str) -> String {
    scene(structure, more).err().unwrap_or_else(|| "taken".into())
}

/// A clamped rod of 1.2 m with a stop at its end.
fn rod(heading: &str, more: &str) -> String {
    format!(
        "{heading}\nkind = \"rod\"\nlength_m = 1.2\nelements = 240\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 70e9, density_kg_m3 = 2700.0 }}\nsection = {{ area_m2 = 1e-4 }}\n{more}\n"
    )
}

const STOP: &str = "[[contact]]\nat_m = 1.2\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-4\n";
const SEGMENT: &str = "[[structure.segment]]\nto_m = 0.7\nmaterial = { youngs_modulus_pa = 210e9, density_kg_m3 = \
    7800.0 }\n\
                       section = { area_m2 = 4e-4 }\n";

#[test]
fn a_segment_makes_a_stepped_rod() -> Outcome {
    let model = structural_model(&scene(&rod("[structure]", SEGMENT), STOP)?)?;
    let omega = linear_modes(model.mass(), model.stiffness(), 1)?.omega[0];
    // tan(k₁ l₁) tan(k₂ l₂) = E₁ A₁ k₁ / (E₂ A₂ k₂).
    let [(k1, z1), (k2, z2)] = [(210e9_f64, 7800.0_f64, 4e-4), (70e9, 2700.0, 1e-4)].map(|(e, rho, area)| {
        let k = omega * (rho / e).sqrt();
        (k, e * area * k)
    });
    let off = (k1 * 0.7).tan() * (k2 * 0.5).tan() - z1 / z2;
    assert!(off.abs() < 1e-3 * z1 / z2, "{off}");
    Ok(())
}

#[test]
fn added_mass_of_the_structure_and_of_a_segment() -> Outcome {
    let first = |structure: &str| -> Result<f64, Box<dyn Error>> {
        let model = structural_model(&scene(structure, STOP)?)?;
        Ok(linear_modes(model.mass(), model.stiffness(), 1)?.omega[0])
    };
    let bare = first(&rod("[structure]", ""))?;
    let factor = (0.27_f64 / (0.27 + 0.4)).sqrt();
    for structure in [
        rod("[structure]\nadded_mass_kg_m = 0.4", ""),
        rod("[structure]", "[[structure.segment]]\nto_m = 1.2\nadded_mass_kg_m = 0.4"),
        rod("[structure]\nadded_mass_kg_m = 0.4", "[[structure.segment]]\nto_m = 0.6\n"),
    ] {
        assert!((first(&structure)? / (factor * bare) - 1.0).abs() < 1e-11);
    }
    Ok(())
}

#[test]
fn a_tube_is_area_and_second_moment() -> Outcome {
    let beam = |section: &str| {
        format!(
            "[structure]\nkind = \"beam\"\nlength_m = 1.5\nelements = 10\nstart = \"pinned\"\nend = \"pinned\"\n\
             material = {{ youngs_modulus_pa = 200e9, density_kg_m3 = 7850.0 }}\nsection = {{ {section} }}\n"
        )
    };
    let stop = "[[contact]]\nat_m = 0.75\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 3e-4\n";
    let first = |section: &str| -> Result<f64, Box<dyn Error>> {
        let model = elements(&scene(&beam(section), stop)?)?;
        Ok(linear_modes(model.mass(), model.stiffness(), 1)?.omega[0] / TAU)
    };
    let pi = std::f64::consts::PI;
    let (outer, inner) = (0.01905_f64, 0.01905 - 2.0 * 0.002108_f64);
    let area = pi * (outer.powi(2) - inner.powi(2)) / 4.0;
    let second = pi * (outer.powi(4) - inner.powi(4)) / 64.0;
    let general = format!("area_m2 = {area:e}, second_moment_m4 = {second:e}, shear_factor = 0.5");
    let tube = first("outer_m = 19.05e-3, wall_m = 2.108e-3, shear_factor = 0.5")?;
    assert!((tube / first(&general)? - 1.0).abs() < 1e-12);
    let wall = refused(&beam("outer_m = 0.01, wall_m = 0.006"), stop);
    assert!(wall.contains("more than half of the outer diameter") && wall.contains("at most 0.005"), "{wall}");
    let twice = refused(&beam("outer_m = 0.01, wall_m = 0.001, area_m2 = 1e-4"), stop);
    assert!(twice.contains("gives the section twice"), "{twice}");
    let half = refused(&beam("outer_m = 0.01"), stop);
    assert!(half.contains("`structure.section.wall_m` is missing"), "{half}");
    Ok(())
}

#[test]
fn elements_beside_stops_are_refined_and_converge() -> Outcome {
    let found = scene(&rod("[structure]\nrefine = 8", ""), STOP)?;
    let structure = found.structure.straight().ok_or("not a rod")?;
    assert_eq!((structure.all_elements(), structure.free_dofs()), (243, 243));
    let model = elements(&found)?;
    let contact = model.contacts()[0].normal.entries()[0].0;
    assert_eq!((contact, model.dofs()[contact].position), (242, 1.2));
    let coarse = elements(&scene(&rod("[structure]", ""), STOP)?)?;
    // The mass that is left out at the stop is eight times less.
    let at_stop = |model: &nlmodes::model::StructuralModel| {
        let last = model.dofs().len() - 1;
        model.mass().get(last, last).copied().unwrap_or(0.0)
    };
    assert!((at_stop(&coarse) / at_stop(&model) - 8.0).abs() < 1e-9);
    let nowhere = refused(&rod("[structure]\nrefine = 0.5", ""), STOP);
    assert!(nowhere.contains("`structure.refine` is out of range"), "{nowhere}");
    Ok(())
}

/// A rod with a mass between two nodes of its mesh, which gets one there: `cot(ka) − tan(k(L − a)) = m k/(ρA)`.
#[test]
fn a_mass_and_a_stop_between_nodes_are_where_they_are() -> Outcome {
    let (length, at, mass, per_length) = (1.2_f64, 0.4321_f64, 0.1, 0.27);
    let balance = |k: f64| 1.0 / (k * at).tan() - (k * (length - at)).tan() - mass * k / per_length;
    let (mut low, mut high) = (1e-3, std::f64::consts::FRAC_PI_2 / length);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if balance(middle) > 0.0 { low = middle } else { high = middle }
    }
    let exact = low * (70e9_f64 / 2700.0).sqrt();
    let mut errors = Vec::new();
    for elements in [25, 50, 100] {
        let parts = format!("[[structure.mass_point]]\nat_m = {at}\nmass_kg = {mass}\n");
        let text = rod("[structure]", &parts).replace("elements = 240", &format!("elements = {elements}"));
        let found = scene(&text, &STOP.replace("at_m = 1.2", "at_m = 0.7777"))?;
        let (own, model) = (found.structure.straight().ok_or("not a rod")?, self::elements(&found)?);
        assert_eq!(own.all_elements(), elements);
        let contact = model.contacts()[0].normal.entries()[0].0;
        assert_eq!((found.contacts[0].at, model.dofs()[contact].position), (0.7777, 0.7777));
        let omega = linear_modes(model.mass(), model.stiffness(), 1)?.omega[0];
        errors.push(omega / exact - 1.0);
        let finer = own.with_twice_the_elements().ok_or("no finer mesh")?;
        let finer = element_model(&finer, &[])?;
        let omega = linear_modes(finer.mass(), finer.stiffness(), 1)?.omega[0];
        assert!((0.2..0.3).contains(&((omega / exact - 1.0) / errors.last().ok_or("none")?)));
    }
    // Errors of linear elements fall with the square of their length.
    assert!(errors[2] > 0.0 && errors[2] < 1e-4 && errors.windows(2).all(|e| e[1] < 0.3 * e[0]), "{errors:?}");
    Ok(())
}

#[test]
fn parts_keep_their_places_on_the_finer_mesh() -> Outcome {
    let parts = "[[structure.mass_point]]\nat_m = 0.6\nmass_kg = 0.1\n";
    let found = scene(&rod("[structure]", &format!("{SEGMENT}{parts}")), STOP)?;
    let own = found.structure.straight().ok_or("not a rod")?;
    let finer = own.with_twice_the_elements().ok_or("no finer mesh")?;
    let first = |structure| -> Result<f64, Box<dyn Error>> {
        let model = Elements::new(structure)?.assemble(&[])?;
        Ok(linear_modes(model.mass(), model.stiffness(), 1)?.omega[0])
    };
    let change = first(own)? / first(&finer)? - 1.0;
    assert!((0.0..1e-4).contains(&change), "{change:e}");
    assert_eq!((finer.segments[0].to_node, finer.mass_points[0].node), (280, 240));
    let graded = scene(&rod("[structure]\ngrading = 1.0000001", parts), STOP)?;
    let own = graded.structure.straight().ok_or("not a rod")?;
    let change = first(own)? / first(&own.with_twice_the_elements().ok_or("no finer mesh")?)? - 1.0;
    assert!((0.0..1e-4).contains(&change), "{change:e}");
    Ok(())
}

#[test]
fn segments_off_a_node_or_out_of_order_are_refused_at_their_place() {
    let off = refused(&rod("[structure]", "[[structure.segment]]\nto_m = 7.013\n"), STOP);
    assert!(off.contains("`structure.segment.0.to_m` is beyond the structure"), "{off}");
    let back = rod("[structure]", "[[structure.segment]]\nto_m = 0.7\n[[structure.segment]]\nto_m = 0.5\n");
    let back = refused(&back, STOP);
    assert!(back.contains("`structure.segment.1.to_m` is not behind"), "{back}");
    let fitted = refused(&rod("[structure]", SEGMENT), &format!("{STOP}[updating]\nfrequencies_hz = [900.0]\n"));
    assert!(fitted.contains("without segments"), "{fitted}");
}

/// Two clamped rods that face each other.
fn facing(contact: &str) -> String {
    let second = rod("[[structure]]", "").replace("start = \"clamped\"", "start = \"free\"\nend = \"clamped\"");
    format!(
        "{}{second}[[contact]]\n{contact}direction = \"axial\"\nside = \"positive\"\ngap_m = 2e-4\n",
        rod("[[structure]]", "")
    )
}

const PAIR: &str = "structure = 1\nat_m = 1.2\nagainst = { structure = 2, at_m = 0.0 }\n";

#[test]
fn several_structures_stand_side_by_side() -> Outcome {
    let text = facing(PAIR);
    let found = parse("scene.toml", &format!("{text}{REST}"), &[]).map_err(|refused| refused.text(false))?.scene;
    assert!(found.is_in_open_modes());
    let two = found.structure.bodies();
    assert_eq!((two.len(), found.structure.straight()), (2, None));
    let one = Elements::new(&two[0])?.assemble(&[])?;
    let open = nlmodes_scene::assemble::OpenStructure::of(&found, &Structures::default())?;
    assert_eq!(open.dofs.len(), 2 * one.dofs().len());
    // The gap closes with the end of the first and opens with the start of the second, whose nodes are numbered after.
    let w = open.modes.directions();
    let entry = |node: usize| {
        let row = open.dofs.iter().position(|dof| dof.node == node && dof.kind == DofKind::Axial);
        row.and_then(|row| w.get(row, 0).copied())
    };
    assert_eq!((entry(240), entry(241)), (Some(-1.0), Some(1.0)));
    // Alone and together they have the same frequencies, twice each.
    let alone = linear_modes(one.mass(), one.stiffness(), 2)?.omega;
    for (r, square) in open.modes.omega_squared().iter().take(4).enumerate() {
        assert!((square.sqrt() / alone[r / 2] - 1.0).abs() < 1e-9);
    }
    Ok(())
}

#[test]
fn springs_and_masses_belong_to_the_structure_that_they_name() -> Outcome {
    let spring = "[[structure.spring]]\nat_m = 1.2\ndirection = \"axial\"\nstiffness_n_m = 1e6\n";
    let first = format!("{}{spring}", rod("[[structure]]", ""));
    let named = format!("{}{spring}structure = 1\n", rod("[[structure]]", ""));
    let stops = STOP.replace("[[contact]]", "[[contact]]\nstructure = 1");
    let one = scene(&format!("{first}{}", rod("[[structure]]", "")), &stops)?;
    let other = scene(&format!("{}{named}", rod("[[structure]]", "")), &stops)?;
    assert_eq!(one.structure, other.structure);
    assert_eq!(one.structure.bodies().iter().map(|body| body.springs.len()).collect::<Vec<_>>(), [1, 0]);
    let nobody = refused(&format!("{first}structure = 3\n{}", rod("[[structure]]", "")), &stops);
    assert!(nobody.contains("there is no structure 3") && nobody.contains("from 1 to 2"), "{nobody}");
    Ok(())
}

#[test]
fn what_is_wrong_with_one_of_several_is_said_at_its_place() {
    let wrong = |contact: &str| refused(&facing(contact), "");
    let missing = wrong("at_m = 1.2\n");
    assert!(missing.contains("`contact.0.structure` is missing"), "{missing}");
    let beyond = wrong("structure = 1\nat_m = 1.2\nagainst = { structure = 5, at_m = 0.0 }\n");
    assert!(beyond.contains("`contact.0.against.structure`: there is no structure 5"), "{beyond}");
    let itself = wrong("structure = 1\nat_m = 1.2\nagainst = { structure = 1, at_m = 0.6 }\n");
    assert!(itself.contains("is the structure that touches"), "{itself}");
    let off = wrong("structure = 1\nat_m = 1.2\nagainst = { structure = 2, at_m = 1e-5 }\n");
    assert!(off.contains("`contact.0.against.at_m` is too close to another node"), "{off}");
    let held = wrong("structure = 2\nat_m = 1.2\n");
    assert!(held.contains("at the clamped end, which does not move"), "{held}");
    let second = facing(PAIR).replacen("section = { area_m2 = 1e-4 }", "section = { width_m = 1e-4 }", 2);
    let second = second.replacen("section = { width_m = 1e-4 }", "section = { area_m2 = 1e-4 }", 1);
    let second = refused(&second, "");
    assert!(
        second.contains("`structure.1.section.height_m` is missing") && second.contains("scene.toml:1"),
        "{second}"
    );
    let held = refused(&facing(PAIR), "[reduction]\nkind = \"held-modes\"\n");
    assert!(held.contains("several structures are reduced by their open modes"), "{held}");
    let force = "[damping]\nratio = 0.01\n[response]\nkind = \"frequency\"\nfrequency_hz = [1.0, 2.0]\n[[force]]\n";
    let nowhere = refused(&facing(PAIR), &format!("{force}at_m = 0.3\n"));
    assert!(nowhere.contains("`force.0.structure` is missing") && nowhere.contains("which one is meant"), "{nowhere}");
    let third = refused(&facing(PAIR), &format!("{force}structure = 3\nat_m = 0.3\n"));
    assert!(third.contains("`force.0.structure`: there is no structure 3"), "{third}");
    let across = refused(&facing(PAIR), &format!("{force}structure = 2\nat_m = 0.3\ndirection = \"transverse\"\n"));
    assert!(across.contains("cannot be \"transverse\" on a rod"), "{across}");
    // One structure has nothing else to touch.
    let alone = STOP.replace("[[contact]]", "[[contact]]\nagainst = { structure = 2, at_m = 0.0 }");
    let alone = refused(&rod("[structure]", ""), &alone);
    assert!(alone.contains("there is no structure 2"), "{alone}");
}
