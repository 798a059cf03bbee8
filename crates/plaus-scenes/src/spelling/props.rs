//! The visible parts of the box: partitions with the draw's vertices, bowls, glass walls, and marks in the bins to
//! fill.

use super::Word;
use super::arena::Arena;
use super::bins::Bins;
use super::draw::Drops;
use crate::animation::upright;
use crate::animation::{Form, Look, Prop};
use glam::DVec3;
use plaus_dist::math::square;
use plaus_sim::WorldError;

/// Heights of the bowls along the side of a bin.
const HEIGHTS: usize = 8;

/// All scenery, in metres.
pub(super) fn props(arena: &Arena, word: &Word, draw: &Drops) -> Result<Vec<Prop>, WorldError> {
    let bins = &arena.bins;
    let mut props = vec![Prop::new("partitions", Look::WOOD, partitions(arena, draw)?), floor(bins)];
    props.extend(walls(bins));
    let marks = word.designated().iter().map(|&bin| mark(bins, word, bin));
    props.extend(marks);
    Ok(props)
}

fn partitions(arena: &Arena, draw: &Drops) -> Result<Form, WorldError> {
    let mut mesh = arena.bins.mesh()?;
    let moved: Vec<_> = draw.offsets.iter().enumerate().map(|(k, offset)| arena.moved(k, offset)).collect();
    mesh.move_vertices(&moved)?;
    let corners = (0..mesh.len()).filter_map(|k| mesh.triangle(k)).flatten();
    let vertices: Vec<DVec3> = corners.map(upright).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Ok(Form::Mesh { vertices, triangles })
}

/// The bowls under all bins, as heights over a grid.
fn floor(bins: &Bins) -> Prop {
    let step = bins.side / HEIGHTS as f64;
    let (columns, rows) = (bins.columns * HEIGHTS + 1, bins.rows * HEIGHTS + 1);
    // Relative to the middle of its bin; a line between two bins belongs to either.
    let off = |k: usize| (k % HEIGHTS) as f64 * step - 0.5 * bins.side;
    let height = |x: f64, y: f64| bins.bowl - (square(bins.bowl) - square(x) - square(y)).max(0.0).sqrt();
    let heights =
        (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| height(off(i), off(j))).collect();
    let origin = upright(DVec3::new(0.0, bins.rows as f64 * bins.side, 0.0));
    let form = Form::Heightfield { origin, step: [step, step], columns: columns as u32, heights };
    Prop::new("floor", Look::STONE, form)
}

fn walls(bins: &Bins) -> [Prop; 4] {
    let ((x, y), thick) = (bins.extent(), 0.5 * bins.thickness);
    let wall = |name: &str, centre: DVec3, half: DVec3| {
        let half = upright(half).abs();
        Prop::block(name, Look::GLASS, upright(centre), half)
    };
    let (up, deep) = (0.5 * bins.depth, DVec3::new(0.5 * x, 0.5 * y, 0.5 * bins.depth));
    [
        wall("wall_left", DVec3::new(-thick, deep.y, up), DVec3::new(thick, deep.y, up)),
        wall("wall_right", DVec3::new(x + thick, deep.y, up), DVec3::new(thick, deep.y, up)),
        wall("wall_front", DVec3::new(deep.x, -thick, up), DVec3::new(deep.x, thick, up)),
        wall("wall_back", DVec3::new(deep.x, y + thick, up), DVec3::new(deep.x, thick, up)),
    ]
}

/// A plate on the bottom of a bin to fill.
fn mark(bins: &Bins, word: &Word, bin: u16) -> Prop {
    let (row, column) = (usize::from(bin) / word.columns(), usize::from(bin) % word.columns());
    let middle = |k: usize| (k as f64 + 0.5) * bins.side;
    let half = 0.5 * (bins.side - bins.thickness);
    let rise = bins.bowl - (square(bins.bowl) - square(half)).max(0.0).sqrt();
    let centre = DVec3::new(middle(column), middle(word.rows() - 1 - row), 0.5 * rise);
    Prop::target(format!("target_{bin}"), upright(centre), DVec3::new(half, 0.5 * rise, half))
}
