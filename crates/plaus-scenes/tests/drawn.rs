//! How a table with bumps is drawn: without a gap to the block around it, where the dice touch it, and below what was
//! spilt on it; and the colours of scenery.

use glam::DVec3;
use plaus_dist::Seed;
use plaus_mcmc::Chain;
use plaus_scenes::animation::{Animation, Form};
use plaus_scenes::{Scenario, Scene};

/// Throws of one die onto random tables with a puddle.
fn thrown() -> impl Iterator<Item = Animation> {
    let text = include_str!("../../../scenarios/dice-one.toml");
    let spilt = ["world.dice.spilt.radius_mm=60".to_owned()];
    let scenario = Scenario::read("dice-one.toml", text, &spilt).unwrap();
    let scene = scenario.stage().unwrap();
    let moves = scene.moves(&scenario.sampler.rules).unwrap();
    (0..6).map(move |seed| {
        let chain = Chain::start(&scene, &moves, Seed(seed).chain(0)).unwrap();
        scene.animate(&chain.state().draw).unwrap()
    })
}

fn form<'a>(animation: &'a Animation, name: &str) -> &'a Form {
    &animation.scenery.iter().find(|prop| prop.name == name).unwrap().form
}

/// The height of the block's top.
fn top(animation: &Animation) -> f64 {
    let Form::Block { centre, half, .. } = form(animation, "table") else { panic!() };
    centre.y + half.y
}

/// The height of the bumps that is drawn at a place, which is straight between its four neighbours, or that of the
/// block; and how far the place is from the border of the bumps, in m.
fn drawn(animation: &Animation, x: f64, z: f64) -> (f64, f64) {
    let Form::Heightfield { origin, step, columns, heights } = form(animation, "surface") else { panic!() };
    let columns = *columns as usize;
    let rows = heights.len() / columns;
    let (u, v) = ((x - origin.x) / step[0], (z - origin.z) / step[1]);
    let (right, below) = ((columns - 1) as f64 - u, (rows - 1) as f64 - v);
    let inside = (u.min(right) * step[0]).min(v.min(below) * step[1]);
    if inside < 0.0 {
        return (top(animation), inside);
    }
    let [i, j] = [u.min((columns - 2) as f64), v.min((rows - 2) as f64)].map(|at| at.floor() as usize);
    let (s, t) = (u - i as f64, v - j as f64);
    let at = |i: usize, j: usize| heights[j * columns + i];
    let along = |j: usize| (1.0 - s) * at(i, j) + s * at(i + 1, j);
    (origin.y + (1.0 - t) * along(j) + t * along(j + 1), inside)
}

/// Where bumps end, they are as high as the block around them, so no gap casts a shadow; where a die touches the table,
/// they are as high as the simulator says. Bumps of 0.1 mm on a grid of 8 mm differ from straight lines between points
/// 8/3 mm apart by less than 0.01 mm. Where a face strikes with several corners at once, some of them only come near.
#[test]
fn bumps_end_on_the_block_and_are_where_dice_touch() {
    let (mut touched, mut near) = (0, 0);
    for animation in thrown() {
        let Form::Heightfield { origin, columns, heights, .. } = form(&animation, "surface") else { panic!() };
        let (columns, top) = (*columns as usize, top(&animation));
        let rows = heights.len() / columns;
        for (k, height) in heights.iter().enumerate() {
            let (i, j) = (k % columns, k / columns);
            if i == 0 || j == 0 || i == columns - 1 || j == rows - 1 {
                assert!((origin.y + height - top).abs() < 1e-12, "{i} {j}: {height}, {top}");
            }
        }
        for hit in animation.motion.impacts.iter().filter(|hit| hit.other == "table") {
            let (height, inside) = drawn(&animation, hit.point.x, hit.point.z);
            if inside > 0.015 {
                near += u32::from((height - hit.point.y).abs() < 1e-5);
                touched += 1;
            }
        }
    }
    assert!(touched > 30 && 10 * near > 9 * touched, "{near} of {touched} touch what is drawn");
}

/// What was spilt is above the table everywhere: its film is 0.1 mm thick, and both are straight between points of
/// their own.
#[test]
fn a_puddle_covers_the_bumps() {
    for animation in thrown() {
        let Form::Mesh { vertices, triangles } = form(&animation, "spilt") else { panic!() };
        for triangle in triangles {
            let corners = triangle.map(|corner| vertices[corner as usize]);
            for weights in [[1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [4.0, 1.0, 1.0]] {
                let sum: f64 = weights.iter().sum();
                let point: DVec3 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight / sum).sum();
                let (height, _) = drawn(&animation, point.x, point.z);
                assert!(point.y > height + 3e-5, "{point}: the table is at {height}");
            }
        }
    }
}

/// Scenery without colours of its own: neighbours are told apart, the members of an array are alike, and what has a
/// colour keeps it.
#[test]
fn neighbouring_scenery_has_different_colours() {
    let text = "[[world.custom.fixed]]\nname = 'floor'\nshape = { plane = {} }\n\
        [[world.custom.fixed]]\nname = 'peg'\ncount = 2\nshape = { box = { size_mm = [9, 9, 9] } }\n\
        at_mm = ['50 * i', 0, 5]\n\
        [[world.custom.fixed]]\nname = 'wall'\ncolour = '#102030'\nshape = { box = { size_mm = [9, 9, 9] } }\n\
        at_mm = [300, 0, 5]\n\
        [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 5 } }\nat_mm = [0, 200, 50]\n";
    let scenario = Scenario::read("a.toml", text, &[]).unwrap();
    let scene = scenario.stage().unwrap();
    let moves = scene.moves(&scenario.sampler.rules).unwrap();
    let chain = Chain::start(&scene, &moves, Seed(1).chain(0)).unwrap();
    let animation = scene.animate(&chain.state().draw).unwrap();
    let looks: Vec<_> = animation.scenery.iter().map(|prop| prop.look.colour.0).collect();
    assert_eq!(looks.len(), 4);
    assert!(looks[0] != looks[1] && looks[1] == looks[2], "{looks:?}");
    assert_eq!(looks[3], [0x10, 0x20, 0x30]);
}
