//! A scene over one of its parameters.

use nlmodes_scene::{SceneFile, overrides_at, parse};

use super::{FollowError, FollowSettings};

/// A scene with its text, differentiated by the parameter.
pub struct Texts {
    name: String,
    text: String,
    overrides: Vec<String>,
    /// The scene at its own value.
    pub base: SceneFile,
    /// Number of the parameter among its sensitivities.
    pub number: usize,
}

impl Texts {
    /// Checks the scene of this name and text.
    pub fn of(
        (name, text): (&str, &str),
        overrides: &[String],
        settings: &FollowSettings,
    ) -> Result<Self, FollowError> {
        let (name, text) = (name.to_owned(), text.to_owned());
        let own = parse(&name, &text, overrides)?;
        let position = own.scene.sensitivities.iter().position(|own| own.key == settings.key);
        let text = match position {
            Some(_) => text,
            None => format!("{text}\n[[sensitivity]]\nkey = {:?}\n", settings.key),
        };
        let base = parse(&name, &text, overrides)?;
        let number = position.unwrap_or(base.scene.sensitivities.len().saturating_sub(1));
        let texts = Self { name, text, overrides: overrides.to_vec(), base, number };
        let (value, [low, high]) = (texts.value(), settings.window);
        if !(low < high && (low..=high).contains(&value)) {
            return Err(FollowError::Window { key: settings.key.clone(), value, window: settings.window });
        }
        Ok(texts)
    }

    /// The value of the parameter in the scene.
    pub fn value(&self) -> f64 {
        self.base.scene.sensitivities.get(self.number).map_or(f64::NAN, |own| own.value)
    }

    /// The scene with another value.
    ///
    /// # Errors
    /// Why it is none, in words.
    pub fn at(&self, value: f64) -> Result<SceneFile, String> {
        if value == self.value() {
            return Ok(self.base.clone());
        }
        let more = overrides_at(&self.base, self.number, value);
        let all: Vec<String> = self.overrides.iter().cloned().chain(more).collect();
        parse(&self.name, &self.text, &all).map_err(|refused| {
            let reasons: Vec<String> = refused.diagnostics().iter().map(nlmodes_scene::Diagnostic::sentence).collect();
            reasons.join("; ")
        })
    }
}
