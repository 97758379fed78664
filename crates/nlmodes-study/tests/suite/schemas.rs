//! The printed JSON schema of studies, judged by a library that knows nothing of this program.

use std::error::Error;
use std::fs;
use std::path::Path;

use boon::{Compiler, Schemas};
use serde_json::Value;

#[test]
fn shipped_studies_conform_to_the_printed_schema_and_scenes_do_not() -> Result<(), Box<dyn Error>> {
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("study.json", nlmodes_study::schema())?;
    let index = compiler.compile("study.json", &mut schemas)?;
    let configs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../configs"));
    for (name, is_study) in
        [("gap_study.toml", true), ("studies/fit.toml", true), ("studies/fit_backbone.toml", true), ("rod.toml", false)]
    {
        let file: Value = toml::from_str(&fs::read_to_string(configs.join(name))?)?;
        let found = schemas.validate(&file, index);
        assert_eq!(found.is_ok(), is_study, "{name}: {:?}", found.err().map(|error| error.to_string()));
    }
    Ok(())
}
