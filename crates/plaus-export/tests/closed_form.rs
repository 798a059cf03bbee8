//! What a GLB holds is the closed form, read back by another crate.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Glb, tumbling};
use glam::{DQuat, DVec3};
use plaus_export::keys::of_track;
use plaus_export::{Clip, Cut, Label, glb};
use plaus_scenes::animation::Animation;

fn written(animation: &Animation, range: Option<(f64, f64)>) -> (Glb, Cut) {
    let cut = Cut::new(60.0, range, animation).unwrap();
    let label = Label::new("tumbling");
    (Glb::read(&glb::to_vec(&Clip { animation, label: &label, cut }).unwrap()), cut)
}

/// Diagonal of the box of all positions, in m.
fn size(animation: &Animation) -> f64 {
    let places = (0..=100).flat_map(|k| {
        let time = animation.duration * f64::from(k) / 100.0;
        animation.tracks.iter().map(move |track| track.position(time))
    });
    let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    low.distance(high)
}

#[test]
fn poses_are_exact_at_keys_and_right_between_them() {
    let animation = tumbling();
    for range in [None, Some((0.37, 1.21))] {
        let (glb, cut) = written(&animation, range);
        let size = size(&animation);
        for track in &animation.tracks {
            let body = glb.body(&track.name);
            let keys = of_track(&animation, track, &cut);
            for key in &keys {
                let found = body.position(key.time - cut.from());
                assert!(found.distance(key.position) <= 1e-5 * size, "{} at {}", track.name, key.time);
                let turned = body.orientation(key.time - cut.from());
                assert!(turned.dot(key.orientation).abs() > 1.0 - 1e-6, "{} at {}", track.name, key.time);
            }
            for pair in keys.windows(2) {
                for share in [0.17, 0.5, 0.81] {
                    let time = pair[0].time + share * (pair[1].time - pair[0].time);
                    // Times are single in the file: near an impact that alone is worth some of the tolerance.
                    let found = body.position(time - cut.from());
                    assert!(found.distance(track.position(time)) <= 1e-3 * size, "{} at {time}", track.name);
                    let turned = body.orientation(time - cut.from());
                    let off = 2.0 * (1.0 - turned.dot(track.orientation(time)).abs()).max(0.0).sqrt();
                    assert!(off * track.shape.reach() <= 1e-3 * size, "{} turned by {off} rad at {time}", track.name);
                }
            }
        }
    }
}

#[test]
fn contact_heights_are_exact_at_impacts() {
    let animation = tumbling();
    let (glb, _) = written(&animation, None);
    for hit in &animation.impacts {
        let body = glb.body(&hit.body);
        let key = body.key_at(hit.time).unwrap_or_else(|| panic!("no key at the impact at {} s", hit.time));
        let track = animation.tracks.iter().find(|track| track.name == hit.body).unwrap();
        assert_eq!(key.y, track.position(hit.time).y as f32, "the height at {} s, to the last bit", hit.time);
    }
}

#[test]
fn facts_are_extras_and_nodes_have_their_names() {
    let animation = tumbling();
    let mut label = Label::new("sample_3_14");
    label.facts.insert("log_p".into(), (-1.25).into());
    label.facts.insert("sample".into(), "3:14".into());
    let cut = Cut::new(30.0, None, &animation).unwrap();
    let glb = Glb::read(&glb::to_vec(&Clip { animation: &animation, label: &label, cut }).unwrap());
    assert_eq!(glb.names(), ["table", "die_0", "pin_0", "ball_0", "sample_3_14"]);
    assert_eq!(glb.extras(), r#"{"log_p":-1.25,"sample":"3:14"}"#);
    assert!(DQuat::IDENTITY.dot(glb.body("ball_0").orientation(0.4)).abs() < 0.999, "the ball rolls");
}

#[test]
fn animations_without_bodies_or_motion_are_files_too() {
    for animation in [Animation::new(0.0, vec![], vec![]), Animation::new(0.0, tumbling().tracks, vec![])] {
        let (glb, _) = written(&animation, None);
        assert_eq!(glb.names().len(), animation.tracks.len() + 1);
    }
}
