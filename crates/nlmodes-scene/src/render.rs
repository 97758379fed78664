//! Diagnostics as text: file, line, column, the line itself, and what to do.

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use crate::{Diagnostic, Mark, Severity, Sources};

/// Most diagnostics that are shown: more are those of a file that is no scene.
const MOST: usize = 40;
/// Most letters of a title or a help, which may repeat what is in the scene.
const LONGEST: usize = 400;

/// Diagnostics as text, each with the lines that it is about.
pub fn render(diagnostics: &[Diagnostic], sources: &Sources, colours: bool) -> String {
    let renderer = if colours { Renderer::styled() } else { Renderer::plain() };
    let shown = diagnostics.iter().take(MOST).map(shortened);
    let mut texts: Vec<String> = shown.map(|diagnostic| renderer.render(&[group(&diagnostic, sources)])).collect();
    if diagnostics.len() > MOST {
        texts.push(format!("… and {} more", diagnostics.len() - MOST));
    }
    texts.join("\n\n")
}

/// The diagnostic with its texts in readable lengths.
fn shortened(diagnostic: &Diagnostic) -> Diagnostic {
    let mark = |mark: &Mark| Mark { range: mark.range.clone(), label: short(&mark.label) };
    Diagnostic {
        severity: diagnostic.severity,
        title: short(&diagnostic.title),
        place: diagnostic.place.as_ref().map(mark),
        context: diagnostic.context.iter().map(mark).collect(),
        help: diagnostic.help.iter().map(|help| short(help)).collect(),
    }
}

fn short(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.to_owned(),
    }
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a Sources) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let group = level.primary_title(diagnostic.title.as_str());
    let group = match &diagnostic.place {
        Some(mark) => group.elements(snippets(mark, &diagnostic.context, sources)),
        None => group.element(Origin::path(sources.file().name.as_str())),
    };
    group.elements(diagnostic.help.iter().map(|help| Level::HELP.message(help.as_str())))
}

/// The snippet of the place itself, and of every other text that the context lies in.
fn snippets<'a>(place: &'a Mark, context: &'a [Mark], sources: &'a Sources) -> Vec<Snippet<'a, Annotation<'a>>> {
    let mut marks = vec![(place, AnnotationKind::Primary)];
    marks.extend(context.iter().map(|mark| (mark, AnnotationKind::Context)));
    let mut snippets: Vec<(usize, Snippet<'a, Annotation<'a>>)> = Vec::new();
    for (mark, kind) in marks {
        let (source, range) = sources.locate(&mark.range);
        let annotation = kind.span(range).label(mark.label.as_str());
        match snippets.iter().position(|(start, _)| *start == source.start()) {
            Some(i) => {
                let (start, snippet) = snippets.remove(i);
                snippets.insert(i, (start, snippet.annotation(annotation)));
            }
            None => {
                let snippet = Snippet::source(source.text.as_str()).path(source.name.as_str());
                snippets.push((source.start(), snippet.annotation(annotation)));
            }
        }
    }
    snippets.into_iter().map(|(_, snippet)| snippet).collect()
}
