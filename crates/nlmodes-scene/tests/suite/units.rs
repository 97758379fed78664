//! Keys in other units than those of the schema.

use std::error::Error;

use nlmodes_scene::{Scene, parse, parse_test};

type Outcome = Result<(), Box<dyn Error>>;

const BEAM: &str = r#"
[structure]
kind = "beam"
length_m = 0.18
elements = 18
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7850.0 }
section = { width_m = 0.020, height_m = 0.003 }
[[structure.mass_point]]
at_m = 0.18
mass_kg = 0.05
[[contact]]
at_m = 0.17
direction = "transverse"
side = "positive"
gap_m = 1.03e-3
stiffness_n_m = 2.3e6
[damping]
ratios = [0.005, 0.01]
[base_motion]
acceleration_m_s2 = 19.6133
[response]
kind = "frequency"
frequency_hz = [30.0, 60.0]
levels_m_s2 = [9.80665, 19.6133]
[method]
harmonics = 5
"#;

const IN_OTHER_UNITS: &str = r#"
[structure]
kind = "beam"
length_mm = 180
elements = 18
start = "clamped"
material = { youngs_modulus_gpa = 210, density_g_cm3 = 7.85 }
section = { width_mm = 20, height_cm = 0.3 }
[[structure.mass_point]]
at_cm = 18
mass_g = 50.0
[[contact]]
at_mm = 170
direction = "transverse"
side = "positive"
gap_mm = 1.03
stiffness_n_mm = 2.3e3
[damping]
ratios_percent = [0.5, 1]
[base_motion]
acceleration_g = 2
[response]
kind = "frequency"
frequency_khz = [0.03, 0.06]
levels_g = [1, 2.0]
[method]
harmonics = 5
"#;

fn scene(text: &str, overrides: &[&str]) -> Result<Scene, String> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    parse("strip.toml", text, &overrides).map(|file| file.scene).map_err(|refused| refused.text(false))
}

#[test]
fn a_scene_in_other_units_is_the_same_to_the_last_digit() -> Outcome {
    assert_eq!(scene(IN_OTHER_UNITS, &[])?, scene(BEAM, &[])?);
    Ok(())
}

#[test]
fn overrides_replace_a_key_in_whatever_unit_it_stands() -> Outcome {
    for (text, wanted) in
        [("contact.0.gap_mm=0.5", 0.5e-3), ("contact.0.gap_um=7", 7e-6), ("contact.0.gap_m=2e-3", 2e-3)]
    {
        for file in [BEAM, IN_OTHER_UNITS] {
            assert_eq!(scene(file, &[text])?.contacts[0].gap, wanted, "{text}");
        }
    }
    assert_eq!(
        scene(BEAM, &["response.levels_mm_s2=[500]", "base_motion.acceleration_mm_s2=500"])?.responses[0].levels,
        [0.5]
    );
    Ok(())
}

#[test]
fn both_at_once_wrong_kinds_and_wrong_values_are_refused_in_the_words_of_the_file() {
    let refused = |from: &str, to: &str| scene(&IN_OTHER_UNITS.replace(from, to), &[]).unwrap_err();
    let twice = refused("gap_mm = 1.03", "gap_mm = 1.03\ngap_m = 1.03e-3");
    assert!(twice.contains("`contact.0.gap_m` is given twice, in two units"), "{twice}");
    let negative = refused("length_mm = 180", "length_mm = -180");
    assert!(negative.contains("`structure.length_mm` is out of range"), "{negative}");
    assert!(negative.contains("found -180 mm, expected a number greater than 0, in m"), "{negative}");
    let foreign = refused("gap_mm = 1.03", "gap_kg = 1.03");
    assert!(foreign.contains("unknown key `contact.0.gap_kg`"), "{foreign}");
    let beyond = refused("at_mm = 170", "at_mm = 1700");
    assert!(beyond.contains("`contact.0.at_mm` is beyond the structure"), "{beyond}");
    let text = refused("gap_mm = 1.03", "gap_mm = \"1.03 mm\"");
    assert!(text.contains("write 1.03;"), "{text}");
}

#[test]
fn what_is_said_later_finds_the_key_in_another_unit() -> Outcome {
    let file = parse("strip.toml", IN_OTHER_UNITS, &[]).map_err(|refused| refused.text(false))?;
    let said = file.error_at("contact.0.gap_m", "too wide", "here", &[]).text(false);
    assert!(said.contains("gap_mm = 1.03"), "{said}");
    assert_eq!(file.document.in_schema_unit("contact.0.gap_m", 1.03), 1.03e-3);
    assert_eq!(file.document.in_written_unit("response.0.levels_m_s2.1", 19.6133), 2.0);
    Ok(())
}

#[test]
fn the_width_of_figures_and_virtual_tests_have_other_units_too() -> Outcome {
    let wide = scene(BEAM, &["output.figure_width_cm=9"])?;
    assert_eq!(wide.files.figure_width_mm, Some(90.0));
    let test = include_str!("../../../../configs/virtual_test.toml");
    let in_kilohertz = ["virtual_test.sample_rate_khz=10".to_owned(), "virtual_test.noise.force_n=0.1".to_owned()];
    let test = parse_test("test.toml", test, &in_kilohertz).map_err(|refused| refused.text(false))?;
    assert_eq!(test.scene.sample_rate, 10e3);
    Ok(())
}

#[test]
fn the_only_response_goes_by_its_number_and_without_whether_it_is_a_table_or_a_list() {
    let scene = |heading: &str| {
        format!(
            "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 4\nstart = \"clamped\"\n\
             material = {{ youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n\
             [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-3\n\
             [damping]\nratio = 0.02\n[[force]]\nat_m = 1.0\ndirection = \"axial\"\n\
             {heading}\nkind = \"frequency\"\nfrequency_hz = [1000.0, 2200.0]\nlevels_n = [2000.0, 3000.0]\n\
             [method]\nharmonics = 3\n"
        )
    };
    for heading in ["[response]", "[[response]]"] {
        for key in ["response.levels_n.1", "response.0.levels_n.1"] {
            let read = nlmodes_scene::parse("a.toml", &scene(heading), &[format!("{key}=2500.0")]);
            let read = read.map_err(|refused| refused.text(false)).unwrap();
            assert_eq!(read.scene.responses[0].levels, [2000.0, 2500.0], "{heading} {key}");
        }
    }
    let two = scene("[[response]]") + "[[response]]\nkind = \"damped-mode\"\n";
    let refused = nlmodes_scene::parse("a.toml", &two, &["response.levels_n.1=2500.0".to_owned()]).unwrap_err();
    assert!(refused.text(false).contains("`response` has no item `levels_n`"), "{}", refused.text(false));
}
