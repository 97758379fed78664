//! Linear frequencies as a table.

use nlmodes_scene::percent;
use nlmodes_scene::scene::Scene;

use super::{LinearFrequencies, modal_model};

/// Least width of a column.
const WIDTH: usize = 22;

impl LinearFrequencies {
    /// The frequencies as a table, below the title of the scene and what its structure is.
    pub fn table(&self, scene: &Scene) -> String {
        let rule = scene.method.mass_redistribution.name();
        let redistributed = format!("contact mass: {rule}");
        let columns = self.columns(&redistributed);
        let modal =
            scene.structure.straight().and_then(modal_model).map_or_else(String::new, |text| format!("\n{text}"));
        let mut text = format!("{}{modal}\n\nfrequency, Hz\n  mode", scene.title);
        let width = |name: &str| WIDTH.max(name.len() + 2);
        columns.iter().for_each(|(name, _)| text += &format!("{name:>0$}", width(name)));
        if !self.left_open.is_empty() {
            text += &format!("{:>WIDTH$}", "left open by digits");
        }
        text += if self.characters.is_empty() { "\n" } else { "  what it is\n" };
        for k in 0..columns.iter().map(|(_, f)| f.len()).max().unwrap_or(0) {
            text += &format!("  {:>4}", k + 1);
            for (name, frequencies) in &columns {
                // In the row of the same mode, whatever the order of its frequency.
                let same =
                    if *name == redistributed { self.redistributed_as.get(k).copied().flatten() } else { Some(k) };
                let frequency = same.and_then(|k| frequencies.get(k));
                let (frequency, width) = (frequency.map_or_else(|| "-".to_owned(), |f| format!("{f:.8}")), width(name));
                text += &format!("{frequency:>width$}");
            }
            if let Some(share) = self.left_open.get(k) {
                text += &format!(
                    "{:>WIDTH$}",
                    share.map_or_else(|| "-".to_owned(), |share| format!("±{}", percent(share)))
                );
            }
            let character = self.characters.get(k).filter(|words| !words.is_empty());
            text += &character.map_or_else(String::new, |words| format!("  {words}"));
            text += "\n";
        }
        text
    }
}
