//! What is drawn of shapes.

use super::*;
use glam::DVec3;

/// Six times the volume that triangles enclose, where they look outwards.
fn volume((vertices, triangles): &(Vec<DVec3>, Vec<[u32; 3]>)) -> f64 {
    let corner = |k: u32| vertices[k as usize];
    let of = |[a, b, c]: &[u32; 3]| corner(*a).dot(corner(*b).cross(corner(*c)));
    triangles.iter().map(of).sum::<f64>() / 6.0
}

/// What is drawn has the volume of what is simulated, but for the corners of circles.
#[test]
fn what_is_drawn_is_what_is_simulated() {
    let pieces = "
        { shape = { hull = HULL }, at_mm = [0, 5, -3], turn_deg = [40, 0, 30] },
        { shape = { cone = { radius_mm = 20, height_mm = 50 } }, at_mm = [100, 5, -3], turn_deg = [70, 0, 30] },
        { shape = { box = { size_mm = [20, 30, 40] } }, at_mm = [-100, 5, -3], turn_deg = [10, 0, 30] }";
    let outline = "[[10, 16], [40, 20], [70, 12], [90, 14]]";
    for said in [
        &format!("compound = {{ pieces = [{pieces}] }}"),
        "ball = { radius_mm = 20 }",
        "box = { size_mm = [20, 30, 40] }",
        "cylinder = { radius_mm = 20, height_mm = 5 }",
        "cone = { radius_mm = 20, height_mm = 50 }",
        "capsule = { radius_mm = 10, length_mm = 40 }",
        "ellipsoid = { size_mm = [20, 30, 40] }",
        &format!("revolution = {{ foot_mm = 10, rim_mm = 3, outline_mm = {outline}, top_mm = 106 }}"),
        "die = { sides = 12, size_mm = 20 }",
        "cup = { radius_mm = 40, foot_mm = 30, height_mm = 90, thickness_mm = 4 }",
        "hull = HULL",
    ] {
        let said = said.replace("HULL", "{ points_mm = [[0, 0, 0], [30, 0, 0], [0, 20, 0], [0, 0, 50]] }");
        let shape: Shape = toml::from_str(&said).unwrap();
        let mut collector = Collector::default();
        let form = shape.read(&mut Reader::new(&mut collector, &Owner::new("one", "bodies[0]"))).unwrap();
        let made = form.make(&collector.works().numbers(None)).unwrap();
        let drawn = volume(&made.drawn.surface());
        let solid = made.solid.mass_properties(1.0).mass;
        // A polygon of 48 corners has 0.3 % less area than its circle, an arc of 8 chords 0.6 % less.
        assert!((drawn / solid - 1.0).abs() < 0.02, "{said}: {drawn} {solid}");
        assert!((made.drawn.reach() / made.solid.reach() - 1.0).abs() < 1e-9, "{said}");
    }
}
