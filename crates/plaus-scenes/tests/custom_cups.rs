//! Cups in users' worlds: what they weigh, and that they hold what falls into them.

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::custom::Custom;
use plaus_scenes::{Scenario, Scene, World};
use std::f64::consts::TAU;

fn read(text: &str) -> Result<Custom, String> {
    let scenario = Scenario::read("cup.toml", text, &[]).map_err(|error| error.to_string())?;
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).map_err(|error| error.to_string())
}

/// Volume, first and second moments along z, and second moment about z, of what is between two heights, for a regular
/// polygon of 12 corners whose radius is linear in the height. A polygon with corners at R has the area 6 R² sin θ with
/// θ = 30°, and the polar moment area · R² (2 + cos θ) / 6. Three Gauss points are exact up to the fifth power.
fn moments([from, to]: [f64; 2], radius: impl Fn(f64) -> f64) -> [f64; 4] {
    let (angle, root) = (TAU / 12.0, 0.6_f64.sqrt());
    let (mut sums, half) = ([0.0; 4], 0.5 * (to - from));
    for (node, weight) in [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)] {
        let z = from + half * (1.0 + node);
        let square = radius(z) * radius(z);
        let area = weight * half * 6.0 * angle.sin() * square;
        let of = [area, area * z, area * z * z, area * square * (2.0 + angle.cos()) / 6.0];
        sums.iter_mut().zip(of).for_each(|(sum, one)| *sum += one);
    }
    sums
}

/// Mass, height of the centre of gravity above the foot, and moments of inertia across and along the axis, of a cup of
/// these sizes in m and of 1000 kg/m³ whose base has a thickness of its own.
fn weighed([rim, foot, height, thickness]: [f64; 4], base: f64) -> [f64; 4] {
    let outer = |z: f64| foot + (rim - foot) * z / height;
    let full = moments([0.0, height], outer);
    let hollow = moments([base, height], |z| outer(z) - thickness);
    let [volume, first, second, polar] = [0, 1, 2, 3].map(|k| 1e3 * (full[k] - hollow[k]));
    let centre = first / volume;
    [volume, centre, 0.5 * polar + second - volume * centre * centre, polar]
}

#[test]
fn a_cup_weighs_what_its_walls_and_base_weigh() {
    for [rim, foot, height, thickness] in [[40.0, 40.0, 90.0, 4.0], [45.0, 30.0, 100.0, 3.0], [20.0, 60.0, 25.0, 10.0]]
    {
        let text = format!(
            "[world.custom]\n[[world.custom.materials]]\nname = 'clay'\ndensity = 1000\n\
             [[world.custom.bodies]]\nname = 'cup'\nmaterial = 'clay'\nat_mm = [0, 0, {}]\nshape = {{ cup = {{ \
             radius_mm = {rim}, foot_mm = {foot}, height_mm = {height}, thickness_mm = {thickness} }} }}\n",
            500.0 + 0.5 * height
        );
        let scene = read(&text).unwrap();
        let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
        let cup = scene.physics(&draw).unwrap().unwrap().bodies.remove(0);
        let mut found = [cup.moments.x, cup.moments.y, cup.moments.z];
        found.sort_by(f64::total_cmp);
        let metres = [rim, foot, height, thickness].map(|size| 1e-3 * size);
        let off = |base: f64| {
            let [mass, centre, across, along] = weighed(metres, base);
            let mut expected = [across, across, along];
            expected.sort_by(f64::total_cmp);
            let moments = found.iter().zip(expected).map(|(found, expected)| (found / expected - 1.0).abs());
            moments.fold((cup.mass / mass - 1.0).abs(), f64::max).max((cup.at.y - 0.5 - centre).abs() / metres[2])
        };
        // Sums of 13 pieces, each rounded.
        assert!(off(metres[3]) < 1e-10, "{}", off(metres[3]));
        // A cup without a bottom weighs less.
        assert!(off(0.0) > 1e-3, "{}", off(0.0));
    }
}

/// How far from the axis of what stands at the origin, and how high above the floor, a ball of 8 mm ends that falls
/// onto it near its middle, in mm.
fn ends(cup: &str, nth: u64) -> [f64; 2] {
    let text = format!(
        "[world.custom]\nduration_s = 3\n[[world.custom.fixed]]\nname = 'floor'\nshape = {{ plane = {{}} }}\n{cup}\n\
         [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 8 }} }}\n\
         at_mm = [{{ uniform = [-20, 20] }}, {{ uniform = [-20, 20] }}, 250]\n\
         velocity_m_s = [{{ normal = [0, 0.05] }}, {{ normal = [0, 0.05] }}, 0]\n"
    );
    let scene = read(&text).unwrap();
    let draw = scene.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
    let motion = scene.motion(&draw).unwrap();
    let track = |name: &str| motion.tracks.iter().find(|track| track.name == name).map(|track| track.position(3.0));
    let ball = track("ball").unwrap() - track("cup").unwrap_or_default().with_y(0.0);
    [ball.with_y(0.0).length() * 1e3, ball.y * 1e3]
}

#[test]
fn a_ball_that_falls_into_a_cup_stays_in_it() {
    let cup = "cup = { radius_mm = 45, foot_mm = 35, height_mm = 100, thickness_mm = 4 }";
    let solid = "cylinder = { radius_mm = 45, height_mm = 100 }";
    let fixed =
        |shape: &str| format!("[[world.custom.fixed]]\nname = 'cup'\nat_mm = [0, 0, 50]\nshape = {{ {shape} }}\n");
    let body = |shape: &str| {
        format!(
            "[[world.custom.bodies]]\nname = 'cup'\nat_mm = [0, 0, 50]\nvelocity_m_s = [0, 0, 0]\nshape = {{ {shape} }}\n"
        )
    };
    // Within the wall, and on the base: its middle 12 mm above the floor, or higher where it still hops.
    let is_in = |[off, up]: [f64; 2]| off < 35.0 && (11.9..80.0).contains(&up);
    for nth in 0..8 {
        for held in [ends(&fixed(cup), nth), ends(&body(cup), nth)] {
            assert!(is_in(held), "draw {nth}: {held:?}");
        }
        let twin = ends(&fixed(solid), nth);
        assert!(!is_in(twin), "draw {nth}: a solid held it: {twin:?}");
    }
}

/// On a slope that is too steep to slide on, a cup tips over once its centre of gravity is not above its foot any more:
/// it has a corner downhill. The edges beside it are nearer by 3.4 %.
#[test]
fn a_cup_tips_over_where_its_foot_ends() {
    let [rim, foot, height, thickness] = [40.0, 30.0, 90.0, 4.0];
    let [_, centre, ..] = weighed([rim, foot, height, thickness].map(|size| 1e-3 * size), 1e-3 * thickness);
    let stands = |share: f64| {
        let angle = (share * 1e-3 * foot / centre).atan();
        let (turn, [x, z]) = (angle.to_degrees(), [angle.sin(), angle.cos()].map(|part| 0.5 * height * part));
        let text = format!(
            "[world.custom]\nduration_s = 3\n[[world.custom.materials]]\nname = 'rubber'\nfriction = 4\n\
             [[world.custom.fixed]]\nname = 'floor'\nmaterial = 'rubber'\nturn_deg = [0, {turn}, 0]\n\
             shape = {{ plane = {{}} }}\n[[world.custom.bodies]]\nname = 'cup'\nmaterial = 'rubber'\n\
             at_mm = [{x}, 0, {z}]\nturn_deg = [0, {turn}, 0]\nshape = {{ cup = {{ radius_mm = {rim}, \
             foot_mm = {foot}, height_mm = {height}, thickness_mm = {thickness} }} }}\n"
        );
        let scene = read(&text).unwrap();
        let motion = scene.motion(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
        let [start, end] = [0.0, 3.0].map(|time| motion.tracks[0].orientation(time));
        start.angle_between(end) < 0.01
    };
    assert!(stands(0.98) && stands(0.5) && !stands(1.02));
}

#[test]
fn walls_are_thinner_than_the_cup_is_wide() {
    let cup = |thickness: &str| {
        let text = "[world.custom]\n[[world.custom.bodies]]\nname = 'cup'\nat_mm = [0, 0, 90]\nshape = { cup = { \
                    radius_mm = 40, foot_mm = 30, height_mm = 50, thickness_mm = T } }\n";
        read(&text.replace('T', thickness))
    };
    cup("29.9").unwrap();
    for (thick, key) in [("30", "foot_mm` only 30"), ("{ uniform = [1, 31] }", "foot_mm"), ("60", "radius_mm")] {
        let error = cup(thick).unwrap_err();
        assert!(
            error.contains("bodies[0].shape.cup.thickness_mm: nothing is hollow") && error.contains(key),
            "{error}"
        );
    }
}
