//! The sections of a report in the frame of a page.

use super::data::Data;
use super::frame::Page;
use super::sections::Section;

const SCRIPT: &str = concat!(
    include_str!("page/element.js"),
    include_str!("page/packed.js"),
    include_str!("page/scale.js"),
    include_str!("page/symbol.js"),
    include_str!("page/smooth.js"),
    include_str!("page/names.js"),
    include_str!("page/save.js"),
    include_str!("page/chart.js"),
    include_str!("page/columns.js"),
    include_str!("page/branches.js"),
    include_str!("page/lay.js"),
    include_str!("page/participation.js"),
    include_str!("page/histories.js"),
    include_str!("page/player.js"),
    include_str!("page/motion.js"),
    include_str!("page/wire.js"),
    include_str!("page/start.js"),
    include_str!("page/rows.js"),
);

pub(super) fn page(title: &str, sections: &[Section], data: &Data) -> String {
    let (head, body): (Vec<&Section>, Vec<&Section>) = sections.iter().partition(|section| section.title.is_empty());
    let overview: String = head.iter().map(|section| section.html.as_str()).collect();
    let links: String = body.iter().map(|s| format!("<a href=\"#{}\">{}</a>", s.id, s.title)).collect();
    let body: String =
        body.iter().map(|s| format!("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", s.id, s.title, s.html)).collect();
    let head = format!("{overview}<nav aria-label=\"Sections\">{links}</nav>\n");
    Page { title, head: &head, body: &body, style: "", script: SCRIPT, data: &data.json() }.render()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_script_cannot_end_its_element() {
        assert!(!SCRIPT.contains("</") && !SCRIPT.contains("<!--"));
    }

    #[test]
    fn no_name_of_the_script_is_declared_twice() {
        // One that is makes the whole script an error of syntax, and leaves the page without life.
        let names = SCRIPT.lines().filter_map(|line| {
            let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let kind = words.find(|word| *word != "async")?;
            ["const", "let", "class", "function"].contains(&kind).then(|| words.next())?
        });
        let mut names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
        names.sort_unstable();
        assert!(names.len() > 50 && names.contains(&"largest") && names.contains(&"begin"));
        let twice: Vec<&[&str]> = names.windows(2).filter(|pair| pair[0] == pair[1]).collect();
        assert!(twice.is_empty(), "{twice:?}");
    }
}
