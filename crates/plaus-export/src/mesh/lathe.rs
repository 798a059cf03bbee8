//! Bodies of revolution about the third axis.

use super::{Mesh, Part};
use glam::{DVec2, DVec3};
use plaus_animation::{Look, Stripe};
use plaus_dist::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Corners around the axis.
const AROUND: u32 = 32;
/// Corners from pole to pole of a sphere.
const ALONG: u32 = 18;
/// Corners along the rounded edge of a coin, a quarter circle.
const EDGE: u32 = 4;
/// Neighbouring parts of a profile meet at a sharp edge if the cosine of their angle is below this.
const SMOOTH: f64 = 0.8;

/// A texture from the lower end to the upper.
const WHOLE: [f64; 2] = [0.0, 1.0];

/// A point of a profile with the surface's normal there: both are (distance from the axis, height).
type Rim = (DVec2, DVec2);

pub(super) fn sphere(radius: f64) -> Mesh {
    let rims = (0..=ALONG).map(|k| {
        let (sin, cos) = sin_cos(PI * f64::from(k) / f64::from(ALONG));
        let normal = DVec2::new(if k == 0 || k == ALONG { 0.0 } else { sin }, -cos);
        (radius * normal, normal)
    });
    turned(&rims.collect::<Vec<_>>(), WHOLE)
}

/// A coin with rounded edges.
pub(super) fn coin(radius: f64, thickness: f64) -> Mesh {
    let bend = (0.25 * thickness).min(0.25 * radius);
    let (flat, half) = (radius - bend, 0.5 * thickness - bend);
    let mut rims = vec![(DVec2::new(0.0, -0.5 * thickness), DVec2::NEG_Y)];
    for side in [-1.0, 1.0] {
        for k in 0..=EDGE {
            let quarter = FRAC_PI_2 * f64::from(k) / f64::from(EDGE);
            let (sin, cos) = sin_cos(if side < 0.0 { quarter - FRAC_PI_2 } else { quarter });
            let normal = DVec2::new(cos, sin);
            rims.push((DVec2::new(flat, side * half) + bend * normal, normal));
        }
    }
    rims.push((DVec2::new(0.0, 0.5 * thickness), DVec2::Y));
    turned(&rims, WHOLE)
}

/// A profile from its lowest height to its highest, closed at both ends, with painted rings.
pub(super) fn striped(profile: &[[f64; 2]], stripes: &[Stripe], look: Look) -> Vec<Part> {
    let mut points: Vec<DVec2> = profile.iter().map(|&point| DVec2::from(point)).collect();
    if let (Some(&first), Some(&last)) = (points.first(), points.last()) {
        let axis = |point: DVec2| (point.x > 0.0).then_some(DVec2::new(0.0, point.y));
        points = axis(first).into_iter().chain(points).chain(axis(last)).collect();
    }
    let mut edges: Vec<f64> = stripes.iter().flat_map(|stripe| [stripe.from, stripe.to]).collect();
    edges.sort_by(f64::total_cmp);
    let segments = segments(&points, &edges);
    let paint = |height: f64| stripes.iter().find(|stripe| stripe.from < height && height < stripe.to);
    let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.y), b.max(p.y)));
    let size = (high - low).max(f64::MIN_POSITIVE);
    let mut parts: Vec<Part> = Vec::new();
    for [(a, na), (b, nb)] in segments {
        let look = paint(0.5 * (a.y + b.y)).map_or(look, |stripe| stripe.look);
        let ring = turned(&[(a, na), (b, nb)], [a.y, b.y].map(|height| (height - low) / size));
        match parts.iter_mut().find(|part| part.look == look) {
            Some(part) => append(&mut part.mesh, &ring),
            None => parts.push(Part { look, mesh: ring }),
        }
    }
    parts
}

/// The profile's straight parts with normals at both ends, cut at the heights `edges`.
fn segments(points: &[DVec2], edges: &[f64]) -> Vec<[Rim; 2]> {
    let straight: Vec<[DVec2; 2]> =
        points.windows(2).map(|pair| [pair[0], pair[1]]).filter(|[a, b]| a.distance(*b) > 0.0).collect();
    // On the way up the profile, outwards is to the right.
    let outward = |[a, b]: [DVec2; 2]| -(b - a).perp().normalize();
    let mut segments = Vec::new();
    for (index, &[a, b]) in straight.iter().enumerate() {
        let own = outward([a, b]);
        let shared = |neighbour: Option<&[DVec2; 2]>| match neighbour.map(|&pair| outward(pair)) {
            Some(other) if other.dot(own) > SMOOTH => (own + other).normalize(),
            _ => own,
        };
        let (na, nb) = (shared(index.checked_sub(1).and_then(|i| straight.get(i))), shared(straight.get(index + 1)));
        let cuts = edges.iter().map(|edge| (edge - a.y) / (b.y - a.y)).filter(|share| *share > 0.0 && *share < 1.0);
        let shares: Vec<f64> = std::iter::once(0.0).chain(cuts).chain([1.0]).collect();
        let rim = |share: f64| (a.lerp(b, share), na.lerp(nb, share).normalize_or(own));
        segments.extend(shares.windows(2).map(|pair| [rim(pair[0]), rim(pair[1])]));
    }
    segments
}

/// Turns a profile about the axis. `heights` are its ends on the texture, from 0 at the lower edge to 1.
fn turned(rims: &[Rim], heights: [f64; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    let lengths: Vec<f64> = rims.windows(2).map(|pair| pair[0].0.distance(pair[1].0)).collect();
    let whole: f64 = lengths.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    for (number, &(place, normal)) in rims.iter().enumerate() {
        let along = lengths[..number].iter().sum::<f64>() / whole;
        for k in 0..=AROUND {
            let (sin, cos) = sin_cos(TAU * f64::from(k % AROUND) / f64::from(AROUND));
            let about = |v: DVec2| DVec3::new(v.x * cos, v.x * sin, v.y);
            let up = heights[0] + along * (heights[1] - heights[0]);
            let uv = DVec2::new(f64::from(k) / f64::from(AROUND), 1.0 - up);
            mesh.corner(about(place), about(normal), uv);
        }
    }
    let row = AROUND + 1;
    for (below, pair) in (0..).zip(rims.windows(2)) {
        for k in 0..AROUND {
            let [a, b] = [below * row + k, below * row + k + 1];
            let [c, d] = [a + row, b + row];
            if pair[0].0.x > 0.0 {
                mesh.triangles.push([a, b, d]);
            }
            if pair[1].0.x > 0.0 {
                mesh.triangles.push([a, d, c]);
            }
        }
    }
    mesh
}

fn append(mesh: &mut Mesh, more: &Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&more.positions);
    mesh.normals.extend(&more.normals);
    mesh.uvs.extend(&more.uvs);
    mesh.triangles.extend(more.triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
}
