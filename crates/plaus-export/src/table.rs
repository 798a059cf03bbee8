//! Poses and impacts as tables, one in each row; numbers are the shortest that read back as the same bits.

use crate::clip::Clip;
use crate::keys::{Key, of_track};
use glam::DVec3;
use plaus_animation::{Contact, Impact, Look, Track};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Columns of a table of poses: seconds; the body's middle, which is its centre of gravity or, of a kinematic body,
/// its origin, in metres; a unit quaternion from the body's frame to the world's; whether it hits something; and its
/// origin, the point that a scenario gives places for, in metres.
pub const POSES: &str = "t,body,x,y,z,qx,qy,qz,qw,impact,origin_x,origin_y,origin_z";
/// Columns of a table of impacts and contacts: seconds, names of nodes and their materials, metres, a unit vector, m/s,
/// N·s and N. Columns that do not apply to a row are empty.
pub const EVENTS: &str =
    "kind,t,end,body,other,body_material,other_material,x,y,z,nx,ny,nz,speed,impulse,slip,roll,force";

/// Writes rows of [`POSES`] in order of time, each after `prefix`.
///
/// # Errors
/// What `out` says.
pub fn write_poses(out: &mut dyn Write, clip: &Clip<'_>, prefix: &str) -> io::Result<()> {
    let mut row = String::new();
    for (track, key) in poses(clip) {
        let (p, q, o) = (key.position, key.orientation, origin(track, &key) + DVec3::ZERO);
        row.clear();
        // Writing to a string cannot fail.
        let _ = write!(row, "{prefix}{:?},{},", key.time - clip.cut.from(), track.name);
        for number in [p.x, p.y, p.z, q.x, q.y, q.z, q.w] {
            let _ = write!(row, "{:?},", number + 0.0);
        }
        writeln!(out, "{row}{},{:?},{:?},{:?}", key.impact, o.x, o.y, o.z)?;
    }
    Ok(())
}

/// Poses as JSON objects with the columns of [`POSES`].
#[must_use]
pub fn poses_to_json(clip: &Clip<'_>) -> Value {
    let object = |(track, key): (&Track, Key)| {
        let (p, q, o) = (key.position, key.orientation, origin(track, &key));
        json!({"t": key.time - clip.cut.from(), "body": track.name, "x": p.x, "y": p.y, "z": p.z,
            "qx": q.x, "qy": q.y, "qz": q.z, "qw": q.w, "impact": key.impact,
            "origin_x": o.x, "origin_y": o.y, "origin_z": o.z})
    };
    poses(clip).into_iter().map(object).collect()
}

/// Where a body's origin is.
fn origin(track: &Track, key: &Key) -> DVec3 {
    key.position + key.orientation * track.origin
}

/// Keys of all bodies in order of time, from when each appears; at equal times the bodies keep their order.
fn poses<'a>(clip: &Clip<'a>) -> Vec<(&'a Track, Key)> {
    let of_body = |track: &Track| -> Vec<Key> {
        let is_there = |key: &Key| track.is_there(key.time);
        of_track(clip.animation, track, &clip.cut).into_iter().filter(is_there).collect()
    };
    let tracks = &clip.animation.motion.tracks;
    let mut poses: Vec<(&Track, Key)> =
        tracks.iter().flat_map(|track| of_body(track).into_iter().map(move |key| (track, key))).collect();
    poses.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
    poses
}

/// Writes rows of [`EVENTS`], impacts and contacts together in order of time, each after `prefix`.
///
/// # Errors
/// What `out` says.
pub fn write_events(out: &mut dyn Write, clip: &Clip<'_>, prefix: &str) -> io::Result<()> {
    let mut rows: Vec<(f64, String)> = Vec::new();
    let numbers =
        |numbers: &[f64]| numbers.iter().map(|number| format!("{:?}", number + 0.0)).collect::<Vec<_>>().join(",");
    for hit in impacts(clip) {
        let (p, n, t) = (hit.point, hit.normal, hit.time - clip.cut.from());
        let strength = numbers(&[p.x, p.y, p.z, n.x, n.y, n.z, hit.speed, hit.impulse]);
        let [a, b] = materials(clip, &hit.body, &hit.other);
        rows.push((hit.time, format!("impact,{t:?},,{},{},{a},{b},{strength},,,", hit.body, hit.other)));
    }
    for contact in contacts(clip) {
        let (p, [a, b]) = (contact.point, materials(clip, &contact.body, &contact.other));
        let [start, end] = times(clip, contact);
        let pair = format!("{},{},{a},{b}", contact.body, contact.other);
        let n = contact.normal;
        let normal = if n == DVec3::ZERO { ",,".to_owned() } else { numbers(&[n.x, n.y, n.z]) };
        let (place, force) = (numbers(&[p.x, p.y, p.z]), numbers(&[contact.slip, contact.roll, contact.force]));
        rows.push((contact.start, format!("contact,{start:?},{end:?},{pair},{place},{normal},,,{force}")));
    }
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.iter().try_for_each(|(_, row)| writeln!(out, "{prefix}{row}"))
}

/// Impacts as JSON objects: `t` (s), `pair`, `materials`, `point` (m), `normal`, `speed` (m/s) and `impulse` (N·s).
#[must_use]
pub fn impacts_to_json(clip: &Clip<'_>) -> Value {
    let object = |hit: &Impact| {
        json!({"t": hit.time - clip.cut.from(), "pair": [hit.body, hit.other],
            "materials": materials(clip, &hit.body, &hit.other), "point": hit.point.to_array(),
            "normal": hit.normal.to_array(), "speed": hit.speed, "impulse": hit.impulse})
    };
    impacts(clip).map(object).collect()
}

/// Contacts that last as JSON objects: `t`, `end` (s), `pair`, `materials`, `point` (m), `normal` (null where unknown),
/// `slip`, `roll` (m/s) and `force` (N).
#[must_use]
pub fn contacts_to_json(clip: &Clip<'_>) -> Value {
    let object = |contact: &Contact| {
        let [start, end] = times(clip, contact);
        json!({"t": start, "end": end, "pair": [contact.body, contact.other],
            "materials": materials(clip, &contact.body, &contact.other), "point": contact.point.to_array(),
            "normal": (contact.normal != DVec3::ZERO).then(|| contact.normal.to_array()),
            "slip": contact.slip, "roll": contact.roll, "force": contact.force})
    };
    contacts(clip).map(object).collect()
}

fn impacts<'a>(clip: &'a Clip<'_>) -> impl Iterator<Item = &'a Impact> {
    clip.animation.motion.impacts.iter().filter(|hit| clip.cut.holds(hit.time))
}

fn contacts<'a>(clip: &'a Clip<'_>) -> impl Iterator<Item = &'a Contact> {
    let (from, to) = (clip.cut.from(), clip.cut.to());
    // Bodies that rest from the start bear on things for no time at all, if the animation ends with that.
    let is_within = move |one: &&Contact| {
        if one.end > one.start { one.end > from && one.start < to } else { (from..=to).contains(&one.start) }
    };
    clip.animation.motion.contacts.iter().filter(is_within)
}

/// Start and end within the clip, from its beginning.
fn times(clip: &Clip<'_>, contact: &Contact) -> [f64; 2] {
    [contact.start, contact.end].map(|time| time.clamp(clip.cut.from(), clip.cut.to()) - clip.cut.from())
}

/// The materials of the two sides; empty if nothing has that name.
fn materials(clip: &Clip<'_>, body: &str, other: &str) -> [String; 2] {
    [body, other].map(|name| clip.animation.look_of(name).map(Look::name).unwrap_or_default())
}

/// The impacts that matter. If impacts of one pair follow the first within `merge` s, one is left, at the time and
/// place of the hardest, with the sum of their impulses. Then impacts with an impulse below `least` N·s are dropped. An
/// impact of unknown impulse stays.
#[must_use]
pub fn fewer(impacts: &[Impact], least: f64, merge: f64) -> Vec<Impact> {
    let mut groups: Vec<(f64, Impact)> = Vec::new();
    for hit in impacts {
        let near = |group: &&mut (f64, Impact)| {
            let (first, known) = &**group;
            hit.time - first < merge && known.involves(&hit.body) && known.involves(&hit.other)
        };
        // Only the last few can be near.
        match groups.iter_mut().rev().take(64).find(near) {
            Some((_, known)) => {
                let impulse = known.impulse + hit.impulse;
                if hit.speed > known.speed {
                    *known = hit.clone();
                }
                known.impulse = impulse;
            }
            None => groups.push((hit.time, hit.clone())),
        }
    }
    let mut left: Vec<Impact> = groups.into_iter().map(|(_, hit)| hit).collect();
    left.retain(|hit| hit.impulse == 0.0 || hit.impulse >= least);
    left.sort_by(|a, b| a.time.total_cmp(&b.time));
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn impacts_that_follow_each_other_become_one() {
        let hit = |time, body: &str, speed, impulse| {
            Impact::new(time, body, "table", DVec3::ZERO, DVec3::Y).with_strength(speed, impulse)
        };
        let all =
            [hit(0.1, "a", 1.0, 0.2), hit(0.1005, "b", 9.0, 9.0), hit(0.101, "a", 2.0, 0.3), hit(0.2, "a", 0.1, 0.01)];
        assert_eq!(fewer(&all, 0.0, 0.0), all);
        let merged = fewer(&all, 0.02, 0.002);
        assert_eq!(merged.iter().map(|hit| (hit.time, hit.impulse)).collect::<Vec<_>>(), [(0.1005, 9.0), (0.101, 0.5)]);
        assert_eq!(fewer(&all, 0.02, 0.0).len(), 3);
    }
}
