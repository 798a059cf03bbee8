//! A GLB holds the closed form, read back by another crate.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Glb, tumbling};
use glam::{DQuat, DVec3, Vec3};
use plaus_animation::{Animation, Look, Piece, Shape, Track};
use plaus_dist::stream::{Purpose, Seed};
use plaus_export::keys::{Key, of_track};
use plaus_export::{Between, Clip, Cut, Label, Style, format, glb, thin};
use plaus_mcmc::Target;
use plaus_scenes::registry::{NAMES, World};
use plaus_scenes::{AnyScene, Scene};
use std::path::Path;

fn written(animation: &Animation, range: Option<(f64, f64)>, keys: Between) -> (Glb, Cut) {
    let cut = Cut::new(60.0, range, animation).unwrap();
    let label = Label::new("tumbling");
    let clip = Clip::new(animation, &label, cut).styled(Style { keys, ..Style::default() });
    (Glb::read(&glb::to_vec(&clip).unwrap()), cut)
}

/// Diagonal of the box of all positions, in m.
fn size(animation: &Animation) -> f64 {
    let places = (0..=100).flat_map(|k| {
        let time = animation.motion.duration * f64::from(k) / 100.0;
        animation.motion.tracks.iter().map(move |track| track.position(time))
    });
    let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    low.distance(high)
}

/// Animations of this many draws from a scene's prior.
fn from_prior(name: &str, draws: u64) -> impl Iterator<Item = Animation> + use<> {
    let scene = World::default_of(name).unwrap().scene().unwrap();
    let start = |scene: &AnyScene, chain| scene.start(&mut Seed(5).chain(chain).at(0, Purpose::START));
    (0..draws).map(move |chain| scene.animate(&start(&scene, chain)).unwrap())
}

/// Some animations of every scene, and one with everything in it.
fn animations() -> Vec<(&'static str, Animation)> {
    let mut all = vec![("tumbling", tumbling())];
    for name in NAMES {
        all.extend(from_prior(name, 2).map(|animation| (*name, animation)));
    }
    all
}

/// Checks that poses agree to 1e-5 of the scene's size at keys, and to 1e-3 between keys at 60 frames per second.
fn agrees(name: &str, animation: &Animation, range: Option<(f64, f64)>) {
    let (glb, cut) = written(animation, range, Between::Exact);
    let size = size(animation);
    for track in &animation.motion.tracks {
        let body = glb.body(&track.name);
        let keys = of_track(animation, track, &cut);
        for key in &keys {
            let found = body.position(key.time - cut.from());
            assert!(found.distance(key.position) <= 1e-5 * size, "{name}: {} at {}", track.name, key.time);

            let turned = body.orientation(key.time - cut.from());
            assert!(turned.dot(key.orientation).abs() > 1.0 - 1e-6, "{name}: {} at {}", track.name, key.time);
        }
        for pair in keys.windows(2) {
            for share in [0.17, 0.5, 0.81] {
                let time = pair[0].time + share * (pair[1].time - pair[0].time);
                // Times in the file have single precision; near an impact, that alone uses up part of the tolerance.
                let found = body.position(time - cut.from());
                assert!(found.distance(track.position(time)) <= 1e-3 * size, "{name}: {} at {time}", track.name);
                let turned = body.orientation(time - cut.from());
                let off = 2.0 * (1.0 - turned.dot(track.orientation(time)).abs()).max(0.0).sqrt();
                let reach = track.shape.reach();
                assert!(off * reach <= 1e-3 * size, "{name}: {} turned by {off} rad at {time}", track.name);
            }
        }
    }
}

#[test]
fn poses_are_exact_at_keys_and_right_between_them() {
    agrees("tumbling", &tumbling(), Some((0.37, 1.21)));
    for (name, animation) in animations() {
        agrees(name, &animation, None);
    }
}

/// What keys for straight lines promise: at random times every body is within the tolerance, and turned by at most
/// 0.03°, and there are no more keys than before.
#[test]
fn straight_lines_stay_near_the_motion() {
    for (name, animation) in animations() {
        let (glb, cut) = written(&animation, None, Between::Linear);
        let mut random = Seed(3).chain(0).at(0, Purpose::START);
        for track in &animation.motion.tracks {
            let (body, most) = (glb.body(&track.name), thin::tolerance(track.shape.reach()));
            assert!(most <= 2e-4, "what is promised");
            // Of keys that Blender would merge only one is kept, so times near such keys are left out here.
            let keys = of_track(&animation, track, &cut);
            let close: Vec<[f64; 2]> = keys
                .windows(2)
                .filter(|pair| pair[1].time - pair[0].time < thin::APART)
                .map(|pair| [pair[0].time - thin::APART, pair[1].time + thin::APART])
                .collect();
            let crowded = |time: f64| close.iter().any(|[from, to]| (*from..=*to).contains(&time));
            let times = (0..200).map(|_| cut.to() * plaus_dist::stream::open_unit(&mut random));
            let times: Vec<f64> = times.filter(|time| !crowded(*time)).collect();
            assert!(times.len() >= 100, "{name}: {} of 200 times", times.len());
            for time in times {
                let off = body.position(time).distance(track.position(time));
                assert!(off <= most, "{name}: {} is off by {off} m at {time}", track.name);
                let turned = body.orientation(time).angle_between(track.orientation(time)).to_degrees();
                assert!(turned <= 0.03, "{name}: {} is turned by {turned} degrees at {time}", track.name);
            }
            let (all, kept) = (keys.len(), body.keys());
            let falls = track.pieces.iter().any(|piece| piece.acceleration != DVec3::ZERO);
            assert!(kept <= all || falls, "{name}: {} has {kept} keys, more than {all}", track.name);
        }
    }
}

#[test]
fn several_clips_share_what_they_show() {
    let first = tumbling();
    let mut second = first.clone();
    second.motion.tracks.retain(|track| track.name != "pin_0");
    second.motion.tracks[1].shape = Shape::Sphere { radius: 0.07, holes: true }.into();
    let mut writer = glb::Writer::default();
    for (name, animation) in [("one", &first), ("two", &second)] {
        let cut = Cut::new(60.0, None, animation).unwrap();
        writer.add(&Clip::new(animation, &Label::new(name), cut)).unwrap();
    }
    let bytes = writer.finish().unwrap();
    let gltf = gltf::Gltf::from_slice(&bytes).unwrap();
    let names: Vec<&str> = gltf.nodes().map(|node| node.name().unwrap()).collect();
    assert_eq!(names, ["table", "die_0", "pin_0", "ball_0", "plaus"]);
    let clips: Vec<&str> = gltf.animations().map(|clip| clip.name().unwrap()).collect();
    assert_eq!(clips, ["one", "two"]);
    let scales: Vec<(String, f32)> = gltf
        .animations()
        .flat_map(|clip| clip.channels().collect::<Vec<_>>())
        .filter(|channel| channel.target().property() == gltf::animation::Property::Scale)
        .map(|channel| {
            let reader = channel.reader(|_| gltf.blob.as_deref());
            let Some(gltf::animation::util::ReadOutputs::Scales(mut scales)) = reader.read_outputs() else { panic!() };
            (channel.target().node().name().unwrap().to_owned(), scales.next().unwrap()[0])
        })
        .collect();
    let of = |name: &str| scales.iter().filter(|(node, _)| node == name).map(|(_, scale)| *scale).collect::<Vec<_>>();
    assert_eq!(of("pin_0"), [0.0], "not there in the second");
    assert_eq!(of("ball_0").len(), 1);
    assert!((of("ball_0")[0] - 1.4).abs() < 1e-6);
    assert!(of("die_0").is_empty());
}

#[test]
fn contact_heights_are_exact_at_impacts() {
    for (name, animation) in animations() {
        let (glb, cut) = written(&animation, None, Between::Exact);
        let mut seen = 0;
        for track in &animation.motion.tracks {
            let (body, keys) = (glb.body(&track.name), of_track(&animation, track, &cut));
            for hit in animation.motion.impacts.iter().filter(|hit| hit.involves(&track.name)) {
                let key =
                    body.key_at(hit.time).unwrap_or_else(|| panic!("{name}: no key at the impact at {} s", hit.time));
                // Impacts that are too close for single-precision times to tell apart share a key.
                let at_once = |other: &&Key| other.time as f32 == hit.time as f32;
                let mut heights = keys.iter().filter(at_once).map(|key| key.position.y as f32);
                assert!(heights.any(|height| key.y == height), "{name}: the height at {} s, to the last bit", hit.time);
                seen += 1;
            }
        }
        assert!(seen > 0, "{name}: impacts");
    }
}

/// The wrong twin: impacts that are postponed to the next frame are told apart from exact ones.
#[test]
fn impacts_postponed_to_frames_are_caught() {
    let exact = tumbling();
    let (mut late, hit) = (exact.clone(), &exact.motion.impacts[0]);
    let track = exact.motion.tracks.iter().position(|track| track.name == hit.body).unwrap();
    let pieces = &mut late.motion.tracks[track].pieces;
    pieces[1].start = (60.0 * hit.time).ceil() / 60.0;
    pieces[1].position = pieces[0].position(pieces[1].start);
    late.motion.impacts[0].time = pieces[1].start;
    let body = written(&late, None, Between::Exact).0.body(&hit.body);
    assert!(body.key_at(hit.time).is_none(), "no key where bodies touch");
    let off = body.position(0.6).distance(exact.motion.tracks[track].position(0.6));
    assert!(off > 1e-3 * size(&exact), "{off} m");
}

#[test]
fn facts_are_extras_and_nodes_have_their_names() {
    let animation = tumbling();
    let mut label = Label::new("sample_3_14");
    label.facts.insert("log_p".into(), (-1.25).into());
    label.facts.insert("sample".into(), "3:14".into());
    let cut = Cut::new(30.0, None, &animation).unwrap();
    let glb = Glb::read(&glb::to_vec(&Clip::new(&animation, &label, cut)).unwrap());
    assert_eq!(glb.names(), ["table", "die_0", "pin_0", "ball_0", "sample_3_14"]);
    assert_eq!(glb.extras(), r#"{"log_p":-1.25,"sample":"3:14"}"#);
    assert!(DQuat::IDENTITY.dot(glb.body("ball_0").orientation(0.4)).abs() < 0.999, "the ball rolls");
}

#[test]
fn animations_without_bodies_or_motion_are_files_too() {
    for animation in [Animation::new(0.0, vec![], vec![]), Animation::new(0.0, tumbling().motion.tracks, vec![])] {
        let (glb, _) = written(&animation, None, Between::Linear);
        assert_eq!(glb.names().len(), animation.motion.tracks.len() + 1);
    }
}

/// How far a body may jump where a piece begins, in m, and by which angle. Coming to rest lays it flat, and lifts it
/// out of overlaps of up to the preset's gap, at most 1e-4 of its size. A body of revolution that wobbles on the rim of
/// its foot comes to rest if it has less energy than the preset's `rest_speed` (3e-2) stands for: `rest_speed²/2` of
/// its radius in height, so it turns by at most that over the radius of the foot.
fn jumps(shape: &Shape, comes_to_rest: bool) -> [f64; 2] {
    let small = [1e-4 * shape.reach(), 1e-4 + 3e-8];
    let Shape::Revolution { profile, .. } = shape else { return small };
    if !comes_to_rest {
        return small;
    }
    let height = 0.5 * 3e-2 * 3e-2 * profile.iter().map(|&[radius, _]| radius).fold(0.0, f64::max);
    let foot = profile[0][0];
    assert!(foot > 0.1 * shape.reach(), "a pin has a foot: {foot}");
    [small[0] + height, small[1] + height / foot]
}

/// Every piece of a motion ends where the next begins, but for what coming to rest may change. Pieces with a wrong
/// velocity would leave the gaps of a whole step, hundreds of times as wide.
#[test]
fn motion_has_no_gaps() {
    for name in NAMES {
        for animation in from_prior(name, 6) {
            for track in &animation.motion.tracks {
                for pair in track.pieces.windows(2) {
                    let [piece, next] = [&pair[0], &pair[1]];
                    let [most, most_turn] = jumps(&track.shape, next.rests());
                    let jump = piece.position(next.start).distance(next.position);
                    let turned = piece.orientation(next.start).angle_between(next.turn.orientation);
                    assert!(jump <= most, "{name}, {} at {}: {jump:e} m", track.name, next.start);
                    assert!(turned <= most_turn, "{name}, {} at {}: {turned:e} rad", track.name, next.start);
                }
            }
        }
    }
}

/// A ball that appears at 0.5 s is hidden until then, and a clip that begins later shows it from the start.
#[test]
fn what_appears_is_hidden_before() {
    let fall = |start| Piece::ballistic(start, DVec3::Y, DVec3::ZERO, DVec3::new(0.0, -9.81, 0.0));
    let tracks = [0.0, 0.5].map(|start| {
        Track::new(format!("at {start}"), Shape::ball(0.1), Look::nth(0), vec![fall(start)]).appearing(start > 0.0)
    });
    let animation = Animation::new(1.0, tracks.to_vec(), vec![]);
    let label = Label::new("late");
    let as_format = |name: &str, range| {
        let cut = Cut::new(10.0, range, &animation).unwrap();
        let (mut out, mut file) = (Vec::new(), format::named(name).unwrap().begin(Path::new("late.x")));
        file.add(&Clip::new(&animation, &label, cut), &mut out).unwrap();
        file.finish(&mut out).unwrap();
        out
    };
    let scales = |name: &str, range| Glb::read(&as_format("glb", range)).body(name).scales;
    assert_eq!(scales("at 0.5", None), [(0.0, Vec3::ZERO), (0.5, Vec3::ONE)]);
    assert!(scales("at 0", None).is_empty() && scales("at 0.5", Some((0.6, 1.0))).is_empty());
    let text = |name: &str, range| String::from_utf8(as_format(name, range)).unwrap();
    let usda = text("usda", None);
    assert_eq!(usda.matches("token visibility.timeSamples").count(), 1);
    assert!(usda.contains("0: \"invisible\",\n") && usda.contains("12: \"inherited\",\n"), "{usda}");
    assert!(!text("usda", Some((0.6, 1.0))).contains("invisible"));
    let poses = text("poses", None);
    let first = poses.lines().find(|row| row.contains(",at 0.5,")).unwrap();
    assert!(first.contains(",0.5,at 0.5,0.0,1.0,0.0,"), "{first}");
    assert_eq!(poses.lines().filter(|row| row.contains(",at 0,")).count(), 11);
}
