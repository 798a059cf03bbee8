//! The visible parts of the alley: lane, gutters, kickbacks and pit.

use super::alley::{Alley, END, INCH};
use crate::animation::upright;
use crate::animation::{Look, Material, Prop};
use glam::DVec3;

/// Inside of the kickbacks, from the lane's middle.
const WALL: f64 = 0.5 * Alley::WIDTH + 9.3125 * INCH;
/// Where the deeper gutters beside the deck begin.
const DECK: f64 = -24.0 * INCH;
/// The cushion behind the pit.
const BACK: f64 = 66.0 * INCH;

const DARK: Look = Look::new([48, 50, 58], Material::Matte);
const ARROW: Look = Look::new([120, 70, 40], Material::Wood);

/// Two corners of the box around the deck, what is just before it, and the pit into which pins fall.
pub(super) fn deck() -> [DVec3; 2] {
    [DVec3::new(-WALL, -0.25, -0.1), DVec3::new(WALL, 0.8 * BACK, 0.35)]
}

/// All scenery.
pub(super) fn props() -> Vec<Prop> {
    let half = 0.5 * Alley::WIDTH;
    let block = |name: &str, look, low: [f64; 3], high: [f64; 3]| {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        Prop::block(name, look, upright(0.5 * (low + high)), upright(0.5 * (high - low)).abs())
    };
    let foul = -Alley::LENGTH;
    let mut props = vec![
        block("lane", Look::WOOD, [-half, foul, -0.1], [half, END, 0.0]),
        block("foul_line", DARK, [-half, foul - 0.02, -0.1], [half, foul, 0.001]),
        block("pit", DARK, [-WALL, END, -0.3], [WALL, BACK, -0.254]),
        block("cushion", DARK, [-WALL, BACK, -0.3], [WALL, BACK + 0.03, 0.6]),
    ];
    for (side, name) in [(-1.0, "left"), (1.0, "right")] {
        let across = |a: f64, b: f64| if side < 0.0 { (-b, -a) } else { (a, b) };
        let (low, high) = across(half, WALL);
        props.push(block(&format!("gutter_{name}"), DARK, [low, foul, -0.12], [high, DECK, -1.875 * INCH]));
        props.push(block(&format!("flat_gutter_{name}"), DARK, [low, DECK, -0.12], [high, END, -3.5 * INCH]));
        let (low, high) = across(WALL, WALL + 0.03);
        props.push(block(&format!("kickback_{name}"), Look::STONE, [low, DECK, -0.3], [high, BACK, 0.6]));
    }
    // The arrows that bowlers aim by: seven boards, five apart, about 15 ft from the foul line.
    for arrow in -3..=3_i32 {
        let (x, y) = (f64::from(arrow) * 5.0 * Alley::WIDTH / 39.0, foul + 4.8 - 0.25 * f64::from(arrow.abs()));
        props.push(block(
            &format!("arrow_{}", arrow + 4),
            ARROW,
            [x - 0.012, y - 0.08, 0.0],
            [x + 0.012, y + 0.08, 0.0005],
        ));
    }
    props
}

/// Name of the scenery that is hit at a point with this normal.
pub(super) fn part(point: DVec3, normal: DVec3) -> &'static str {
    if normal.z > 0.5 {
        let on_lane = point.x.abs() <= 0.5 * Alley::WIDTH && point.y <= END;
        if point.y > END {
            "pit"
        } else if on_lane {
            "lane"
        } else {
            match (point.y < DECK, point.x < 0.0) {
                (true, true) => "gutter_left",
                (true, false) => "gutter_right",
                (false, true) => "flat_gutter_left",
                (false, false) => "flat_gutter_right",
            }
        }
    } else if normal.y < -0.5 && point.y > END {
        "cushion"
    } else if point.x.abs() > 0.5 * Alley::WIDTH + 0.1 {
        if point.x < 0.0 { "kickback_left" } else { "kickback_right" }
    } else {
        "lane"
    }
}
