//! Which values of a scene can be dragged, and how far.

use nlmodes_scene::SceneFile;
use serde_json::{Value, json};

/// How a slider goes from one end to the other.
#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Linear,
    Logarithmic,
    Whole,
    /// One of these values.
    Choice(Vec<f64>),
}

/// A value of the scene that can be dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct Slider {
    /// Its key, as `--set` takes it.
    pub key: String,
    label: String,
    unit: &'static str,
    kind: Kind,
    ends: [f64; 2],
    value: f64,
}

impl Slider {
    /// For the script of the page.
    pub fn json(&self) -> Value {
        let (kind, choices) = match &self.kind {
            Kind::Linear => ("linear", Value::Null),
            Kind::Logarithmic => ("log", Value::Null),
            Kind::Whole => ("whole", Value::Null),
            Kind::Choice(values) => ("choice", json!(values)),
        };
        let [from, to] = self.ends;
        json!({
            "key": self.key, "label": self.label, "unit": self.unit,
            "kind": kind, "choices": choices, "from": from, "to": to,
            "value": self.value,
        })
    }
}

/// Numbers of the laws of springs and dampers.
const LAWS: [(&str, &str, &str); 8] = [
    ("polynomial.0", "linear stiffness", "N/m"),
    ("polynomial.1", "quadratic stiffness", "N/m²"),
    ("polynomial.2", "cubic stiffness", "N/m³"),
    ("power.stiffness", "stiffness", "N/mⁿ"),
    ("bilinear.stiffness_n_m", "inner stiffness", "N/m"),
    ("bilinear.beyond_n_m", "outer stiffness", "N/m"),
    ("exponential.force_n", "force", "N"),
    ("damper.coefficient", "damper", "N (s/m)ⁿ"),
];

/// The sliders of a scene: values in its file.
pub fn sliders(file: &SceneFile) -> Vec<Slider> {
    let mut found = Vec::new();
    for number in 0..file.scene.n_contact_tables() {
        let stop = |name: &str| format!("contact.{number}.{name}");
        let label = |what: &str| {
            if file.scene.n_contact_tables() > 1 { format!("{what}, stop {number}") } else { what.to_owned() }
        };
        found.extend(positive(file, &stop("gap_m"), label("gap"), "m", Kind::Linear, [0.2, 3.0]));
        found.extend(positive(
            file,
            &stop("stiffness_n_m"),
            label("contact stiffness"),
            "N/m",
            Kind::Logarithmic,
            [1e-2, 1e2],
        ));
        let hertz = stop("stiffness_hertz_n_m15");
        found.extend(positive(file, &hertz, label("contact stiffness"), "N/mⁿ", Kind::Logarithmic, [1e-2, 1e2]));
        found.extend(place(file, &stop("at_m"), label("place")));
    }
    for number in 0..file.scene.springs.len() {
        for (name, label, unit) in LAWS {
            let (key, label) = (format!("spring.{number}.law.{name}"), format!("{label}, spring {number}"));
            found.extend(positive(file, &key, label, unit, Kind::Logarithmic, [1e-2, 1e2]));
        }
    }
    let plain = [
        ("method.contact_stiffness_n_m", "contact stiffness", "N/m", Kind::Logarithmic, [1e-2, 1e2]),
        ("structure.material.youngs_modulus_pa", "Young's modulus", "Pa", Kind::Logarithmic, [0.3, 3.0]),
        ("structure.material.density_kg_m3", "density", "kg/m³", Kind::Logarithmic, [0.3, 3.0]),
        ("structure.section.height_m", "height of the section", "m", Kind::Linear, [0.3, 3.0]),
    ];
    for (key, label, unit, kind, factors) in plain {
        found.extend(positive(file, key, label.to_owned(), unit, kind, factors));
    }
    // Without responses nothing is damped or driven.
    if !file.scene.responses.is_empty() {
        found.extend(loads(file));
    }
    found.extend(whole(file, "method.harmonics", "harmonics", 20.0));
    found.extend(whole(file, "method.mode", "mode", 6.0));
    found
}

/// Damping and what drives the structure.
fn loads(file: &SceneFile) -> Vec<Slider> {
    let mut keys = vec![
        ("damping.ratio".to_owned(), "damping ratio".to_owned(), ""),
        ("damping.ratios.0".to_owned(), "damping ratio of mode 1".to_owned(), ""),
        ("base_motion.acceleration_m_s2".to_owned(), "acceleration of the base".to_owned(), "m/s²"),
    ];
    let levels = file.scene.responses.first().map_or(0, |response| response.levels.len());
    let level = |what: &str, k: usize| if levels > 1 { format!("{what}, level {}", k + 1) } else { what.to_owned() };
    for k in 0..levels {
        keys.push((format!("response.0.levels_n.{k}"), level("force", k), "N"));
        keys.push((format!("response.0.levels_m_s2.{k}"), level("acceleration of the base", k), "m/s²"));
    }
    let forces = file.scene.forces.len();
    let name = |k: usize| if forces > 1 { format!("force {k}") } else { "force".to_owned() };
    // Levels are those of the first force.
    let first = usize::from(levels > 0 && written(file, "response.0.levels_n.0").is_some());
    keys.extend((first..forces).map(|k| (format!("force.{k}.amplitude_n"), name(k), "N")));
    let slider = |(key, label, unit): (String, String, &'static str)| {
        positive(file, &key, label, unit, Kind::Logarithmic, [0.2, 5.0])
    };
    keys.into_iter().filter_map(slider).collect()
}

/// The number of a key.
fn written(file: &SceneFile, key: &str) -> Option<f64> {
    let place = file.document.place(key)?;
    let (source, range) = file.document.sources().locate(&place.value);
    // What the command line has set is not the scene's to drag.
    if source.name != file.document.sources().file().name {
        return None;
    }
    let written = source.text.get(range)?.trim().replace('_', "").parse::<f64>().ok()?;
    Some(file.document.in_schema_unit(key, written)).filter(|value| value.is_finite())
}

fn positive(
    file: &SceneFile,
    key: &str,
    label: String,
    unit: &'static str,
    kind: Kind,
    [low, high]: [f64; 2],
) -> Option<Slider> {
    let value = written(file, key).filter(|value| *value > 0.0)?;
    Some(Slider { key: key.to_owned(), label, unit, kind, ends: [low * value, high * value], value })
}

fn whole(file: &SceneFile, key: &str, label: &str, high: f64) -> Option<Slider> {
    let value = written(file, key).filter(|value| *value >= 1.0)?;
    let ends = [1.0, high.max(2.0 * value)];
    Some(Slider { key: key.to_owned(), label: label.to_owned(), unit: "", kind: Kind::Whole, ends, value })
}

/// Nodes of a uniform mesh at which a stop may be; none for other meshes.
fn place(file: &SceneFile, key: &str, label: String) -> Option<Slider> {
    let structure = file.scene.structure.straight().filter(|structure| structure.grading == 1.0)?;
    let value = written(file, key)?;
    let n = structure.elements;
    let nodes: Vec<f64> = (1..=n).map(|k| structure.length * k as f64 / n as f64).collect();
    let near = nodes.iter().copied().find(|at| (at - value).abs() < 1e-9 * structure.length)?;
    let ends = [nodes[0], structure.length];
    Some(Slider { key: key.to_owned(), label, unit: "m", kind: Kind::Choice(nodes), ends, value: near })
}
