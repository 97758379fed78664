//! Output of a run on the terminal.

use std::collections::HashSet;
use std::path::Path;

use nlmodes_run::linear::modal_model;
use nlmodes_run::virtual_test::in_words;
use nlmodes_run::{Event, Observer, updating};

use crate::options::RunOptions;
use crate::progress::Shown;
use crate::terminal::print;
use crate::{Status, interrupt, modes, told};

/// Prints the events of a run at the requested verbosity, and asks it to end at Ctrl-C.
pub struct TerminalObserver {
    options: RunOptions,
    progress: Option<Shown>,
    /// Several parts of a scene often have the same warnings.
    warned: HashSet<String>,
    /// Whether something could not be written to standard output, or ended early.
    pub status: Status,
}

impl TerminalObserver {
    /// Nothing has happened yet.
    pub fn new(options: RunOptions) -> Self {
        Self { options, progress: None, warned: HashSet::new(), status: Status::Done }
    }

    /// Prints how branches differ, unless quiet.
    pub fn compared(&mut self, lines: &[String]) {
        if !self.options.quiet && !lines.is_empty() {
            self.print(&lines.join("\n"));
        }
    }

    fn print(&mut self, text: &str) {
        self.note(print(text));
    }

    fn note(&mut self, status: Status) {
        if status != Status::Done {
            self.status = status;
        }
    }
}

impl Observer for TerminalObserver {
    fn event(&mut self, event: Event<'_>) {
        let quiet = self.options.quiet;
        match event {
            Event::Abandoned { directory, points } => say!(
                "warning: {} holds an interrupted run of this scene, {points} points, which is computed anew; with \
                 `--resume` it goes on",
                directory.display()
            ),
            Event::Replaces { directory, certificates, drawn } => replaces(directory, certificates, drawn),
            Event::Updating { number, of, scene } if !quiet => self.note(modes::say_method(scene, number, of)),
            Event::Updated(done) if !quiet => {
                if let Some(text) = updating::in_words(done) {
                    self.print(&format!("{text}\n"));
                }
            }
            Event::Part { number, of, folder } if !quiet => {
                say!("part {} of {of}: {}", number + 1, folder.display());
            }
            Event::Begun(scene) => {
                interrupt::nothing_found_yet();
                if let Some(text) = scene.structure.straight().and_then(modal_model).filter(|_| !quiet) {
                    _ = print(&text);
                }
                self.progress = Some(Shown::new(self.options, scene));
            }
            Event::Warning(text) if self.warned.insert(text.to_owned()) => say!("warning: {text}\n"),
            Event::NothingToResume { directory } if !quiet => {
                say!("{} holds no interrupted run: computed from the beginning", directory.display());
            }
            Event::Done(part) => {
                interrupt::something_found();
                self.note(told::part(part, quiet));
                self.compared(&part.compared);
                if !quiet {
                    self.print(part.certificates_text().trim_end());
                }
            }
            Event::TestBeginsAnew if !quiet => {
                say!("a virtual test begins anew: each level goes on from the motion at the end of the one before");
            }
            Event::Rig(text) if !quiet => say!("{text}"),
            Event::Level { scene, number, level } if !quiet => say!("{}", in_words(scene, number, level)),
            Event::Point { branch, point, is_new } => {
                interrupt::something_found();
                self.progress.iter_mut().for_each(|progress| progress.point(branch, point, is_new));
            }
            Event::Curve { number, of, name } if !quiet => say!("curve {number} of {of}: {name}"),
            Event::CurveDone { name, is_further, outcome, is_complete } => {
                interrupt::something_found();
                match outcome {
                    Ok((points, why)) if !is_complete => say!("warning: {name}: {points} points, then {why}"),
                    Ok((points, why)) if !quiet && is_further => say!("  {name}: {points} points; {why}"),
                    Ok((points, why)) if !quiet => say!("  {points} points; {why}"),
                    Ok(_) => {}
                    Err(why) => say!("error: {name}: {why}"),
                }
            }
            Event::Withdrawn { kept } => self.progress.iter_mut().for_each(|progress| progress.withdrawn(kept)),
            Event::Turned { points } => self.progress.iter_mut().for_each(|progress| progress.turned(points)),
            Event::Looking { check, point, number } => {
                self.progress.iter().for_each(|progress| progress.looking(check, point, number));
            }
            Event::Computed => self.progress.iter().for_each(Shown::finish),
            _ => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        interrupt::requested()
    }

    fn certifies(&self) -> bool {
        self.options.certify
    }

    fn watch(&self) -> nlmodes::branches::Watch {
        match &self.progress {
            Some(progress) => progress.watch(interrupt::requested),
            None => nlmodes::branches::Watch::until(interrupt::requested),
        }
    }
}

/// Warning about results of other calls before they are replaced.
fn replaces(directory: &Path, certificates: usize, drawn: usize) {
    let place = directory.display();
    if certificates > 0 {
        let those = if certificates == 1 { "the certificate" } else { "the certificates" };
        say!(
            "warning: {place}: {those} of `run --certify` will be replaced by what a plain run looks at; with \
             `--certify` all is looked at again"
        );
    }
    if drawn > 0 {
        say!(
            "warning: {place}: {drawn} figures as PDF or PNG will be removed, for the new results may differ; \
             `nlmodes-cli figures` makes them again"
        );
    }
}
