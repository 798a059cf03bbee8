//! The files that each engine gets. Commands are lists of arguments if the engine takes them; the scripts of Slurm
//! quote each argument for the shell.

use crate::commands::job::{Engine, Job, text_of};
use crate::console::quoted;
use crate::failure::Failure;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// The error for a file whose text cannot be made.
fn broken(error: impl std::fmt::Display) -> Failure {
    Failure::Message(format!("cannot write the job: {error}"))
}

/// A command to be run here, one argument each, in the form that a shell takes.
pub(super) fn in_shell(words: &[String]) -> String {
    words.iter().map(|word| quoted(Path::new(word))).collect::<Vec<_>>().join(" ")
}

/// Writes the engine's files for the pieces numbered `wanted`; gives the commands that submit them, in order. `PIECES`
/// in a command stands for what the previous command printed.
pub(super) fn write(job: &Job, wanted: &[u32]) -> Result<Vec<Vec<String>>, Failure> {
    match job.what.engine {
        Engine::Slurm => slurm(job, wanted),
        Engine::Hyperqueue => hyperqueue(job, wanted),
        Engine::Openjd => openjd(job, wanted),
        Engine::Local => Ok(vec![job.piece_command("PIECE")?, job.merge_command()?]),
    }
}

/// Numbers as `1-5,7`.
pub(super) fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b);
    let shown = runs.filter_map(|run| match (run.first()?, run.last()?) {
        (first, last) if first == last => Some(first.to_string()),
        (first, last) => Some(format!("{first}-{last}")),
    });
    shown.collect::<Vec<_>>().join(",")
}

/// Placeholder in a command for the number that Slurm gives the array.
pub(super) const PIECES: &str = "PIECES";

fn slurm(job: &Job, wanted: &[u32]) -> Result<Vec<Vec<String>>, Failure> {
    // Slurm replaces `%j` and the like in names of folders, and this cannot be turned off. So the shell writes the
    // logs.
    let script = |name: &str, threads: usize, log: &str, more: &str, command: &[String]| {
        let logs = quoted(Path::new(&text_of(&job.path().join("logs"))?));
        let text = format!(
            "#!/bin/sh\n#SBATCH --job-name=plaus-{name}\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={threads}\n\
             #SBATCH --chdir=/\n#SBATCH --output=/dev/null\n{more}exec {} >> {logs}/{log} 2>&1\n",
            in_shell(command)
        );
        text_of(&job.write(&Path::new("submit").join(format!("{name}.sh")), &text)?)
    };
    let threads = job.what.threads.max(1);
    let array = format!("#SBATCH --requeue\n#SBATCH --array={}\n", ranges(wanted));
    let log = "piece-\"$SLURM_ARRAY_TASK_ID\".txt";
    let pieces = script("pieces", threads, log, &array, &job.piece_command("task")?)?;
    let merge = script("merge", 1, "merge.txt", "", &job.merge_command()?)?;
    let sbatch = |more: &[String], script: String| {
        let words = ["sbatch", "--parsable"].map(str::to_owned);
        [&words[..], more, &job.what.options, &[script]].concat()
    };
    Ok(vec![sbatch(&[], pieces), sbatch(&[format!("--dependency=afterok:{PIECES}")], merge)])
}

#[derive(Serialize)]
struct JobFile {
    name: String,
    task: Vec<Task>,
}

#[derive(Serialize)]
struct Task {
    id: u32,
    command: Vec<String>,
    cwd: String,
    stdout: &'static str,
    stderr: String,
    /// How often a task may lose its worker.
    crash_limit: u32,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    deps: Vec<u32>,
    request: Vec<Request>,
}

#[derive(Serialize)]
struct Request {
    resources: Resources,
}

#[derive(Serialize)]
struct Resources {
    cpus: usize,
}

fn hyperqueue(job: &Job, wanted: &[u32]) -> Result<Vec<Vec<String>>, Failure> {
    let cwd = text_of(job.path())?;
    let task = |id, command, log: String, deps, cpus| Task {
        id,
        command,
        cwd: cwd.clone(),
        stdout: "none",
        stderr: format!("logs/{log}.txt"),
        crash_limit: 20,
        deps,
        request: vec![Request { resources: Resources { cpus } }],
    };
    let threads = job.what.threads.max(1);
    let mut tasks = Vec::with_capacity(wanted.len() + 1);
    for &piece in wanted {
        let command = job.piece_command(&piece.to_string())?;
        tasks.push(task(piece, command, format!("piece-{piece}"), Vec::new(), threads));
    }
    tasks.push(task(job.what.pieces + 1, job.merge_command()?, "merge".to_owned(), wanted.to_vec(), 1));
    let file = JobFile { name: format!("plaus {}", job.what.scenario), task: tasks };
    let text = toml::to_string(&file).map_err(broken)?;
    let path = text_of(&job.write(Path::new("submit/job.toml"), &text)?)?;
    let words = ["hq", "job", "submit-file"].map(str::to_owned);
    Ok(vec![[&words[..], &job.what.options, &[path]].concat()])
}

/// Longest text that a parameter of a template may have, in characters.
const LONGEST_PARAMETER: usize = 1024;
/// Longest name of a job, in characters.
const LONGEST_NAME: usize = 128;

fn openjd(job: &Job, wanted: &[u32]) -> Result<Vec<Vec<String>>, Failure> {
    // Every word from the user becomes a parameter: placeholders within a parameter's text are never replaced.
    let mut parameters: Vec<Value> = Vec::new();
    let mut action = |step: &str, words: Vec<String>, piece: Option<&str>| -> Result<Value, Failure> {
        let mut shown = Vec::new();
        for (index, word) in words.iter().enumerate() {
            if word.chars().count() > LONGEST_PARAMETER {
                return Err(broken(format!(
                    "a parameter of a template has at most {LONGEST_PARAMETER} characters: {word}"
                )));
            }
            match piece.filter(|_| word.starts_with("--shard=")) {
                Some(piece) => shown.push(piece.to_owned()),
                None => {
                    let name = format!("{step}{index}");
                    shown.push(format!("{{{{Param.{name}}}}}"));
                    parameters.push(json!({ "name": name, "type": "STRING", "default": word }));
                }
            }
        }
        let command = if shown.is_empty() { String::new() } else { shown.remove(0) };
        Ok(json!({ "actions": { "onRun": { "command": command, "args": shown, "cancelation": {
            "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 30
        } } } }))
    };
    let shard = format!("--shard={{{{Task.Param.Piece}}}}/{}", job.what.pieces);
    let pieces = action("Piece", job.piece_command("PIECE")?, Some(&shard))?;
    let merge = action("Merge", job.merge_command()?, None)?;
    let name: String = format!("plaus {}", job.what.scenario).replace(['{', '}'], "_");
    let name: String = name.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": name,
        "parameterDefinitions": parameters,
        "steps": [
            {
                "name": "Pieces",
                "parameterSpace": { "taskParameterDefinitions": [
                    { "name": "Piece", "type": "INT", "range": ranges(wanted) }
                ] },
                "script": pieces,
                "hostRequirements": { "amounts": [{ "name": "amount.worker.vcpu", "min": job.what.threads.max(1) }] },
            },
            { "name": "Merge", "dependencies": [{ "dependsOn": "Pieces" }], "script": merge },
        ],
    });
    let text = serde_json::to_string_pretty(&template).map_err(broken)?;
    let path = text_of(&job.write(Path::new("submit/template.json"), &format!("{text}\n"))?)?;
    let words = ["openjd", "run"].map(str::to_owned);
    Ok(vec![[&words[..], &[path], &job.what.options].concat()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_said_in_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(ranges(&[4]), "4");
        assert_eq!(ranges(&[]), "");
    }
}
