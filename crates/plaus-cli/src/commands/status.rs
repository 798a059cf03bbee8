//! `plaus status`: how far pieces are, according to the small files that they write. No network is used.

use super::is_undecided;
use super::job::Job;
use crate::clock::{in_words, unix_seconds};
use crate::console::quoted;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::progress::{LONGEST_SILENCE, Signal, State, host, read_signal};
use crate::table::{counted, grouped, lay_out, percent, rate};
use plaus_run::{Folder, Run, Shard, Tally, chance};
use serde::Serialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Pieces shown one by one, unless all are asked for.
const SHOWN: usize = 20;

/// Which job.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of a job that `plaus submit` made, or folders of pieces
    #[arg(required = true, value_name = "JOB")]
    jobs: Vec<PathBuf>,
    /// Show every piece
    #[arg(short, long)]
    all: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The state of a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Standing {
    /// Nothing is there yet.
    Waiting,
    /// Running.
    Running,
    /// Finished.
    Done,
    /// Stopped, so that it can be continued: interrupted, or out of time.
    Stopped,
    /// Failed, with a reason.
    Failed,
    /// Silent for longer than a running piece ever is, and written by nobody: it was killed.
    Died,
}

impl Standing {
    fn in_words(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
            Self::Died => "died",
        }
    }
}

/// A piece.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct PieceStatus {
    pub(crate) standing: Standing,
    pub(crate) folder: PathBuf,
    pub(crate) signal: Option<Signal>,
    /// Seconds since its last signal.
    pub(crate) silent: Option<u64>,
    /// Of a chance: batches made, and batches planned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) batches: Option<[usize; 2]>,
    /// Why it failed.
    pub(crate) why: Option<String>,
    /// Whether it belongs to a chance, not to a run.
    #[serde(skip)]
    is_chance: bool,
}

impl PieceStatus {
    /// Looks up the state of a piece.
    pub(crate) fn of(folder: &Folder) -> Self {
        let signal = read_signal(folder);
        if let Some(whole) = signal.is_none().then(|| Self::of_whole_run(folder)).flatten() {
            return whole;
        }
        let silent = signal.as_ref().map(|signal| unix_seconds().saturating_sub(signal.time));
        let standing = match &signal {
            // A lock may be invisible from another machine, but a recent signal is not.
            _ if folder.is_being_written() => Standing::Running,
            // Until it is decided how it is sampled, it sends no signals.
            None if is_undecided(folder).unwrap_or(false) => Standing::Stopped,
            None if folder.manifest().exists() => Standing::Died,
            None => Standing::Waiting,
            Some(signal) => match signal.state {
                State::Done => Standing::Done,
                State::Stopped => Standing::Stopped,
                State::Failed => Standing::Failed,
                State::Running if signal.host == host() => Standing::Died,
                State::Running if silent.is_some_and(|silent| silent as f64 > 3.0 * LONGEST_SILENCE) => Standing::Died,
                State::Running => Standing::Running,
            },
        };
        let why = signal.as_ref().and_then(|signal| signal.why.clone());
        Self { standing, folder: folder.path().to_owned(), signal, silent, batches: None, why, is_chance: false }
    }

    /// How far a run that is no piece has come, by its last checkpoints: it sends no signals.
    fn of_whole_run(folder: &Folder) -> Option<Self> {
        let run = Run::open(folder).ok().filter(|run| run.manifest().shard.is_none())?;
        let reader = run.reader().ok()?;
        let (plan, tally) = (run.manifest().plan, Tally::of(&reader).ok()?);
        let iteration = reader.iterations();
        let enough = plan.solutions.is_some_and(|wanted| tally.distinct >= wanted);
        let (standing, state) = match enough || iteration >= plan.end() {
            _ if folder.is_being_written() => (Standing::Running, State::Running),
            true => (Standing::Done, State::Done),
            false => (Standing::Stopped, State::Stopped),
        };
        let written = std::fs::metadata(folder.checkpoints()).or_else(|_| std::fs::metadata(folder.manifest())).ok()?;
        let silent = written.modified().ok()?.elapsed().map_or(0, |ago| ago.as_secs());
        let signal = Signal {
            state,
            why: None,
            piece: 1,
            of: 1,
            iteration,
            end: plan.end(),
            hits: tally.chains.iter().map(|chain| chain.hits.count).sum(),
            distinct: tally.distinct,
            iterations_per_second: 0.0,
            seconds: 0.0,
            chains: plan.chains,
            host: host(),
            process: std::process::id(),
            time: unix_seconds().saturating_sub(silent),
        };
        let (folder, silent) = (folder.path().to_owned(), Some(silent));
        Some(Self { standing, folder, signal: Some(signal), silent, batches: None, why: None, is_chance: false })
    }

    /// Looks up the state of a piece of a chance, which is one file.
    pub(crate) fn of_batches(path: PathBuf) -> Self {
        let found = chance::read(&path);
        let written = std::fs::metadata(&path).and_then(|file| file.modified()).ok();
        let silent = written.and_then(|time| time.elapsed().ok()).map(|ago| ago.as_secs());
        let batches = found.as_ref().ok().and_then(Option::as_ref).map(|found| <[usize; 2]>::from(found.done()));
        let said = std::fs::read_to_string(super::chance::why_file(&path)).ok();
        let stopped = said.as_deref() == Some(super::chance::GOES_ON);
        let why = found.err().map(|error| error.to_string()).or(said.filter(|_| !stopped));
        let standing = match (batches, &why) {
            (Some([done, due]), _) if done == due => Standing::Done,
            _ if chance::is_being_written(&path) => Standing::Running,
            (_, Some(_)) => Standing::Failed,
            _ if stopped => Standing::Stopped,
            (None, None) => Standing::Waiting,
            (Some(_), None) => Standing::Died,
        };
        let why = why.filter(|_| standing == Standing::Failed);
        Self { standing, folder: path, signal: None, silent, batches, why, is_chance: true }
    }

    /// Whether it is done before its last iteration, because it found what it was to find.
    fn ended_early(&self) -> bool {
        let is_left = |signal: &Signal| signal.iteration < signal.end;
        self.standing == Standing::Done && self.signal.as_ref().is_some_and(is_left)
    }

    /// The share of its work that is done.
    fn share(&self) -> f64 {
        // A piece without a signal is taken to be as long as the others.
        match (&self.signal, self.batches, self.standing) {
            (_, _, Standing::Done) => 1.0,
            (Some(signal), ..) => signal.iteration as f64 / signal.end.max(1) as f64,
            (_, Some([done, due]), _) => done as f64 / due.max(1) as f64,
            (None, None, _) => 0.0,
        }
    }
}

/// All pieces of a job.
pub(crate) fn of_job(job: &Job) -> Vec<(Shard, PieceStatus)> {
    let status = |shard| match job.is_chance() {
        true => PieceStatus::of_batches(job.batches(shard)),
        false => PieceStatus::of(&job.piece(shard)),
    };
    job.pieces().map(|shard| (shard, status(shard))).collect()
}

/// One line that counts a job's pieces by their state.
pub(crate) fn in_a_line(job: &Job) -> String {
    Summary::of(&of_job(job).into_iter().map(|(_, piece)| piece).collect::<Vec<_>>()).in_words()
}

/// All pieces together.
#[derive(Debug, Serialize)]
struct Summary {
    pieces: usize,
    standings: BTreeMap<&'static str, usize>,
    /// Share of the iterations, or batches, that are done.
    share: f64,
    iterations_per_second: f64,
    /// Whether the work consists of batches.
    #[serde(skip)]
    batches: bool,
    /// Seconds until the last running piece ends, at its present speed.
    eta_seconds: Option<f64>,
    /// How many pieces ended with the solutions that were asked for, before their last iteration.
    ended_early: usize,
}

impl Summary {
    fn of(pieces: &[PieceStatus]) -> Self {
        let mut standings = BTreeMap::new();
        for piece in pieces {
            *standings.entry(piece.standing.in_words()).or_insert(0) += 1;
        }
        let running = || pieces.iter().filter(|piece| piece.standing == Standing::Running);
        let running = || running().filter_map(|piece| piece.signal.as_ref());
        let left = |signal: &Signal| {
            let left = signal.end.saturating_sub(signal.iteration) * u64::from(signal.chains);
            left as f64 / signal.iterations_per_second
        };
        Self {
            pieces: pieces.len(),
            standings,
            batches: pieces.iter().any(|piece| piece.is_chance),
            share: pieces.iter().map(PieceStatus::share).sum::<f64>() / pieces.len().max(1) as f64,
            iterations_per_second: running().map(|signal| signal.iterations_per_second).fold(0.0, |sum, one| sum + one),
            eta_seconds: running().map(left).filter(|left| left.is_finite()).reduce(f64::max),
            ended_early: pieces.iter().filter(|piece| piece.ended_early()).count(),
        }
    }

    fn in_words(&self) -> String {
        let one = self.pieces == 1;
        let count = |(name, count): (&&str, &usize)| if one { (*name).to_owned() } else { format!("{count} {name}") };
        let counts: Vec<String> = self.standings.iter().map(count).collect();
        let eta = self.eta_seconds.map(|eta| format!("  running pieces end in {}", in_words(eta))).unwrap_or_default();
        let (counts, share) = (counts.join(", "), percent(self.share));
        if self.batches {
            return format!("{} pieces: {counts}  {share} of the batches", self.pieces);
        }
        let rate = rate(self.iterations_per_second);
        let counts = if one { counts } else { format!("{} pieces: {counts}", self.pieces) };
        match self.ended_early {
            0 => format!("{counts}: {share} of the iterations  {rate}{eta}"),
            all if all == self.pieces => {
                format!("{counts}: the solutions asked for were found before the last iteration")
            }
            some => format!("{counts}: {share} of the work, {some} with the solutions asked for  {rate}{eta}"),
        }
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut pieces: Vec<PieceStatus> = Vec::new();
        let mut merged = None;
        for path in &self.jobs {
            if let Some(job) = Job::open(path)? {
                pieces.extend(of_job(&job).into_iter().map(|(_, piece)| piece));
                let run = job.merged();
                merged = Some(run.exists().then_some(run));
            } else if !path.is_dir() {
                return Err(Failure::Message(match path.exists() {
                    true => format!("{}: is neither a job nor a run nor a piece of one", path.display()),
                    false => format!("there is no {}", path.display()),
                }));
            } else {
                pieces.extend(plaus_run::merge::folders_at(path)?.iter().map(PieceStatus::of));
            }
        }
        let summary = Summary::of(&pieces);
        if self.json {
            output::print_line(
                &json!({ "summary": summary, "pieces": pieces, "merged": merged.flatten() }).to_string(),
            )?;
        } else {
            output::print(&self.table(&pieces, &summary))?;
            match merged {
                Some(Some(run)) => output::print_line(&format!("merged: {}", run.display()))?,
                Some(None) if pieces.iter().all(|piece| piece.standing == Standing::Waiting) => {
                    let job = self.jobs.last().map(|job| quoted(job)).unwrap_or_default();
                    output::print_line(&format!(
                        "no piece has begun; if the job was only written, submit it: plaus submit --again {job} --go"
                    ))?;
                }
                Some(None) => output::print_line("not merged yet")?,
                None => {}
            }
        }
        let all_done = pieces.iter().all(|piece| piece.standing == Standing::Done);
        Ok(if all_done { Outcome::Done } else { Outcome::Unsatisfied })
    }

    fn table(&self, pieces: &[PieceStatus], summary: &Summary) -> String {
        // Pieces with something to report come first.
        let rank = |piece: &PieceStatus| match piece.standing {
            Standing::Failed => 0,
            Standing::Died => 1,
            Standing::Stopped => 2,
            Standing::Running => 3,
            Standing::Waiting => 4,
            Standing::Done => 5,
        };
        let mut order: Vec<&PieceStatus> = pieces.iter().collect();
        if !self.all && pieces.len() > SHOWN {
            // There is nothing to say about those that have not begun but how many they are.
            order.retain(|piece| piece.standing != Standing::Waiting);
            order.sort_by_key(|piece| rank(piece));
            order.truncate(SHOWN);
        }
        let head = match summary.batches {
            true => ["piece", "state", "batches", "of", "", "", "last sign"],
            false => ["piece", "state", "iteration", "of", "speed", "distinct", "last sign"],
        };
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(order.iter().map(|piece| row(piece)));
        let mut text = if order.is_empty() { String::new() } else { lay_out(&rows) };
        if order.len() < pieces.len() {
            let more = if order.is_empty() { "" } else { "more " };
            text += &format!("{} {more}not listed (`--all`)\n", counted((pieces.len() - order.len()) as u64, "piece"));
        }
        for piece in &order {
            if let Some(why) = &piece.why {
                text += &format!("{}: {why}\n", piece.folder.display());
            }
        }
        text + &format!("\n{}\n", summary.in_words())
    }
}

fn row(piece: &PieceStatus) -> Vec<String> {
    let standing = piece.standing.in_words().to_owned();
    let ago = format!("{} ago", in_words(piece.silent.unwrap_or(0) as f64));
    let Some(signal) = &piece.signal else {
        let name = piece.folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some([done, due]) = piece.batches else { return vec![name, standing] };
        let [done, due] = [done, due].map(|batches| grouped(batches as u64));
        return vec![name, standing, done, due, String::new(), String::new(), ago];
    };
    vec![
        format!("{}/{}", signal.piece, signal.of),
        standing,
        grouped(signal.iteration),
        if piece.ended_early() { format!("at most {}", grouped(signal.end)) } else { grouped(signal.end) },
        rate(signal.iterations_per_second),
        grouped(signal.distinct),
        ago,
    ]
}
