//! Keys of a scene as it was read, by the names under which they are written.

use nlmodes_scene::Document;

/// Tables of which a scene may have several, by the name of the list that holds them.
const LISTS: [(&str, &str); 4] =
    [("contacts", "contact"), ("forces", "force"), ("responses", "response"), ("structures", "structure")];

/// A key of the scene as it was read, `contacts.0.gap`, by the name under which it is written: `contact.0.gap_m`.
pub fn written_key(key: &str, document: &Document) -> String {
    let (list, rest) = key.split_once('.').unwrap_or((key, ""));
    let table = LISTS.iter().find(|(name, _)| *name == list).map_or(list, |(_, table)| table);
    let name = rest.rsplit('.').next().unwrap_or_default();
    let item = rest.split('.').next().filter(|part| part.parse::<usize>().is_ok());
    // The name is followed by its unit, and there may be tables in between.
    let is_meant = |written: &&str| {
        let mut parts = written.split('.');
        let last = written.rsplit('.').next().unwrap_or_default();
        let of_name = last.strip_prefix(name).is_some_and(|unit| unit.is_empty() || unit.starts_with('_'));
        parts.next() == Some(table) && (item.is_none() || parts.next() == item) && of_name
    };
    let mut meant = document.keys().filter(is_meant);
    match (meant.next(), meant.next()) {
        (Some(one), None) if !name.is_empty() => one.to_owned(),
        _ if rest.is_empty() => table.to_owned(),
        _ => format!("{table}.{rest}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_of_another_scene_are_named_as_they_are_written() {
        let text = "[structure]\nlength_m = 1\nmaterial = { youngs_modulus_pa = 1 }\n[[contact]]\ngap_m = \
            1\n[[contact]]\ngap_m = 2\nat_m = 1\n";
        let refused = nlmodes_scene::parse("a.toml", text, &[]).unwrap_err();
        for (key, written) in [
            ("contacts.1.gap", "contact.1.gap_m"),
            ("contacts.0.at", "contact.0.at"),
            ("contacts.0.gap", "contact.0.gap_m"),
            ("structure.length", "structure.length_m"),
            ("structure.youngs_modulus", "structure.material.youngs_modulus_pa"),
            ("contacts", "contact"),
            ("method.harmonics", "method.harmonics"),
            ("the scene", "the scene"),
        ] {
            assert_eq!(written_key(key, refused.document()), written);
        }
    }
}
