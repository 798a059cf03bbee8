//! USD: a composed stage, with its physics, as a GLB.
//!
//! Units, axes, transforms, time samples and shapes become those of nodes; bodies, colliders, materials, joints and
//! filters of UsdPhysics those of the draft extension `KHR_physics_rigid_bodies`. What the extension has no word for is
//! in an extension of its own, [`FROM_USD`](crate::glb::FROM_USD): gravity, densities, and what is not taken over.

mod axes;
mod build;
mod crate_file;
mod crate_values;
mod filters;
mod forms;
mod joints;
mod lexer;
mod looks;
mod others;
mod package;
mod physics;
mod place;
mod scene;
mod source;
mod text;
mod value;
mod write;

use crate::xml::Open;
use crate::{AssetError, MOST_BYTES};
use axes::Axes;
use build::Builder;
use openusd::ar::join_package_relative_path;
use openusd::usd::Stage;
use place::Places;
use scene::Scene;
use serde_json::json;
use source::{Source, Why};
use std::rc::Rc;
use std::sync::mpsc::channel;
use std::thread;

/// The stack of the thread that reads, in bytes: the library calls itself for what is within something else.
const STACK: usize = 64 << 20;

/// The file called `file`, a name without folders, as a GLB; what is one already stays one. `open` reads the files that
/// it names, by their paths from its folder.
///
/// # Errors
///
/// [`AssetError::Broken`], with the prim's path, for what is not valid USD, or says something impossible;
/// [`AssetError::TooLong`] and [`AssetError::TooMany`] for too many bytes or triangles.
pub fn packed(file: &str, bytes: &[u8], open: Open<'_>) -> Result<Vec<u8>, AssetError> {
    if bytes.len() > MOST_BYTES {
        return Err(AssetError::TooLong { bytes: bytes.len() as u64 });
    }
    if bytes.starts_with(b"glTF") {
        return Ok(bytes.to_vec());
    }
    let (ask, asked) = channel::<String>();
    let (say, said) = channel::<Result<Vec<u8>, String>>();
    let root = (file.to_owned(), bytes.to_vec());
    let reading = thread::Builder::new().stack_size(STACK).spawn(move || {
        let why = Why::default();
        let source = Source::new(root.clone(), ask, said, Rc::clone(&why));
        let made = made(&root.0, &root.1, source, &why);
        // What the library says of it is less.
        let first = why.borrow_mut().first.take();
        made.map_err(|error| first.map_or(error, AssetError::Broken))
    });
    let reading = reading.map_err(|error| AssetError::Broken(format!("no thread can read it: {error}")))?;
    while let Ok(path) = asked.recv() {
        if say.send(open(&path)).is_err() {
            break;
        }
    }
    // A panic of the library becomes an error only where panics unwind: not in the profile `release`.
    let lost = || AssetError::Broken("it cannot be read: the library `openusd` gave up on it; save it again".into());
    reading.join().unwrap_or_else(|_| Err(lost()))
}

/// The path of the root layer of a file: itself, or the first in a package.
fn root(file: &str, bytes: &[u8]) -> Result<String, AssetError> {
    let is_package = file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("usdz"));
    Ok(match is_package {
        true => join_package_relative_path(file, &package::first(bytes).map_err(AssetError::Broken)?),
        false => file.to_owned(),
    })
}

fn made(file: &str, bytes: &[u8], source: Source, why: &Why) -> Result<Vec<u8>, AssetError> {
    let root = root(file, bytes)?;
    let stage = Stage::builder().resolver(source).open(&root);
    let stage = stage.map_err(|error| AssetError::Broken(format!("it is not valid USD: {error:#}")))?;
    let scene = Scene::read(stage)?;
    let axes = Axes::read(&scene)?;
    let places = Places::read(&scene)?;
    let mut builder = Builder::new(&scene, &axes, &places)?;
    builder.shapes()?;
    builder.motions()?;
    builder.build()?;
    builder.joints()?;
    builder.filters()?;
    builder.others();
    let Builder { mut file, physics, mut left_out, harmless, .. } = builder;
    left_out.extend(scene.complaints());
    left_out.append(&mut why.borrow_mut().others);
    file.bodies.insert("physicsMaterials".into(), physics.materials.into());
    if let Some(gravity) = physics.gravity {
        file.ours.insert("gravity".into(), json!(gravity.to_array()));
    }
    file.ours.insert("left_out".into(), left_out.into());
    file.ours.insert("harmless".into(), harmless.into());
    file.bytes()
}
