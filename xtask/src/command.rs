//! Other programs, run in the root of the workspace.

use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};
use std::process;

/// Why a chore failed, for the person at the terminal.
#[derive(Debug)]
pub(crate) struct Failure(pub(crate) String);

impl Failure {
    pub(crate) fn new(message: impl fmt::Display) -> Self {
        Self(message.to_string())
    }
}

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// Where cargo puts what it builds.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// A program with its arguments, for running and for showing.
#[derive(Debug)]
pub(crate) struct Command {
    inner: process::Command,
    shown: String,
}

/// A command of the cargo that runs this chore.
pub(crate) fn cargo(arguments: &[&str]) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    Command::named(program, "cargo").args(arguments)
}

/// Where cargo puts an executable that it builds; `within` is a folder of [`target`].
pub(crate) fn built(within: &str, name: &str) -> PathBuf {
    target().join(within).join(name).with_extension(std::env::consts::EXE_EXTENSION)
}

/// The release binary, which an earlier step has built.
pub(crate) fn plaus(arguments: &[&str]) -> Command {
    Command::new(built("release", "plaus")).args(arguments)
}

impl Command {
    pub(crate) fn new(program: impl AsRef<OsStr>) -> Self {
        let shown = program.as_ref().to_string_lossy().into_owned();
        Self::named(program, &shown)
    }

    fn named(program: impl AsRef<OsStr>, shown: &str) -> Self {
        let mut inner = process::Command::new(program);
        inner.current_dir(root());
        Self { inner, shown: shown.to_owned() }
    }

    pub(crate) fn args<A: AsRef<OsStr>>(mut self, arguments: impl IntoIterator<Item = A>) -> Self {
        for argument in arguments {
            self.shown.push(' ');
            self.shown.push_str(&argument.as_ref().to_string_lossy());
            self.inner.arg(argument);
        }
        self
    }

    pub(crate) fn env(mut self, key: &str, value: &str) -> Self {
        self.shown = format!("{key}={value:?} {}", self.shown);
        self.inner.env(key, value);
        self
    }

    /// Runs in another folder than the root of the workspace.
    pub(crate) fn within(mut self, folder: &Path) -> Self {
        self.inner.current_dir(folder);
        self
    }

    /// The program and its arguments, as one would type them.
    pub(crate) fn shown(&self) -> &str {
        &self.shown
    }

    /// Shows it, then runs it.
    pub(crate) fn shown_and_run(self) -> Result<(), Failure> {
        println!("$ {}", self.shown());
        self.run()
    }

    /// Runs it; its output goes where ours goes.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let shown = self.shown.clone();
        match self.status()? {
            0 => Ok(()),
            code => Err(Failure(format!("`{shown}` failed with exit code {code}"))),
        }
    }

    /// Runs it; returns its exit code, or 128 and more if a signal ended it.
    pub(crate) fn status(mut self) -> Result<i32, Failure> {
        let status = self.inner.status();
        let status = status.map_err(|error| Failure(format!("cannot run `{}`: {error}", self.shown)))?;
        Ok(status.code().unwrap_or(128))
    }

    /// Runs it; returns its exit code and its standard output.
    pub(crate) fn output(mut self) -> Result<(i32, Vec<u8>), Failure> {
        let output = self.inner.stderr(process::Stdio::inherit()).output();
        let output = output.map_err(|error| Failure(format!("cannot run `{}`: {error}", self.shown)))?;
        Ok((output.status.code().unwrap_or(128), output.stdout))
    }
}
