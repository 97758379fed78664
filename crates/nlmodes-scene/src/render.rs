//! Problems as text: file, line, column, the line itself, and what to do.

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use crate::{Mark, Problem, Severity, Sources};

/// Most problems that are shown: more are those of a file that is no scene.
const MOST: usize = 40;
/// Most letters of a title or a help, which may repeat what stands in the scene.
const LONGEST: usize = 400;

/// Problems as text, each with the lines that it is about.
pub fn render(problems: &[Problem], sources: &Sources, colours: bool) -> String {
    let renderer = if colours { Renderer::styled() } else { Renderer::plain() };
    let shown = problems.iter().take(MOST).map(shortened);
    let mut texts: Vec<String> = shown.map(|problem| renderer.render(&[group(&problem, sources)])).collect();
    if problems.len() > MOST {
        texts.push(format!("… and {} more", problems.len() - MOST));
    }
    texts.join("\n\n")
}

/// The problem with its texts in readable lengths.
fn shortened(problem: &Problem) -> Problem {
    let mark = |mark: &Mark| Mark { range: mark.range.clone(), label: short(&mark.label) };
    Problem {
        severity: problem.severity,
        title: short(&problem.title),
        place: problem.place.as_ref().map(mark),
        context: problem.context.iter().map(mark).collect(),
        help: problem.help.iter().map(|help| short(help)).collect(),
    }
}

fn short(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.to_owned(),
    }
}

fn group<'a>(problem: &'a Problem, sources: &'a Sources) -> Group<'a> {
    let level = match problem.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let group = level.primary_title(problem.title.as_str());
    let group = match &problem.place {
        Some(mark) => group.elements(snippets(mark, &problem.context, sources)),
        None => group.element(Origin::path(sources.file().name.as_str())),
    };
    group.elements(problem.help.iter().map(|help| Level::HELP.message(help.as_str())))
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
