//! What is drawn of shapes.

use super::*;

/// Six times the volume that triangles enclose, where they look outwards.
fn volume((vertices, triangles): &(Vec<DVec3>, Vec<[u32; 3]>)) -> f64 {
    let corner = |k: u32| vertices[k as usize];
    let of = |[a, b, c]: &[u32; 3]| corner(*a).dot(corner(*b).cross(corner(*c)));
    triangles.iter().map(of).sum::<f64>() / 6.0
}

/// What is drawn has the volume of what is simulated, but for the corners of circles.
#[test]
fn what_is_drawn_is_what_is_simulated() {
    let (fixed, works) = (Value::Fixed, Collector::default().works());
    let points = [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 50.0]];
    let piece = |form, x, turned| Piece {
        form,
        at: [fixed(x), fixed(5.0), fixed(-3.0)],
        turn: [fixed(turned), fixed(0.0), fixed(30.0)],
        density: fixed(1.0),
    };
    let hull = || Form::Hull(points.map(|point| point.map(fixed)).to_vec(), fixed(0.0));
    for form in [
        Form::Compound(vec![
            piece(hull(), 0.0, 40.0),
            piece(Form::Cone(fixed(20.0), fixed(50.0)), 100.0, 70.0),
            piece(Form::Box([fixed(20.0), fixed(30.0), fixed(40.0)], fixed(0.0)), -100.0, 10.0),
        ]),
        Form::Ball(fixed(20.0)),
        Form::Box([fixed(20.0), fixed(30.0), fixed(40.0)], fixed(0.0)),
        Form::Cylinder(fixed(20.0), fixed(5.0)),
        Form::Cone(fixed(20.0), fixed(50.0)),
        Form::Capsule(fixed(10.0), fixed(40.0)),
        Form::Revolution(
            [fixed(10.0), fixed(3.0)],
            [[10.0, 16.0], [40.0, 20.0], [70.0, 12.0], [90.0, 14.0]].map(|point| point.map(fixed)).to_vec(),
            fixed(106.0),
        ),
        hull(),
    ] {
        let made = form.make(&works.numbers(None)).unwrap();
        let drawn = volume(&made.drawn.surface());
        let solid = made.solid.mass_properties(1.0).mass;
        // A polygon of 48 corners has 0.3 % less area than its circle, an arc of 8 chords 0.6 % less.
        assert!((drawn / solid - 1.0).abs() < 0.02, "{form:?}: {drawn} {solid}");
        assert!((made.drawn.reach() / made.solid.reach() - 1.0).abs() < 1e-9, "{form:?}");
    }
}
