//! The manifest: what a run is, readable by people and programs.

use crate::disk::Disk;
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::shard::Shard;
use crate::way::{Way, is_independent, moves_of};
use plaus_mcmc::{Mixture, Plan};
use plaus_scenes::files::{Assets, hash_of};
use plaus_scenes::{Role, Scenario, Scene, Stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;

/// Version of the folder's format.
pub const FORMAT: u32 = 4;
/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Longest manifest that is read, in bytes.
const LONGEST: u64 = 64 << 20;
/// Most iterations of all chains together between two points at which a run can stop: bounds the memory of a round.
const LONGEST_ROUND: u64 = 1 << 22;

/// What a run is. It depends neither on the clock nor on the number of threads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of plaus that made the run.
    pub plaus: String,
    /// The scene's name.
    pub scene: String,
    /// The piece of the plan's chains that the folder holds; absent if it holds all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// The scenario.
    pub scenario: StoredScenario,
    /// Keys set on the command line, as `key=value`.
    pub overrides: Vec<String>,
    /// Seed, chains, iterations.
    pub plan: Plan,
    /// The iterations planned before each time that `plaus resume --iterations` raised them.
    pub extended_from: Vec<u64>,
    /// Whether the chains are guaranteed to leave the target invariant.
    pub exact: bool,
    /// The flags of the acceptance rule.
    pub acceptance_rule: BTreeMap<String, bool>,
    /// Names of the moves, in order of their number in the records.
    pub moves: Vec<String>,
    /// The scalars of the scene.
    pub scalars: Vec<StoredScalar>,
    /// A name for what was required beyond the scenario. The recorded log constraints include its factor, and the run
    /// can be continued only with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub requirement: Option<String>,
    /// How draws are made, and why; absent if chains make them and no trial decided that, and until it is
    /// [decided](crate::is_undecided).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way: Option<Way>,
    /// The files that the scenario names, by their paths, each with its BLAKE3 hash. The run has its own copies.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub assets: BTreeMap<String, String>,
    /// The contents of these files.
    #[serde(skip)]
    pub(crate) contents: Assets,
}

/// The scenario of a run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredScenario {
    /// Name of the file it was read from, without its folder.
    pub file: String,
    /// Text of that file.
    pub text: String,
    /// Every key with its effective value, as TOML.
    pub effective: String,
    /// BLAKE3 of `effective`.
    pub hash: String,
}

/// A scalar of the scene, as the manifest names it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredScalar {
    /// Column name.
    pub name: String,
    /// Unit; empty for pure numbers.
    pub unit: String,
    /// `draw` or `outcome`.
    pub role: String,
}

/// What a run is made from.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// The scenario with all overrides in force.
    pub scenario: Scenario,
    /// Name of its file, without the folder.
    pub file: String,
    /// Text of that file.
    pub text: String,
    /// Keys set on the command line, as `key=value`.
    pub overrides: Vec<String>,
    /// Stop after this many distinct solutions.
    pub solutions: Option<u64>,
}

/// The file: the run, between a version, which is checked first, and a checksum.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Envelope {
    format: u32,
    run: Manifest,
    checksum: String,
}

#[derive(Deserialize)]
struct Probe {
    format: u32,
}

impl Recipe {
    /// The plan the scenario asks for.
    #[must_use]
    pub fn plan(&self) -> Plan {
        plan(&self.scenario, self.solutions, Way::said(&self.scenario).as_ref())
    }

    /// The manifest of a run of `scene`.
    ///
    /// # Errors
    /// [`Error`] if the weights of its moves make no mixture.
    pub fn manifest(&self, scene: &Stage) -> Result<Manifest, Error> {
        let rules = &self.scenario.sampler.rules;
        let way = Way::said(&self.scenario);
        let effective = self.scenario.to_toml();
        let contents = self.scenario.world.assets();
        let read = Scenario::read_with(&self.file, &effective, &[], &contents)
            .map_err(|error| Error::StoredScenario(error.to_string()))?;
        if read != self.scenario {
            return Err(Error::StoredScenario("writing and reading it again changes it".to_owned()));
        }
        let hash = blake3::hash(effective.as_bytes()).to_hex().to_string();
        let scenario = StoredScenario { file: self.file.clone(), text: self.text.clone(), effective, hash };
        Ok(Manifest {
            plaus: VERSION.to_owned(),
            scene: self.scenario.world.name().to_owned(),
            shard: None,
            scenario,
            overrides: self.overrides.clone(),
            plan: self.plan(),
            extended_from: Vec::new(),
            exact: rules.is_exact() || is_independent(way.as_ref()),
            acceptance_rule: rules.flags().into_iter().map(|(flag, on)| (flag.to_owned(), on)).collect(),
            moves: moves_of(scene, rules, way.as_ref())?.names(),
            scalars: stored_scalars(scene),
            requirement: None,
            way,
            assets: contents.iter().map(|(path, bytes)| (path.to_owned(), hash_of(bytes))).collect(),
            contents,
        })
    }
}

/// The plan of a run whose draws are made in this way. Climbs come before the warm-up, for as many iterations as the
/// sampling phase has, and belong to it. Independent draws need no warm-up.
fn plan(scenario: &Scenario, solutions: Option<u64>, way: Option<&Way>) -> Plan {
    let sampler = &scenario.sampler;
    let climbs = if way.is_some_and(|way| way.climbs) { sampler.iterations } else { 0 };
    let warmup = if is_independent(way) { 0 } else { sampler.warmup.saturating_add(climbs) };
    let block = sampler.checkpoint_every.min(LONGEST_ROUND / u64::from(sampler.chains).max(1));
    Plan {
        warmup,
        block: block.max(1),
        solutions,
        settle: sampler.settle.unwrap_or(true) && climbs == 0,
        climbs,
        // Independent draws are sampled from the first on.
        sampled: sampler.sampled_only.unwrap_or(false) && !is_independent(way),
        ..scenario.plan()
    }
}

/// The first key whose values differ in two effective scenarios, with both values. Each line of one corresponds to a
/// line of the other, because one program wrote both.
fn different_key(here: &str, there: &str) -> Option<String> {
    let mut table = String::new();
    let mut lines = (here.lines(), there.lines());
    loop {
        let (ours, theirs) = match (lines.0.next(), lines.1.next()) {
            (None, None) => return None,
            (ours, theirs) => (ours.unwrap_or("nothing"), theirs.unwrap_or("nothing")),
        };
        if ours != theirs {
            let within = if table.is_empty() { String::new() } else { format!(" in {table}") };
            return Some(format!("it has `{ours}`{within}, not `{theirs}`"));
        }
        if ours.starts_with('[') {
            table = ours.to_owned();
        }
    }
}

fn draft(folder: &Folder) -> std::path::PathBuf {
    folder.manifest().with_extension("json.next")
}

/// The scalars of a scene, as a manifest names them: without details, which it does not depend on.
pub(crate) fn stored_scalars(scene: &Stage) -> Vec<StoredScalar> {
    let store = |scalar: plaus_scenes::Scalar| {
        let role = match scalar.role {
            Role::Draw => "draw",
            Role::Outcome => "outcome",
            Role::Detail => return None,
        };
        Some(StoredScalar { name: scalar.name, unit: scalar.unit.to_owned(), role: role.to_owned() })
    };
    scene.scalars().into_iter().filter_map(store).collect()
}

impl Manifest {
    /// The manifest in stored form.
    ///
    /// # Errors
    /// [`RunFileProblem::Manifest`] if it cannot be written as JSON, which no manifest made here is known to do.
    pub fn to_json(&self) -> Result<Vec<u8>, RunFileProblem> {
        let broken = |error: serde_json::Error| RunFileProblem::Manifest(error.to_string());
        let checksum = self.checksum().map_err(broken)?;
        let envelope = Envelope { format: FORMAT, run: self.clone(), checksum };
        let mut json = serde_json::to_vec_pretty(&envelope).map_err(broken)?;
        json.push(b'\n');
        Ok(json)
    }

    /// Reads what [`Manifest::to_json`] made.
    ///
    /// # Errors
    /// [`RunFileProblem::Manifest`] if `json` is anything else, or was changed.
    pub fn from_json(json: &[u8]) -> Result<Self, RunFileProblem> {
        let broken = |error: serde_json::Error| RunFileProblem::Manifest(error.to_string());
        let Probe { format } = serde_json::from_slice(json).map_err(broken)?;
        if format != FORMAT {
            let message = format!("it has format {format}, but this plaus {VERSION} reads format {FORMAT}");
            return Err(RunFileProblem::Manifest(message));
        }
        let Envelope { run, checksum, .. } = serde_json::from_slice(json).map_err(broken)?;
        if run.checksum().map_err(broken)? != checksum {
            return Err(RunFileProblem::Manifest(
                "its checksum does not match: it was changed after it was written".into(),
            ));
        }
        Ok(run)
    }

    /// BLAKE3 of the compact JSON, whose whitespace and order are fixed.
    fn checksum(&self) -> Result<String, serde_json::Error> {
        Ok(blake3::hash(&serde_json::to_vec(self)?).to_hex().to_string())
    }

    /// Reads the manifest of a run.
    ///
    /// # Errors
    /// [`RunFileError`] if there is none, or it is damaged.
    pub fn read(folder: &Folder) -> Result<Self, RunFileError> {
        let path = folder.manifest();
        let mut json = Vec::new();
        folder.open_manifest()?.take(LONGEST).read_to_end(&mut json).map_err(RunFileError::io(&path, "read"))?;
        let manifest = Self::from_json(&json).map_err(|problem| RunFileError::new(path, problem))?;
        Ok(Self { contents: manifest.copies(folder)?, ..manifest })
    }

    /// The run's copies of the files that its scenario names.
    fn copies(&self, folder: &Folder) -> Result<Assets, RunFileError> {
        let mut contents = Assets::default();
        for (name, hash) in &self.assets {
            let path = folder.asset(hash);
            let bytes = std::fs::read(&path).map_err(RunFileError::io(&path, "read"))?;
            if hash_of(&bytes) != *hash {
                return Err(RunFileError::new(path, RunFileProblem::Asset(name.clone())));
            }
            contents.insert(name.clone(), bytes);
        }
        Ok(contents)
    }

    /// Puts this manifest in place of the run's.
    pub(crate) fn replace(&self, folder: &Folder, disk: &dyn Disk) -> Result<(), RunFileError> {
        let path = folder.manifest();
        let draft = draft(folder);
        let json = self.to_json().map_err(|problem| RunFileError::new(&path, problem))?;
        let written = disk.write(&draft, &json).and_then(|()| disk.rename(&draft, &path));
        written.and_then(|()| disk.sync(folder.path())).map_err(RunFileError::io(&path, "write"))
    }

    /// Removes a manifest that never took its place.
    pub(crate) fn clear(folder: &Folder, disk: &dyn Disk) {
        let _ = disk.remove(&draft(folder)); // it rarely exists
    }

    /// The effective scenario.
    ///
    /// # Errors
    /// [`Error::StoredScenario`] if this version cannot read it, or the plan does not follow from it.
    pub fn scenario(&self) -> Result<Scenario, Error> {
        let scenario = Scenario::read_with(&self.scenario.file, &self.scenario.effective, &[], &self.contents)
            .map_err(|error| Error::StoredScenario(error.to_string()))?;
        let mut planned = plan(&scenario, self.plan.solutions, self.way.as_ref());
        let first = self.extended_from.first().copied().unwrap_or(self.plan.iterations);
        let longer = self.plan.iterations >= first && self.plan.end() < 1 << 48;
        if first != planned.iterations || !longer {
            return Err(Error::StoredScenario("it plans other iterations than the run".to_owned()));
        }
        planned.iterations = self.plan.iterations;
        let whole = self.shard.is_none_or(|shard| shard.range(self.plan.chains).is_ok());
        if planned != self.plan || self.scene != scenario.world.name() || !whole {
            return Err(Error::StoredScenario("it is not the one in the run's plan".to_owned()));
        }
        Ok(scenario)
    }

    /// Whether its draws are independent draws from the prior.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        is_independent(self.way.as_ref())
    }

    /// Whether solutions are looked for by climbs first: these are found, not weighted.
    #[must_use]
    pub fn climbs(&self) -> bool {
        self.plan.climbs > 0
    }

    /// The moves that its chains make.
    ///
    /// # Errors
    /// [`Error`] if the stored scenario cannot be read, or its weights make no mixture.
    pub fn mixture(&self, scene: &Stage) -> Result<Mixture<Stage>, Error> {
        Ok(moves_of(scene, &self.scenario()?.sampler.rules, self.way.as_ref())?)
    }

    /// The same manifest with draws made in another way.
    ///
    /// # Errors
    /// [`Error`] if the weights of its moves make no mixture.
    pub(crate) fn made(self, way: Way, scene: &Stage, scenario: &Scenario) -> Result<Self, Error> {
        let (way, rules) = (Some(way), &scenario.sampler.rules);
        let moves = moves_of(scene, rules, way.as_ref())?.names();
        let exact = rules.is_exact() || is_independent(way.as_ref());
        let plan = plan(scenario, self.plan.solutions, way.as_ref());
        Ok(Self { way, moves, exact, plan, ..self })
    }

    /// How this run differs from `other`, if it does: version, seed, the first key of the scenario, or which piece.
    #[must_use]
    pub fn differs_from(&self, other: &Self) -> Option<String> {
        let shown =
            |manifest: &Self| manifest.shard.map_or("the whole run".to_owned(), |shard| format!("piece {shard}"));
        if self.plaus != other.plaus {
            return Some(format!("it was made by plaus {}, not {}", self.plaus, other.plaus));
        }
        if let Some(difference) = different_key(&self.scenario.effective, &other.scenario.effective) {
            return Some(difference);
        }
        let parts = [
            ("its number of iterations or of solutions", self.plan != other.plan),
            ("the scenario's file", self.scenario != other.scenario),
            ("how its keys were set on the command line", self.overrides != other.overrides),
            ("how often it was made longer", self.extended_from != other.extended_from),
            ("what is required beyond the scenario", self.requirement != other.requirement),
            ("how draws are made", self.way != other.way),
            ("its moves, scalars or rules", Self { shard: other.shard, ..self.clone() } != *other),
        ];
        let part = parts.into_iter().find(|part| part.1).map(|(what, _)| format!("{what} differs"));
        part.or_else(|| (self.shard != other.shard).then(|| format!("it is {}, not {}", shown(self), shown(other))))
    }

    /// Numbers of the chains that the folder holds; empty if the manifest is not that of a run.
    #[must_use]
    pub fn chains(&self) -> Range<u32> {
        self.shard.map_or(0..self.plan.chains, |shard| shard.range(self.plan.chains).unwrap_or_default())
    }

    /// What its clips are called: the scene, or for a world of a user its file, without what names of files should not
    /// have.
    #[must_use]
    pub fn name(&self) -> String {
        let stem = self.scenario.file.strip_suffix(".toml").unwrap_or(&self.scenario.file);
        let plain = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
        let name: String = stem.chars().map(plain).collect();
        let name = name.trim_matches(['-', '.']);
        if self.scene == "custom" && !name.is_empty() { name.to_owned() } else { self.scene.clone() }
    }

    /// The keys set on the command line, without the number of iterations of a run that only its solutions or its time
    /// end: nobody set that.
    pub fn said(&self) -> impl Iterator<Item = &str> {
        let is_endless = self.plan.is_endless();
        let all = self.overrides.iter().map(String::as_str);
        all.filter(move |said| !is_endless || !said.starts_with("sampler.iterations="))
    }

    /// Makes sure that the scenario alone decides whether an outcome satisfies.
    ///
    /// # Errors
    /// [`Error::Request`] if the run has a requirement, which only the program that gave it can ask.
    pub fn judges_alone(&self) -> Result<(), Error> {
        self.requirement.as_ref().map_or(Ok(()), |name| {
            Err(Error::Request(format!(
                "this run has a requirement, {name}, that its folder does not hold: so it is unknown whether another simulation meets it"
            )))
        })
    }

    /// A number that the chains' files carry, so that files of different runs cannot be confused. The number of chains
    /// is not part of it: what a chain leaves does not depend on the others.
    pub(crate) fn run_id(&self) -> u64 {
        let (mut hasher, mut of_sampler) = (blake3::Hasher::new(), false);
        for line in self.scenario.effective.split_inclusive('\n') {
            if line.starts_with('[') {
                of_sampler = line.trim_end() == "[sampler]";
            }
            if !(of_sampler && line.starts_with("chains = ")) {
                hasher.update(line.as_bytes());
            }
        }
        let hash = hasher.finalize();
        hash.as_bytes()[..8].iter().fold(0, |id, &byte| id << 8 | u64::from(byte))
    }

    /// Recorded draws among the iterations before `iteration`.
    pub(crate) fn recorded_before(&self, iteration: u64) -> u64 {
        iteration.div_ceil(self.plan.thin.max(1))
    }
}
