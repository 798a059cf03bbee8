//! A die, a pin and a ball, written in every format: `cargo run -p plaus-export --example tumbling [FOLDER]`.

#[path = "../tests/common/mod.rs"]
mod common;

use plaus_export::{Clip, Cut, Label, glb, table, usda};
use std::error::Error;
use std::fs;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from);
    let animation = common::tumbling();
    let mut label = Label::new("tumbling");
    for (key, value) in [("sample", "0:0".into()), ("seed", 1.into()), ("log_p", (-0.5).into()), ("scalars", "".into())]
    {
        label.facts.insert(key.to_owned(), value);
    }
    let clip = |fps: f64| -> Result<Clip<'_>, plaus_export::ExportError> {
        Ok(Clip::new(&animation, &label, Cut::new(fps, None, &animation)?))
    };
    fs::write(folder.join("tumbling.glb"), glb::to_vec(&clip(60.0)?)?)?;
    fs::write(folder.join("tumbling.glb.import"), glb::godot_import("tumbling.glb"))?;
    fs::write(folder.join("tumbling.usda"), usda::to_string(&clip(60.0)?))?;
    for (file, fps) in [("tumbling.poses.csv", 60.0), ("tumbling.between.csv", 240.0)] {
        let mut rows = format!("{}\n", table::POSES).into_bytes();
        table::write_poses(&mut rows, &clip(fps)?, "")?;
        fs::write(folder.join(file), rows)?;
    }
    Ok(())
}
