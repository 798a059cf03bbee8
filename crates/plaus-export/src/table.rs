//! Poses and impacts as tables: one a row, numbers as the shortest that read back as the same bits.

use crate::clip::Clip;
use crate::keys::{Key, of_track};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Columns of a table of poses: seconds, metres, and a unit quaternion from the body's frame to the world's.
pub const POSES: &str = "t,body,x,y,z,qx,qy,qz,qw,impact";
/// Columns of a table of impacts: seconds, metres, a unit vector, m/s and N·s.
pub const EVENTS: &str = "t,body,other,x,y,z,nx,ny,nz,speed,impulse";

/// Writes rows of [`POSES`] in order of time, each after `prefix`.
///
/// # Errors
/// What `out` says.
pub fn write_poses(out: &mut dyn Write, clip: &Clip<'_>, prefix: &str) -> io::Result<()> {
    let mut row = String::new();
    for (name, key) in poses(clip) {
        let (p, q) = (key.position, key.orientation);
        row.clear();
        // Writing to a string cannot fail.
        let _ = write!(row, "{prefix}{:?},{name},", key.time - clip.cut.from());
        for number in [p.x, p.y, p.z, q.x, q.y, q.z, q.w] {
            let _ = write!(row, "{:?},", number + 0.0);
        }
        writeln!(out, "{row}{}", key.impact)?;
    }
    Ok(())
}

/// Poses as JSON objects with the columns of [`POSES`].
#[must_use]
pub fn poses_to_json(clip: &Clip<'_>) -> Value {
    let object = |(name, key): (&str, Key)| {
        let (p, q) = (key.position, key.orientation);
        json!({"t": key.time - clip.cut.from(), "body": name, "x": p.x, "y": p.y, "z": p.z,
            "qx": q.x, "qy": q.y, "qz": q.z, "qw": q.w, "impact": key.impact})
    };
    poses(clip).into_iter().map(object).collect()
}

/// Keys of all bodies in order of time; at equal times the bodies keep their order.
fn poses<'a>(clip: &Clip<'a>) -> Vec<(&'a str, Key)> {
    let of_body = |track| -> Vec<Key> { of_track(clip.animation, track, &clip.cut) };
    let tracks = &clip.animation.tracks;
    let mut poses: Vec<(&str, Key)> =
        tracks.iter().flat_map(|track| of_body(track).into_iter().map(|key| (track.name.as_str(), key))).collect();
    poses.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
    poses
}

/// Writes rows of [`EVENTS`] in order of time, each after `prefix`.
///
/// # Errors
/// What `out` says.
pub fn write_events(out: &mut dyn Write, clip: &Clip<'_>, prefix: &str) -> io::Result<()> {
    for hit in clip.animation.impacts.iter().filter(|hit| clip.cut.holds(hit.time)) {
        let (p, n) = (hit.point, hit.normal);
        let numbers =
            [p.x, p.y, p.z, n.x, n.y, n.z, hit.speed, hit.impulse].map(|number| format!("{:?}", number + 0.0));
        let t = hit.time - clip.cut.from();
        writeln!(out, "{prefix}{t:?},{},{},{}", hit.body, hit.other, numbers.join(","))?;
    }
    Ok(())
}

/// Impacts as JSON objects: `t` (s), `pair`, `point` (m), `normal`, `speed` (m/s) and `impulse` (N·s).
#[must_use]
pub fn events_to_json(clip: &Clip<'_>) -> Value {
    let hits = clip.animation.impacts.iter().filter(|hit| clip.cut.holds(hit.time));
    let object = |hit: &plaus_animation::Impact| {
        json!({"t": hit.time - clip.cut.from(), "pair": [hit.body, hit.other], "point": hit.point.to_array(),
            "normal": hit.normal.to_array(), "speed": hit.speed, "impulse": hit.impulse})
    };
    hits.map(object).collect()
}
