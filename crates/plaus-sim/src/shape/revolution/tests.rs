use super::*;

#[test]
fn a_regulation_pin() {
    let pin = Revolution::new(&Profile::pin(), 40).unwrap();
    let p = pin.mass_properties(1.0);
    // Maple of about 700 kg/m³ gives 3 lb 6 oz to 3 lb 10 oz (1.53–1.64 kg); the centre of gravity is 5 40/64 to 5
    // 60/64 in high.
    assert!((1.53 / 800.0..1.64 / 600.0).contains(&p.mass), "volume {}", p.mass);
    let inches = pin.balance() / INCH;
    assert!((5.5..6.0).contains(&inches), "centre of gravity at {inches} in");
    assert!(p.inertia.x > 4.0 * p.inertia.z);
}

/// A chess pawn whose top is part of a ball that is larger than its head.
fn pawn() -> Profile {
    let points = [[8.0, 13.0], [16.0, 9.0], [34.0, 8.0], [42.0, 11.0]].map(|point| point.map(|x| 1e-3 * x)).to_vec();
    Profile { foot: 12.5e-3, rim: 1.5e-3, points, top: 50e-3 }
}

/// Compared with a plain sum over 200,000 slices of the same profile; 1e-5 is the error of its midpoint rule at the
/// rim's square root.
#[test]
fn moments_agree_with_a_plain_sum() {
    [Profile::pin(), pawn()].into_iter().for_each(agrees_with_a_plain_sum);
}

fn agrees_with_a_plain_sum(profile: Profile) {
    let pin = Revolution::new(&profile, 40).unwrap();
    let pieces = profile.pieces();
    let [height, edge] = *profile.points.last().unwrap();
    let high = profile.top - height;
    let cap = if high < edge { 0.5 * (edge * edge / high + high) } else { edge };
    let radius = |z: f64| {
        if z < pieces[0].base {
            profile.foot + (profile.rim * profile.rim - (profile.rim - z) * (profile.rim - z)).sqrt()
        } else if z < profile.points.last().unwrap()[0] {
            let p = pieces.iter().rev().find(|p| p.base <= z).unwrap();
            p.radius(z - p.base)
        } else {
            let s = z - (profile.top - cap);
            if s < 0.0 { edge } else { (cap * cap - s * s).sqrt() }
        }
    };
    let n = 200_000;
    let h = profile.top / f64::from(n);
    let (mut v, mut vz, mut vzz, mut quartic) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..n {
        let z = h * (f64::from(k) + 0.5);
        let r2 = radius(z) * radius(z);
        v += PI * r2 * h;
        vz += PI * r2 * z * h;
        vzz += PI * r2 * z * z * h;
        quartic += PI * r2 * r2 * h;
    }
    let p = pin.mass_properties(1.0);
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-5, "{a} for {b}");
    close(p.mass, v);
    close(pin.balance(), vz / v);
    close(p.inertia.z, 0.5 * quartic);
    close(p.inertia.x, 0.25 * quartic + vzz - vz * vz / v);
}

#[test]
fn the_skin_follows_the_profile() {
    let profile = Profile::pin();
    let pin = Revolution::new(&profile, 60).unwrap();
    // At each height of the table, the balls and rings come within 0.3 mm of the table's radius from inside, and
    // nothing sticks out by more than 0.01 mm.
    for &[z, r] in &profile.points[..profile.points.len() - 1] {
        let h = z - pin.balance();
        let balls =
            pin.row().iter().map(|f| (f.radius * f.radius - (h - f.centre.z) * (h - f.centre.z)).max(0.0).sqrt());
        let rings = pin.rings().iter().map(|g| {
            let inside = g.radius * g.radius - (h - g.height) * (h - g.height);
            if inside >= 0.0 { g.circle + inside.sqrt() } else { 0.0 }
        });
        let widest = balls.chain(rings).fold(0.0, f64::max);
        // The flank between rings is left open by up to a millimetre.
        let open = if z < 0.03 { 1e-3 } else { 3e-4 };
        assert!(widest < r + 1e-5 && widest > r - open, "{widest} for {r} at {z}");
    }
    let lowest = pin.row().iter().map(|f| f.centre.z - f.radius).fold(0.0, f64::min);
    assert!(lowest > -pin.balance(), "no ball below the foot");
}

/// Skins of bodies with flat caps reach to the outline and not beyond it: on a fine grid of heights, to a thirtieth of
/// the edge from inside, which is how far rings that touch it leave it open between them, and to a hundredth from
/// outside, which is how far balls that touch a spline stick out where it bends inwards.
#[test]
fn the_skin_of_a_flat_cap_follows_it() {
    for top in [44e-3, 46e-3, 50e-3, 52.9e-3] {
        let profile = Profile { top, ..pawn() };
        let body = Revolution::new(&profile, 40).unwrap();
        let outline = profile.outline(2000).unwrap();
        let edge = profile.points.last().unwrap()[1];
        for [r, z] in outline.into_iter().filter(|at| at[1] > 15e-3) {
            let at = |circle: f64, height: f64, radius: f64| {
                let [dr, dz] = [r - circle, z - body.balance() - height];
                let far = (dr * dr + dz * dz).sqrt();
                radius - far
            };
            let balls = body.row().iter().map(|ball| at(0.0, ball.centre.z, ball.radius));
            let rings = body.rings().iter().map(|ring| at(ring.circle, ring.height, ring.radius));
            let reach = balls.chain(rings).fold(f64::NEG_INFINITY, f64::max);
            assert!(reach < edge / 100.0 && reach > -edge / 30.0, "{reach} at {r} {z}, top {top}");
        }
    }
}

#[test]
fn bad_profiles_are_refused() {
    let good = Profile::pin();
    assert!(Revolution::new(&Profile { foot: 0.0, ..good.clone() }, 40).is_err());
    assert!(Revolution::new(&Profile { top: 0.1, ..good.clone() }, 40).is_err());
    assert!(Revolution::new(&Profile { points: vec![[0.1, 0.1]], ..good }, 40).is_err());
}
