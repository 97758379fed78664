//! The printed JSON schema, judged by a library that knows nothing of this program.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use boon::{Compiler, SchemaIndex, Schemas};
use nlmodes_scene::whole_schema;
use serde_json::Value;

type Outcome = Result<(), Box<dyn Error>>;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn compiled(schema: Value) -> Result<(Schemas, SchemaIndex), Box<dyn Error>> {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("scene.json", schema)?;
    let index = compiler.compile("scene.json", &mut schemas)?;
    Ok((schemas, index))
}

/// The TOML files of a folder.
fn scenes_of(folder: &str) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut scenes = Vec::new();
    for entry in fs::read_dir(Path::new(ROOT).join(folder))? {
        scenes.push(entry?.path());
    }
    scenes.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    scenes.sort();
    Ok(scenes)
}

#[test]
fn every_shipped_scene_and_template_conforms_to_the_printed_schema() -> Outcome {
    let (schemas, index) = compiled(whole_schema())?;
    let mut count = 0;
    for folder in ["configs", "configs/structures", "crates/nlmodes-cli/src/new"] {
        for path in scenes_of(folder)? {
            let scene: Value = toml::from_str(&fs::read_to_string(&path)?)?;
            let is_study = scene.get("vary").is_some();
            let found = schemas.validate(&scene, index);
            assert_eq!(
                found.is_err(),
                is_study,
                "{}: {:#}",
                path.display(),
                found.err().map(|e| e.to_string()).unwrap_or_default()
            );
            count += usize::from(!is_study);
        }
    }
    assert!(count >= 20, "{count} scenes");
    Ok(())
}

#[test]
fn scenes_that_do_not_conform_are_refused_by_the_printed_schema() -> Outcome {
    let (schemas, index) = compiled(whole_schema())?;
    for name in [
        "unknown_key",
        "unheard_of_table",
        "negative_length",
        "missing_tables",
        "missing_keys",
        "text_for_a_number",
        "value_not_permitted",
        "decimals_for_a_whole_number",
        "too_few_and_too_many_elements",
        "records_unknown_keys",
        "test_unknown_keys",
        "response_of_an_unknown_kind",
        "window_with_one_limit",
    ] {
        let path = Path::new(ROOT).join(format!("crates/nlmodes-cli/tests/bad_scenes/{name}.toml"));
        let scene: Value = toml::from_str(&fs::read_to_string(path)?)?;
        assert!(schemas.validate(&scene, index).is_err(), "{name}");
    }
    Ok(())
}

#[test]
fn both_ways_to_write_a_direction_and_one_or_two_brackets_conform() -> Outcome {
    let (schemas, index) = compiled(whole_schema())?;
    let rod = fs::read_to_string(Path::new(ROOT).join("configs/rod.toml"))?;
    let scene = |more: &str| toml::from_str::<Value>(&format!("{rod}\n{more}\n"));
    let wanted = [
        ("[[force]]\nat_m = 1.0\ndirection = \"axial\"", true),
        ("[[force]]\nnode = 4\ndirection = [0.0, 0.0, 1.0]", true),
        ("[[force]]\nat_m = 1.0\ndirection = \"sideways\"", false),
        ("[[force]]\nnode = 4\ndirection = [0.0, 1.0]", false),
        ("[response]\nkind = \"frequency\"\nfrequency_hz = [1.0, 2.0]", true),
        ("[[response]]\nkind = \"force\"\nfrequency_hz = 1.0", true),
        ("[response]\nkind = \"loud\"", false),
    ];
    for (more, is_sound) in wanted {
        assert_eq!(schemas.validate(&scene(more)?, index).is_ok(), is_sound, "{more}");
    }
    Ok(())
}

#[test]
fn keys_in_other_units_conform_once() -> Outcome {
    let (schemas, index) = compiled(whole_schema())?;
    let rod = fs::read_to_string(Path::new(ROOT).join("configs/rod.toml"))?;
    let replaced = |from: &str, to: &str| -> Result<bool, Box<dyn Error>> {
        assert!(rod.contains(from), "{from}");
        let scene: Value = toml::from_str(&rod.replace(from, to))?;
        let found = schemas.validate(&scene, index);
        Ok(found.inspect_err(|error| println!("{from} → {to}: {error:#}")).is_ok())
    };
    assert!(replaced("length_m =", "length_mm =")? && replaced("gap_m =", "gap_um =")?);
    assert!(!replaced("gap_m =", "gap_mm = 1.0\ngap_m =")? && !replaced("gap_m =", "gap_kg =")?);
    assert!(!replaced("length_m =", "length_mm = -1.0 #")?);
    Ok(())
}
