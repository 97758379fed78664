//! What is answered to whom.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use super::computing::Computing;
use super::save;
use super::sliders::{Slider, sliders};
use crate::RunError;
use nlmodes::branches::Watch;
use nlmodes::report::explore;
use nlmodes_scene::assemble::Structures;
use nlmodes_scene::{SceneFile, memory};
use serde_json::{Value, json};

/// Bytes of the token.
const TOKEN: usize = 16;

/// A request, taken apart.
#[derive(Debug, Default, Clone)]
pub struct Asked {
    /// Whether it is a POST request.
    pub is_post: bool,
    /// Whether it is a GET request.
    pub is_get: bool,
    /// Path of the address, as it was sent.
    pub path: String,
    /// Header `Host`.
    pub host: Option<String>,
    /// Header `Origin`.
    pub origin: Option<String>,
    /// The body, unless it is too long or no text.
    pub body: Option<String>,
}

/// What is sent back.
#[derive(Debug)]
pub struct Answer {
    /// HTTP status.
    pub status: u16,
    /// Media type.
    pub kind: &'static str,
    /// Content.
    pub text: String,
}

impl Answer {
    fn ok(kind: &'static str, text: impl Into<String>) -> Self {
        Self { status: 200, kind, text: text.into() }
    }

    fn wrong(status: u16, why: &str) -> Self {
        Self { status, kind: "application/json", text: json!({ "error": why }).to_string() }
    }
}

/// A scene that is explored.
pub struct Explorer {
    path: PathBuf,
    text: String,
    overrides: Vec<String>,
    title: String,
    sliders: Vec<Slider>,
    token: String,
    port: u16,
    computing: Computing,
    /// What is known of the files of the structure.
    structures: Structures,
}

impl Explorer {
    /// For the scene with this text, whose first method is `file`, on this port.
    ///
    /// # Errors
    /// If the system gives no random number.
    pub fn new(path: &Path, text: String, overrides: Vec<String>, file: &SceneFile, port: u16) -> io::Result<Self> {
        let mut bytes = [0; TOKEN];
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        Ok(Self {
            path: path.to_path_buf(),
            text,
            overrides,
            title: file.scene.title.clone(),
            sliders: sliders(file),
            token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(),
            port,
            computing: Computing::default(),
            structures: Structures::default(),
        })
    }

    /// The address of the page, which has the token.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Answers a request. Nobody without the token gets more than a refusal, and no page of another origin either.
    pub fn answer(&self, asked: &Asked) -> Answer {
        if !self.is_here(asked.host.as_deref()) || asked.origin.as_deref().is_some_and(|origin| !self.is_own(origin)) {
            return Answer::wrong(403, "this page answers to itself only");
        }
        let within = asked.path.strip_prefix('/').and_then(|path| path.split_once('/'));
        let Some(name) = within.filter(|(token, _)| is_same(token, &self.token)).map(|(_, name)| name) else {
            return Answer::wrong(403, "the address lacks its token");
        };
        match name {
            "" if asked.is_get => Answer::ok("text/html; charset=utf-8", self.page()),
            "explore.js" if asked.is_get => Answer::ok("text/javascript; charset=utf-8", explore::SCRIPT),
            "explore.css" if asked.is_get => Answer::ok("text/css; charset=utf-8", explore::STYLE),
            "compute" if asked.is_post => self.with_values(asked, |values| self.compute(values)),
            "effects" if asked.is_post => self.with_values(asked, |values| self.effects(values)),
            "save" if asked.is_post => self.with_values(asked, |values| self.save(values)),
            _ => Answer::wrong(404, "there is nothing of that name"),
        }
    }

    fn is_here(&self, host: Option<&str>) -> bool {
        host.is_some_and(|host| {
            [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)].contains(&host.to_owned())
        })
    }

    fn is_own(&self, origin: &str) -> bool {
        origin.strip_prefix("http://").is_some_and(|host| self.is_here(Some(host)))
    }

    fn page(&self) -> String {
        let list = self.sliders.iter().map(Slider::json).collect();
        explore::page(&self.title, &Value::Array(list))
    }

    /// The values of the body, if all of them are of sliders and finite.
    fn with_values(&self, asked: &Asked, then: impl FnOnce(&BTreeMap<String, f64>) -> Answer) -> Answer {
        let values = asked.body.as_deref().and_then(|body| serde_json::from_str::<BTreeMap<String, f64>>(body).ok());
        let Some(values) = values else { return Answer::wrong(400, "the values cannot be read") };
        let is_known = |key: &String| self.sliders.iter().any(|slider| slider.key == *key);
        match values.iter().find(|(key, value)| !is_known(key) || !value.is_finite()) {
            Some((key, _)) => {
                Answer::wrong(400, &format!("`{key}` is no slider of this scene, or its value no number"))
            }
            None => then(&values),
        }
    }

    /// The scene with these values, checked.
    fn scene(&self, values: &BTreeMap<String, f64>) -> Result<SceneFile, String> {
        self.scene_of(&self.text, values)
    }

    /// The same, differentiated by the values of all sliders by which it can be.
    fn differentiated(&self, values: &BTreeMap<String, f64>) -> Result<SceneFile, String> {
        let mut text = self.text.clone();
        let mut found = self.scene_of(&text, values)?;
        for slider in &self.sliders {
            if found.scene.sensitivities.iter().any(|own| own.key == slider.key) {
                continue;
            }
            let longer = format!("{text}\n[[sensitivity]]\nkey = {:?}\n", slider.key);
            // A place at an end, or a number of harmonics, has no gradient.
            if let Ok(file) = self.scene_of(&longer, values) {
                (text, found) = (longer, file);
            }
        }
        Ok(found)
    }

    fn scene_of(&self, text: &str, values: &BTreeMap<String, f64>) -> Result<SceneFile, String> {
        let own = values.iter().map(|(key, value)| format!("{key}={}", save::number(*value)));
        let overrides: Vec<String> = self.overrides.iter().cloned().chain(own).collect();
        let name = self.path.display().to_string();
        let files = nlmodes_scene::parse_each_method(&name, text, &overrides);
        let mut files = files.map_err(|refused| refused.text(false))?;
        memory::admit(&mut files, None).map_err(|refused| refused.text(false))?;
        files.into_iter().next().ok_or_else(|| "there is no scene".to_owned())
    }

    fn compute(&self, values: &BTreeMap<String, f64>) -> Answer {
        let file = match self.scene(values) {
            Ok(file) => file,
            Err(why) => return Answer::wrong(422, &why),
        };
        self.newest(|watch| super::picture(&file, watch, &self.structures))
    }

    /// What this computation gives, unless a later change ends it.
    fn newest(&self, compute: impl FnOnce(Watch) -> Result<String, RunError>) -> Answer {
        match self.computing.newest(compute) {
            Some(Ok(found)) => Answer::ok("application/json", found),
            None | Some(Err(RunError::Ended)) => Answer::wrong(409, "superseded by a later change"),
            Some(Err(error)) => Answer::wrong(422, &error.to_string()),
        }
    }

    fn effects(&self, values: &BTreeMap<String, f64>) -> Answer {
        let file = match self.differentiated(values) {
            Ok(file) if file.scene.responses.is_empty() => return Answer::ok("application/json", "[]"),
            Ok(file) => file,
            Err(why) => return Answer::wrong(422, &why),
        };
        self.newest(|watch| crate::responses::effects(&file, &watch, &self.structures))
    }

    fn save(&self, values: &BTreeMap<String, f64>) -> Answer {
        let saved = self.scene(values).and_then(|_| save::save(&self.path, &self.text, values));
        match saved {
            Ok(path) => Answer::ok("application/json", json!({ "path": path.display().to_string() }).to_string()),
            Err(why) => Answer::wrong(422, &why),
        }
    }
}

/// Constant-time comparison of two texts.
fn is_same(found: &str, wanted: &str) -> bool {
    found.len() == wanted.len()
        && found.bytes().zip(wanted.bytes()).fold(0, |different, (a, b)| different | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 4\nstart = \"clamped\"\n\
        material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }\nsection = { area_m2 = 1e-4 }\n\
        [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-3 # the clearance\n\
        [method]\nharmonics = 3\n[continuation]\nmax_energy_ratio = 3.0\n";

    fn explorer(path: &Path) -> Explorer {
        let files = nlmodes_scene::parse_each_method("rod.toml", SCENE, &[]).unwrap();
        Explorer::new(path, SCENE.to_owned(), Vec::new(), &files[0], 4711).unwrap()
    }

    fn asked(explorer: &Explorer, name: &str, body: Option<&str>) -> Asked {
        Asked {
            is_post: body.is_some(),
            is_get: body.is_none(),
            path: format!("/{}/{name}", explorer.token),
            host: Some("127.0.0.1:4711".into()),
            origin: None,
            body: body.map(str::to_owned),
        }
    }

    #[test]
    fn strangers_are_refused() {
        let explorer = explorer(Path::new("rod.toml"));
        let right = asked(&explorer, "", None);
        assert_eq!(explorer.answer(&right).status, 200);
        let wrong: [(&str, Asked, u16); 8] = [
            ("no token", Asked { path: "/".into(), ..right.clone() }, 403),
            ("another token", Asked { path: format!("/{}/", "0".repeat(32)), ..right.clone() }, 403),
            ("a part of the token", Asked { path: format!("/{}/", &explorer.token[..31]), ..right.clone() }, 403),
            ("another origin", Asked { origin: Some("http://example.org".into()), ..right.clone() }, 403),
            ("another name of this machine", Asked { host: Some("example.org:4711".into()), ..right.clone() }, 403),
            ("no name", Asked { host: None, ..right.clone() }, 403),
            ("a path that climbs", asked(&explorer, "../rod.toml", None), 404),
            ("a body that is none", asked(&explorer, "compute", Some("[")), 400),
        ];
        for (what, asked, status) in wrong {
            let answer = explorer.answer(&asked);
            assert_eq!(answer.status, status, "{what}");
            assert!(!answer.text.contains(&explorer.token), "{what}");
        }
        let unknown = asked(&explorer, "compute", Some("{\"output.directory\": 1}"));
        assert_eq!(explorer.answer(&unknown).status, 400);
        // Its own pages send their origin with what they post.
        let own = Asked { origin: Some("http://127.0.0.1:4711".into()), ..asked(&explorer, "compute", Some("{}")) };
        assert_eq!(explorer.answer(&own).status, 200);
    }

    #[test]
    fn a_slider_moves_the_branch_and_a_mistake_is_told() {
        let explorer = explorer(Path::new("rod.toml"));
        let energy = |gap: f64| {
            let body = format!("{{\"contact.0.gap_m\": {gap:e}}}");
            let answer = explorer.answer(&asked(&explorer, "compute", Some(&body)));
            assert_eq!(answer.status, 200, "{}", answer.text);
            let data: Value = serde_json::from_str(&answer.text).unwrap();
            data["branches"][0]["energy"][0].as_f64().unwrap()
        };
        // Grazing: the energy goes with the square of the gap.
        assert!((energy(2e-3) / energy(1e-3) - 4.0).abs() < 1e-8);
        let answer = explorer.answer(&asked(&explorer, "compute", Some("{\"method.harmonics\": 0}")));
        assert!(answer.status == 422 && answer.text.contains("method.harmonics"), "{}", answer.text);
    }

    #[test]
    fn a_response_has_peak_and_jumps_with_what_each_slider_does_to_them() {
        let scene = SCENE.replace(
            "[method]",
            "stiffness_n_m = 3e7\n[damping]\nratio = 0.02\n[[force]]\nat_m = 1.0\n\
            direction = \"axial\"\n[[response]]\nkind = \"frequency\"\nfrequency_hz = [1000.0, 2200.0]\n\
            levels_n = [2000.0]\n[method]",
        );
        let files = nlmodes_scene::parse_each_method("rod.toml", &scene, &[]).unwrap();
        let explorer = Explorer::new(Path::new("rod.toml"), scene, Vec::new(), &files[0], 4711).unwrap();
        let of = |gap: f64| -> Vec<Value> {
            let body = format!("{{\"contact.0.gap_m\": {gap:e}}}");
            let answer = explorer.answer(&asked(&explorer, "effects", Some(&body)));
            assert_eq!(answer.status, 200, "{}", answer.text);
            let data: Value = serde_json::from_str(&answer.text).unwrap();
            data[0]["quantities"].as_array().unwrap().clone()
        };
        let (own, more) = (of(1e-3), of(1.001e-3));
        let names: Vec<&str> = own.iter().filter_map(|one| one["name"].as_str()).collect();
        assert_eq!(names, ["peak", "largest force", "jump up", "jump down"]);
        for (own, more) in own.iter().zip(&more) {
            let change = 1e3 * (more["value"].as_f64().unwrap() / own["value"].as_f64().unwrap() - 1.0);
            let effect = own["effects"]["contact.0.gap_m"].as_f64().unwrap();
            assert!((effect - change).abs() < 2e-3 * change.abs().max(0.1), "{}: {effect} {change}", own["name"]);
            for key in ["damping.ratio", "response.0.levels_n.0", "structure.material.youngs_modulus_pa"] {
                assert!(own["effects"][key].is_number(), "{key} {own}");
            }
        }
    }

    #[test]
    fn a_law_of_force_is_dragged_under_a_static_load_and_its_effects_are_told() {
        let scene = SCENE.replace(
            "[[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-3 # the clearance\n",
            "[[spring]]\nat_m = 1.0\ndirection = \"axial\"\nlaw = { polynomial = [0.0, 0.0, 1e13] }\n[[static_force]]\n\
            at_m = 1.0\ndirection = \"axial\"\nforce_n = 1e4\n[damping]\nratio = 0.02\n[[force]]\nat_m = 1.0\n\
            [[response]]\nkind = \"frequency\"\nfrequency_hz = [1000.0, 2200.0]\nlevels_n = [300.0]\n",
        );
        let scene = scene.replace("[continuation]\nmax_energy_ratio = 3.0\n", "");
        let files = nlmodes_scene::parse_each_method("rod.toml", &scene, &[]).unwrap();
        let explorer = Explorer::new(Path::new("rod.toml"), scene, Vec::new(), &files[0], 4711).unwrap();
        let key = "spring.0.law.polynomial.2";
        let of = |name: &str, cubic: f64| -> Value {
            let answer = explorer.answer(&asked(&explorer, name, Some(&format!("{{\"{key}\": {cubic:e}}}"))));
            assert_eq!(answer.status, 200, "{}", answer.text);
            serde_json::from_str(&answer.text).unwrap()
        };
        let picture = of("compute", 1e13);
        assert!(picture["branches"][0]["frequency"].as_array().is_some_and(|points| points.len() > 10));
        let (own, more) = (of("effects", 1e13), of("effects", 1.001e13));
        let peak = |of: &Value| of[0]["quantities"][0]["value"].as_f64().unwrap();
        let change = 1e3 * (peak(&more) / peak(&own) - 1.0);
        let effect = own[0]["quantities"][0]["effects"][key].as_f64().unwrap();
        assert!((effect - change).abs() < 2e-3 * change.abs().max(0.1), "{effect} {change}");
    }

    #[test]
    fn saving_keeps_the_text_and_writes_beside_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rod.toml");
        let explorer = explorer(&path);
        for name in ["rod-explored.toml", "rod-explored-2.toml"] {
            let answer = explorer.answer(&asked(&explorer, "save", Some("{\"contact.0.gap_m\": 2.5e-3}")));
            assert_eq!(answer.status, 200, "{}", answer.text);
            let saved = std::fs::read_to_string(folder.path().join(name)).unwrap();
            assert_eq!(saved, SCENE.replace("1e-3 # the", "0.0025 # the"));
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }
}
