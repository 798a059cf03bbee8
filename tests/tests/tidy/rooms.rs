//! The folders of the simulator of rigid bodies import from lower ones only.

use super::circles::{imports, module_of};
use super::files;
use std::collections::BTreeSet;

/// For each folder, the others that it may import from. The files beside them, such as `body_state.rs`, are free.
const MAY_USE: &[(&str, &[&str])] = &[
    ("motion", &[]),
    ("solver", &[]),
    ("narrow_phase", &[]),
    ("joints", &["motion", "narrow_phase", "solver"]),
    ("time_of_impact", &["motion", "narrow_phase"]),
    ("impact", &["joints", "narrow_phase", "solver"]),
    ("island", &["joints", "motion", "narrow_phase", "solver"]),
];

/// The imports of these files from folders that theirs may not use.
fn upward(sources: &[(Vec<String>, String)]) -> Vec<String> {
    let modules: BTreeSet<Vec<String>> = sources.iter().map(|(module, _)| module.clone()).collect();
    let room = |module: &[String]| {
        let name = (module.first()? == "rigid").then(|| module.get(1))?;
        MAY_USE.iter().find(|(folder, _)| name.is_some_and(|name| name == folder))
    };
    let mut found = Vec::new();
    for (module, text) in sources {
        let Some((from, allowed)) = room(module) else { continue };
        for other in imports(module, text, &modules) {
            if room(&other).is_some_and(|(to, _)| to != from && !allowed.contains(to)) {
                found.push(format!("{} from {}", module.join("::"), other.join("::")));
            }
        }
    }
    found
}

#[test]
fn folders_import_from_lower_ones() {
    let source = super::root().join("crates/plaus-sim/src");
    let mut sources: Vec<_> = files(&source, ".rs")
        .iter()
        .map(|file| (module_of(&source, file), std::fs::read_to_string(file).unwrap()))
        .collect();
    for (folder, _) in MAY_USE {
        assert!(source.join("rigid").join(folder).is_dir(), "no folder {folder}");
    }
    assert_eq!(upward(&sources), [] as [&str; 0]);
    let solver = sources.iter_mut().find(|(module, _)| module.join("::") == "rigid::solver::newton").unwrap();
    solver.1.insert_str(0, "use crate::rigid::island::step;\n");
    assert_eq!(upward(&sources), ["rigid::solver::newton from rigid::island::step"]);
}
