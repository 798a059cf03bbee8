//! How the program ends, and how it reports what went wrong.

use crate::console;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use plaus_run::RunFileProblem;
use plaus_scenes::scenario::{Problem, ScenarioError, Source};
use std::io;

/// Largest number of problems of one scenario that are shown; the others are counted.
const SHOWN_PROBLEMS: usize = 20;

/// The result of a command that did its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Successful.
    Done,
    /// No satisfying sample, or failed diagnostics.
    Unsatisfied,
    /// Interrupted, with a checkpoint.
    Interrupted,
}

/// Why a command could not do its work.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The scenario is wrong.
    Scenario(ScenarioError),
    /// Anything else that one message can say.
    Message(String),
    /// The reader of our output has gone.
    ReaderGone,
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error)
    }
}

impl From<plaus_run::Error> for Failure {
    fn from(error: plaus_run::Error) -> Self {
        match error {
            plaus_run::Error::Output(error) => Self::of_output(error),
            plaus_run::Error::File(error) => error.into(),
            other => Self::Message(other.to_string()),
        }
    }
}

impl From<plaus_run::RunFileError> for Failure {
    fn from(error: plaus_run::RunFileError) -> Self {
        Self::Message(format!("{error}{}", advice(&error.problem)))
    }
}

/// What can be done about a problem, in words of the command line.
fn advice(problem: &RunFileProblem) -> &'static str {
    match problem {
        RunFileProblem::OutputExists => "; choose another name, or replace it by `--force`",
        RunFileProblem::Records { .. } | RunFileProblem::Checkpoint { .. } | RunFileProblem::Gone => {
            ". `plaus export --salvage` and `plaus gallery --salvage` read what is intact"
        }
        RunFileProblem::Empty => {
            ". `plaus resume` continues it; `plaus resume RUN --solutions all` one that has found what it was asked for"
        }
        RunFileProblem::OnlyWarmup { has_solutions: true, .. } => "; `--all-distinct` takes every solution",
        RunFileProblem::OnlyWarmup { .. } => "; `plaus resume` continues the run",
        RunFileProblem::Unconfirmed => "; `plaus resume RUN --confirm` makes the list",
        _ => "",
    }
}

impl Failure {
    /// A failed write of output.
    pub(crate) fn of_output(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ReaderGone,
            io::ErrorKind::NotFound => Self::Message("cannot write: its folder does not exist".to_owned()),
            _ => Self::Message(format!("cannot write: {error}")),
        }
    }

    /// The same failure, with the file that it is about.
    pub(crate) fn about(self, what: &str) -> Self {
        match self {
            Self::Message(message) if !message.contains(what) => Self::Message(format!("{what}: {message}")),
            other => other,
        }
    }

    /// The same failure, with the flag instead of the key for keys that have flags of their own. `flags` holds pairs of
    /// an override and the flag as given.
    pub(crate) fn naming(mut self, flags: &[(String, String)]) -> Self {
        if let Self::Scenario(error) = &mut self {
            for problem in &mut error.problems {
                let Source::Override(said) = &mut problem.source else { continue };
                if let Some((_, flag)) = flags.iter().find(|(key, _)| key == said) {
                    said.clone_from(flag);
                }
            }
        }
        self
    }

    /// The problem in one line, for reports made elsewhere.
    pub(crate) fn message(&self) -> Option<String> {
        match self {
            Self::Scenario(error) => error.problems.first().map(|problem| problem.message.clone()),
            Self::Message(message) => Some(message.clone()),
            Self::ReaderGone => None,
        }
    }

    /// Reports it to the user; gives the exit code.
    pub(crate) fn report(&self) -> u8 {
        match self {
            Self::Scenario(error) => console::note_line(&render(error, console::is_coloured())),
            Self::Message(message) => console::note_line(&format!("error: {}", console::shortened(message))),
            Self::ReaderGone => return 0,
        }
        2
    }
}

/// All problems of a scenario, each with its line shown.
fn render(error: &ScenarioError, coloured: bool) -> String {
    let renderer = if coloured { Renderer::styled() } else { Renderer::plain() };
    let shown = error.problems.iter().take(SHOWN_PROBLEMS).map(|problem| render_one(error, problem, &renderer));
    let mut text = shown.collect::<Vec<_>>().join("\n");
    if let Some(more) = error.problems.len().checked_sub(SHOWN_PROBLEMS).filter(|&more| more > 0) {
        let last = Group::with_title(Level::ERROR.primary_title(format!("and {more} more problems in {}", error.name)));
        text += &format!("\n{}", renderer.render(&[last]));
    }
    text
}

fn render_one(error: &ScenarioError, problem: &Problem, renderer: &Renderer) -> String {
    let title = match &problem.source {
        Source::File if problem.key.is_empty() => problem.message.clone(),
        Source::File => format!("{}: {}", problem.key, problem.message),
        Source::Override(flag) if flag.starts_with("--") => format!("{flag}: {}", problem.message),
        Source::Override(said) => format!("--set {said}: {}", problem.message),
    };
    let mut group = Group::with_title(Level::ERROR.primary_title(console::shortened(&title)));
    if let Some(span) = &problem.span {
        let end = span.end.min(error.text.len());
        let mark = AnnotationKind::Primary.span(span.start.min(end)..end);
        group = group.element(Snippet::source(&error.text).path(&error.name).annotation(mark));
    } else if problem.source == Source::File {
        group = group.element(Level::NOTE.message(format!("in {}", error.name)));
    }
    if let Some(help) = &problem.help {
        group = group.element(Level::HELP.message(console::shortened(help)));
    }
    renderer.render(&[group]).to_string()
}
