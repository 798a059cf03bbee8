//! Rows: poses and events.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError, Label};
use crate::{ours, table};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

pub(super) struct Poses;
pub(super) struct Events;

impl Exporter for Poses {
    fn row(&self) -> &'static Row {
        &Row {
            name: "poses",
            endings: &["csv"],
            about: "CSV, one row per sample, body and key",
            help: "Columns: chain, draw (w17: from the warm-up), t (s), body, x, y, z (m, y up) of the centre of \
                   gravity (of a kinematic body, its origin), a unit quaternion qx, qy, qz, qw, whether it is at an \
                   impact, and origin_x, origin_y, origin_z: the point that `at_mm` places. There are keys at every \
                   frame, at every impact, and at the start of every piece of motion; a body that \
                   appears later has none before.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Rows { columns: table::POSES, write: table::write_poses, begun: false })
    }

    fn is_ours(&self, path: &Path) -> bool {
        ours::begins_with(path, head(table::POSES).as_bytes())
    }

    fn is_table(&self) -> bool {
        true
    }
}

impl Exporter for Events {
    fn row(&self) -> &'static Row {
        &Row {
            name: "events",
            endings: &["csv", "json"],
            about: "impacts and lasting contacts, for sound: CSV, or JSON if PATH ends in .json",
            help: "One row for each impact: t (s), the pair as names of nodes, what each is made of, point (m), normal, \
                   speed of approach (m/s), impulse (N s). One row for each contact that lasts: t and end, mean speeds \
                   of slipping and rolling (m/s), and the mean force between the two (N). --min-impulse leaves out \
                   weak impacts, --merge joins those of one pair that follow each other closely.",
        }
    }

    fn begin(&self, path: &Path) -> Box<dyn Collection> {
        if path.extension().is_some_and(|end| end == "json") {
            return Box::new(List { begun: false });
        }
        Box::new(Rows { columns: table::EVENTS, write: table::write_events, begun: false })
    }

    fn is_ours(&self, path: &Path) -> bool {
        if path.extension().is_some_and(|end| end == "json") {
            return ours::begins_with(path, JSON_HEAD.as_bytes());
        }
        ours::begins_with(path, head(table::EVENTS).as_bytes())
    }

    fn is_table(&self) -> bool {
        true
    }
}

/// Beginning of a list of events.
const JSON_HEAD: &str = "{\"impacts\":";

fn head(columns: &str) -> String {
    format!("chain,draw,{columns}")
}

/// Chain and draw, from the label's facts; for the warm-up in the form of `--sample`, `w17`.
fn sample(label: &Label) -> [Value; 2] {
    let fact = |name: &str| label.facts.get(name).cloned().unwrap_or(Value::Null);
    let named = label.facts.get("sample").and_then(Value::as_str).and_then(|name| name.split_once(':'));
    match named.filter(|_| label.facts.contains_key("phase")) {
        Some((_, draw)) => [fact("chain"), Value::from(draw)],
        None => [fact("chain"), fact("draw")],
    }
}

/// A value without the quotes of a string.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Writes the rows of a clip, each after a prefix.
type WriteRows = fn(&mut dyn Write, &Clip<'_>, &str) -> std::io::Result<()>;

struct Rows {
    columns: &'static str,
    write: WriteRows,
    begun: bool,
}

impl Rows {
    fn head(&mut self, out: &mut dyn Write) -> Result<(), ExportError> {
        if !std::mem::replace(&mut self.begun, true) {
            writeln!(out, "{}", head(self.columns))?;
        }
        Ok(())
    }
}

impl Collection for Rows {
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        self.head(out)?;
        let [chain, draw] = sample(clip.label);
        Ok((self.write)(out, clip, &format!("{},{},", plain(&chain), plain(&draw)))?)
    }

    fn finish(mut self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        self.head(out)
    }
}

struct List {
    begun: bool,
}

impl Collection for List {
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        let before = if std::mem::replace(&mut self.begun, true) { ",\n" } else { "{\"impacts\":[" };
        let [chain, draw] = sample(clip.label);
        let (impacts, contacts) = (table::impacts_to_json(clip), table::contacts_to_json(clip));
        let one = json!({"chain": chain, "draw": draw, "impacts": impacts, "contacts": contacts});
        Ok(write!(out, "{before}{one}")?)
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        let before = if self.begun { "" } else { "{\"impacts\":[" };
        Ok(writeln!(out, "{before}]}}")?)
    }
}
