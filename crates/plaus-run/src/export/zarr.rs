//! A Zarr v3 folder that ArviZ reads: groups `posterior` and `sample_stats`, and `warmup_posterior` and
//! `warmup_sample_stats` if there is a warm-up, all with dimensions (chain, draw). Numbered scalars of one name, `x_1`,
//! `x_2` and so on, are one variable `x` with a third dimension, named after the numbered things: `x[die]`. Whole
//! numbers are stored as such.
//!
//! Chunks are raw little-endian numbers, one for each chain, so that any language reads them without a library.
//! Metadata is consolidated: `zarr.json` at the root describes every array.

use super::variables::{self, Variable};
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::manifest::Manifest;
use crate::read::{Repeats, RunReader};
use crate::sample_id::ChainPhase;
use plaus_scenes::Scene;
use serde_json::{Map, Value, json};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

/// An array of a group.
struct Array {
    name: String,
    data_type: &'static str,
    fill: Value,
    dimensions: Vec<&'static str>,
    shape: Vec<u64>,
    attributes: Value,
}

impl Array {
    fn floats(name: impl Into<String>, shape: &[u64], attributes: Value) -> Self {
        Self::new(name, "float64", json!("NaN"), shape, attributes)
    }

    fn new(name: impl Into<String>, data_type: &'static str, fill: Value, shape: &[u64], attributes: Value) -> Self {
        Self {
            name: name.into(),
            data_type,
            fill,
            dimensions: vec!["chain", "draw"],
            shape: shape.to_vec(),
            attributes,
        }
    }

    /// One chunk for each chain; a coordinate is one chunk.
    fn metadata(&self) -> Value {
        let mut chunk = self.shape.clone();
        if chunk.len() > 1 {
            chunk[0] = 1;
        }
        json!({
            "zarr_format": 3,
            "node_type": "array",
            "shape": self.shape,
            "data_type": self.data_type,
            "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": chunk } },
            "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } },
            "fill_value": self.fill,
            "codecs": [{ "name": "bytes", "configuration": { "endian": "little" } }],
            "attributes": self.attributes,
            "dimension_names": self.dimensions,
            "storage_transformers": [],
        })
    }
}

/// Whether a folder was made by [`write()`], and may be replaced.
#[must_use]
pub fn is_ours(path: &Path) -> bool {
    let root: Option<Value> = fs::read(path.join("zarr.json")).ok().and_then(|json| serde_json::from_slice(&json).ok());
    root.is_some_and(|root| root["attributes"]["inference_library"] == "plaus")
}

/// Fills the folder `out`, which exists and is empty.
///
/// # Errors
/// [`Error`] if the run has no draws, its records are damaged or the disk refuses.
pub fn write(run: &RunReader<'_>, out: &Path) -> Result<(), Error> {
    if run.draws(ChainPhase::Sampling) == 0 {
        return Err(RunFileError::new(run.run().folder().path(), RunFileProblem::Empty).into());
    }
    let mut nodes = Map::new();
    for (phase, prefix) in [(ChainPhase::Sampling, ""), (ChainPhase::Warmup, "warmup_")] {
        let shape = [run.chains().len() as u64, run.draws(phase)];
        if shape[1] == 0 {
            continue;
        }
        let variables = variables::of(run.scene());
        let scalars = variables.iter().map(|variable| of_variable(variable, &shape)).collect();
        let groups = [("posterior", scalars), ("sample_stats", sample_stats(&shape))];
        let mut numbered: Vec<(&'static str, i64, u64)> = variables.iter().filter_map(Variable::coordinate).collect();
        numbered.dedup();
        for (name, arrays) in &groups {
            let mut coordinates = vec![("chain", i64::from(run.chains().start), shape[0]), ("draw", 0, shape[1])];
            if *name == "posterior" {
                coordinates.extend(&numbered);
            }
            let group = Group { out, name: format!("{prefix}{name}"), about: about(run.run().manifest()) };
            group.write(arrays, &coordinates, &mut nodes)?;
        }
        let names = groups.map(|(group, arrays)| (format!("{prefix}{group}"), arrays));
        (0..).zip(run.chains()).try_for_each(|at| write_chain(run, phase, at, out, (&names, &variables)))?;
    }
    let consolidated = json!({ "kind": "inline", "must_understand": false, "metadata": nodes });
    let root = json!({
        "zarr_format": 3,
        "node_type": "group",
        "attributes": about(run.run().manifest()),
        "consolidated_metadata": consolidated,
    });
    write_json(&out.join("zarr.json"), &root)
}

fn of_variable(variable: &Variable, shape: &[u64]) -> Array {
    // Not `units`: xarray would turn seconds into time differences.
    let attributes = json!({ "unit": variable.unit, "role": variable.role });
    let (data_type, fill) = if variable.whole { ("int64", json!(0)) } else { ("float64", json!("NaN")) };
    let mut array = Array::new(variable.name.as_ref(), data_type, fill, shape, attributes);
    if let Some((dimension, _, count)) = variable.coordinate() {
        array.dimensions.push(dimension);
        array.shape.push(count);
    }
    array
}

fn sample_stats(shape: &[u64]) -> Vec<Array> {
    let about = |text: &str| json!({ "description": text });
    vec![
        Array::floats("lp", shape, about("log p(A), up to a constant")),
        Array::floats("acceptance_rate", shape, about("accepted share of the proposals since the draw before")),
        Array::new("satisfied", "bool", json!(false), shape, about("whether the draw satisfies the constraint")),
    ]
}

/// Where the draws come from. It has no time of day: equal runs give equal folders.
fn about(manifest: &Manifest) -> Value {
    json!({
        "inference_library": "plaus",
        "inference_library_version": manifest.plaus,
        "creation_library": "plaus",
        "scene": manifest.scene,
        "scenario": manifest.scenario.effective,
        "scenario_hash": manifest.scenario.hash,
        "seed": manifest.plan.seed,
        "thin": manifest.plan.thin,
        "exact_acceptance": manifest.exact,
    })
}

/// A group to be written.
struct Group<'a> {
    out: &'a Path,
    name: String,
    about: Value,
}

impl Group<'_> {
    /// Writes its metadata, its coordinates (each a name, its first number, and how many there are), and the metadata
    /// of its arrays.
    fn write(
        &self,
        arrays: &[Array],
        coordinates: &[(&'static str, i64, u64)],
        nodes: &mut Map<String, Value>,
    ) -> Result<(), Error> {
        let (out, group) = (self.out, self.name.as_str());
        let metadata = json!({ "zarr_format": 3, "node_type": "group", "attributes": self.about });
        make(&out.join(group))?;
        write_json(&out.join(group).join("zarr.json"), &metadata)?;
        nodes.insert(group.to_owned(), metadata);
        for &(dimension, first, length) in coordinates {
            let about = json!({ "description": format!("number of the {dimension}") });
            let mut index = Array::new(dimension, "int64", json!(0), &[length], about);
            index.dimensions = vec![dimension];
            write_array(out, group, &index, nodes)?;
            let numbers: Vec<u8> = (first..first + length as i64).flat_map(i64::to_le_bytes).collect();
            write_bytes(&out.join(group).join(dimension).join("c").join("0"), &numbers)?;
        }
        arrays.iter().try_for_each(|array| write_array(out, group, array, nodes))
    }
}

fn write_array(out: &Path, group: &str, array: &Array, nodes: &mut Map<String, Value>) -> Result<(), Error> {
    let folder = out.join(group).join(&array.name);
    make(&folder.join("c"))?;
    let metadata = array.metadata();
    write_json(&folder.join("zarr.json"), &metadata)?;
    nodes.insert(format!("{group}/{}", array.name), metadata);
    Ok(())
}

/// The chunks of one chain, all written while its records are read once.
struct Chunks(Vec<BufWriter<File>>);

impl Chunks {
    fn create(out: &Path, groups: &[(String, Vec<Array>)], index: u32) -> Result<Self, Error> {
        let mut files = Vec::new();
        for (group, array) in groups.iter().flat_map(|(group, arrays)| arrays.iter().map(move |array| (group, array))) {
            let mut folder = out.join(group).join(&array.name).join("c").join(index.to_string());
            // The chunk's place along each further dimension.
            (2..array.shape.len()).for_each(|_| folder.push("0"));
            make(&folder)?;
            files.push(BufWriter::new(File::create(folder.join("0")).map_err(Error::Output)?));
        }
        Ok(Self(files))
    }

    fn put(&mut self, index: usize, value: &[u8], times: u64) -> Result<(), Error> {
        let file = &mut self.0[index];
        (0..times).try_for_each(|_| file.write_all(value)).map_err(Error::Output)
    }
}

fn write_chain(
    run: &RunReader<'_>,
    phase: ChainPhase,
    (index, chain): (u32, u32),
    out: &Path,
    (groups, variables): (&[(String, Vec<Array>)], &[Variable]),
) -> Result<(), Error> {
    let mut chunks = Chunks::create(out, groups, index)?;
    let thin = run.run().manifest().plan.thin as f64;
    let mut values = vec![0.0; run.scene().scalars().len()];
    run.walk(chain, phase, |repeats: Repeats<'_>| -> Result<(), Error> {
        let state = &repeats.entry.state;
        run.scene().write_scalars(state.by_ref(), &mut values);
        let lp = state.log_p().value();
        for (index, variable) in variables.iter().enumerate() {
            chunks.put(index, &variable.bytes(&values), repeats.draws)?;
        }
        let stats = variables.len();
        chunks.put(stats, &lp.to_le_bytes(), repeats.draws)?;
        let rate = (f64::from(repeats.accepted) / thin).min(1.0); // a swap comes on top of an acceptance
        chunks.put(stats + 1, &rate.to_le_bytes(), 1)?;
        chunks.put(stats + 1, &0.0_f64.to_le_bytes(), repeats.draws - 1)?;
        chunks.put(stats + 2, &[u8::from(repeats.entry.class.is_some())], repeats.draws)
    })?;
    chunks.0.iter_mut().try_for_each(BufWriter::flush).map_err(Error::Output)
}

fn make(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(Error::Output)
}

fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    fs::write(path, bytes).map_err(Error::Output)
}

fn write_json(path: &Path, value: &Value) -> Result<(), Error> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|error| Error::Output(error.into()))?;
    text.push(b'\n');
    write_bytes(path, &text)
}
