//! An animation at one moment as balls and triangles.

use glam::{DQuat, DVec3};
use plaus_export::mesh::{self, Mesh, Part};
use plaus_scenes::Animation;
use plaus_scenes::animation::{Form, Look, Shape, Stripe};

/// Something a ray can hit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Thing {
    pub(super) solid: Solid,
    pub(super) look: Look,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Solid {
    Ball {
        centre: DVec3,
        radius: f64,
    },
    /// A corner, the two edges from it, and normals at the corners.
    Triangle {
        corner: DVec3,
        edges: [DVec3; 2],
        normals: [DVec3; 3],
    },
}

impl Solid {
    /// Lowest and highest coordinates.
    pub(super) fn bounds(&self) -> [DVec3; 2] {
        match self {
            Self::Ball { centre, radius } => [*centre - DVec3::splat(*radius), *centre + DVec3::splat(*radius)],
            Self::Triangle { corner, edges, .. } => {
                let all = [*corner, *corner + edges[0], *corner + edges[1]];
                [all[0].min(all[1]).min(all[2]), all[0].max(all[1]).max(all[2])]
            }
        }
    }

    /// How far along the ray it is hit, from `least` on, and the normal there.
    pub(super) fn hit(&self, from: DVec3, along: DVec3, least: f64) -> Option<(f64, DVec3)> {
        match self {
            Self::Ball { centre, radius } => {
                let to = *centre - from;
                let middle = to.dot(along);
                let off = to - middle * along;
                let inside = radius * radius - off.length_squared();
                if inside < 0.0 {
                    return None;
                }
                let half = inside.sqrt();
                let t = if middle - half > least { middle - half } else { middle + half };
                (t > least).then(|| (t, (from + t * along - *centre) / *radius))
            }
            Self::Triangle { corner, edges: [a, b], normals } => {
                // Möller & Trumbore 1997.
                let p = along.cross(*b);
                let det = a.dot(p);
                if det == 0.0 {
                    return None;
                }
                let to = from - *corner;
                let u = to.dot(p) / det;
                let q = to.cross(*a);
                let v = along.dot(q) / det;
                let t = b.dot(q) / det;
                let hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > least;
                hit.then(|| (t, (normals[0] * (1.0 - u - v) + normals[1] * u + normals[2] * v).normalize()))
            }
        }
    }
}

/// The triangles of a body's mesh.
fn placed(mesh: &Mesh, at: DVec3, turned: DQuat) -> impl Iterator<Item = Option<Solid>> {
    let of = move |list: &[[f32; 3]], id: u32| turned * DVec3::from_array(list[id as usize].map(f64::from));
    mesh.triangles.iter().map(move |ids| {
        let [a, b, c] = ids.map(|id| at + of(&mesh.positions, id));
        let normals = ids.map(|id| of(&mesh.normals, id));
        Some(Solid::Triangle { corner: a, edges: [b - a, c - a], normals })
    })
}

fn flat(corners: [DVec3; 3]) -> Option<Solid> {
    let edges = [corners[1] - corners[0], corners[2] - corners[0]];
    let normal = edges[0].cross(edges[1]).try_normalize()?;
    Some(Solid::Triangle { corner: corners[0], edges, normals: [normal; 3] })
}

/// Everything that is there at `time`.
pub(super) fn of(animation: &Animation, time: f64) -> Vec<Thing> {
    let mut things = Vec::new();
    for track in &animation.tracks {
        let (at, turned) = (track.position(time), track.orientation(time));
        match &track.shape {
            Shape::Sphere { radius, .. } | Shape::Disc { radius, .. } => {
                things.push(Thing { solid: Solid::Ball { centre: at, radius: *radius }, look: track.look });
            }
            // Rounded, and with its pips.
            Shape::Cuboid { pips: Some(_), .. } => {
                for Part { look, mesh } in mesh::of_shape(&track.shape, track.look) {
                    add(&mut things, look, placed(&mesh, at, turned));
                }
            }
            Shape::Cuboid { half, pips: None } => add(&mut things, track.look, block(at, *half, turned)),
            Shape::Revolution { profile, stripes } => {
                things.extend(Turned { at, turned, look: track.look }.things(profile, stripes));
            }
        }
    }
    for prop in &animation.scenery {
        match &prop.form {
            Form::Block { centre, half, orientation } => {
                add(&mut things, prop.look, block(*centre, *half, *orientation))
            }
            Form::Plane { centre, normal, half } => {
                let a = normal.any_orthonormal_vector() * *half;
                let b = normal.cross(a);
                let corners = [*centre - a - b, *centre + a - b, *centre + a + b, *centre - a + b];
                add(&mut things, prop.look, [[0, 1, 2], [0, 2, 3]].map(|ids| flat(ids.map(|id| corners[id]))));
            }
            Form::Mesh { vertices, triangles } => {
                let corners = |ids: &[u32; 3]| flat(ids.map(|id| vertices[id as usize]));
                add(&mut things, prop.look, triangles.iter().map(corners));
            }
            Form::Heightfield { origin, step, columns, heights } => {
                add(&mut things, prop.look, field(*origin, *step, *columns as usize, heights));
            }
        }
    }
    things
}

fn add(things: &mut Vec<Thing>, look: Look, solids: impl IntoIterator<Item = Option<Solid>>) {
    things.extend(solids.into_iter().flatten().map(|solid| Thing { solid, look }));
}

/// The lowest height of anything.
pub(super) fn lowest(things: &[Thing]) -> f64 {
    things.iter().map(|thing| thing.solid.bounds()[0].y).fold(f64::INFINITY, f64::min)
}

/// Twelve triangles, counter-clockwise as seen from outside.
fn block(centre: DVec3, half: DVec3, turned: DQuat) -> Vec<Option<Solid>> {
    let corner = |k: usize| {
        let sign = |bit: usize| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
        centre + turned * (half * DVec3::new(sign(0), sign(1), sign(2)))
    };
    const FACES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    FACES.iter().flat_map(|&[a, b, c, d]| [flat([a, b, c].map(corner)), flat([a, c, d].map(corner))]).collect()
}

/// Sides of a drawn body of revolution.
const SIDES: usize = 48;

/// Where a body of revolution is, how it is turned, and how it looks where nothing is painted on it.
struct Turned {
    at: DVec3,
    turned: DQuat,
    look: Look,
}

impl Turned {
    /// Triangles between the profile's points, shaded as if it were smooth; rings that are painted have their paint.
    fn things(&self, profile: &[[f64; 2]], stripes: &[Stripe]) -> Vec<Thing> {
        let edges = stripes.iter().flat_map(|stripe| [stripe.from, stripe.to]);
        let points = with_heights(profile, edges);
        let normals: Vec<[f64; 2]> = (0..points.len())
            .map(|k| {
                let ([r, h], [s, i]) = (points[k.saturating_sub(1)], points[(k + 1).min(points.len() - 1)]);
                [i - h, r - s]
            })
            .collect();
        let mut things = Vec::new();
        for k in 1..points.len() {
            let middle = 0.5 * (points[k - 1][1] + points[k][1]);
            let paint = stripes.iter().find(|stripe| (stripe.from..stripe.to).contains(&middle));
            let look = paint.map_or(self.look, |stripe| stripe.look);
            for side in 0..SIDES {
                let around = [(k - 1, side), (k - 1, side + 1), (k, side + 1), (k, side)];
                let corners = around.map(|(k, side)| self.at + self.along(points[k], side));
                let outwards = around.map(|(k, side)| self.along(normals[k], side).normalize_or(DVec3::Y));
                let half = |[a, b, c]: [usize; 3]| {
                    let edges = [corners[b] - corners[a], corners[c] - corners[a]];
                    let normals = [a, b, c].map(|corner| outwards[corner]);
                    let solid = Solid::Triangle { corner: corners[a], edges, normals };
                    edges[0].cross(edges[1]).try_normalize().map(|_| Thing { solid, look })
                };
                things.extend([[0, 1, 2], [0, 2, 3]].into_iter().filter_map(half));
            }
        }
        things
    }

    /// A vector of the profile's plane, at one of the sides.
    fn along(&self, [radial, axial]: [f64; 2], side: usize) -> DVec3 {
        let (sin, cos) = plaus_dist::math::sin_cos(std::f64::consts::TAU * (side % SIDES) as f64 / SIDES as f64);
        self.turned * DVec3::new(radial * cos, radial * sin, axial)
    }
}

/// A profile with points at more heights.
fn with_heights(profile: &[[f64; 2]], heights: impl Iterator<Item = f64>) -> Vec<[f64; 2]> {
    let mut points = profile.to_vec();
    for height in heights {
        let place = points.partition_point(|point| point[1] < height);
        let (Some(before), Some(after)) = (place.checked_sub(1).map(|k| points[k]), points.get(place).copied()) else {
            continue;
        };
        if after[1] > height {
            let share = (height - before[1]) / (after[1] - before[1]);
            points.insert(place, [before[0] + share * (after[0] - before[0]), height]);
        }
    }
    points
}

/// Two triangles a cell, shaded as if it were smooth.
fn field(origin: DVec3, step: [f64; 2], columns: usize, heights: &[f64]) -> Vec<Option<Solid>> {
    let rows = heights.len() / columns;
    let height = |i: usize, j: usize| heights[j.min(rows - 1) * columns + i.min(columns - 1)];
    let point = |[i, j]: [usize; 2]| origin + DVec3::new(i as f64 * step[0], height(i, j), j as f64 * step[1]);
    let normal = |[i, j]: [usize; 2]| {
        let (before, above) = (i.saturating_sub(1), j.saturating_sub(1));
        let across = point([(i + 1).min(columns - 1), j]) - point([before, j]);
        let down = point([i, (j + 1).min(rows - 1)]) - point([i, above]);
        down.cross(across).normalize()
    };
    let triangle = |ids: [[usize; 2]; 3]| {
        let [a, b, c] = ids.map(point);
        let normals = ids.map(normal);
        Some(Solid::Triangle { corner: a, edges: [b - a, c - a], normals })
    };
    let cells = (1..rows).flat_map(|j| (1..columns).map(move |i| (i - 1, j - 1)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [[i, j], [i, j + 1], [i + 1, j + 1], [i + 1, j]];
            [triangle([a, b, c]), triangle([a, c, d])]
        })
        .collect()
}
