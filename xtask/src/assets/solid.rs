//! Closed surfaces of triangles, and the files that they are written to.

use std::fmt::Write;

/// A closed surface whose faces look outwards: mm, z up.
#[derive(Debug, Clone)]
pub(super) struct Solid {
    pub(super) name: String,
    corners: Vec<[f64; 3]>,
    pub(super) faces: Vec<[u32; 3]>,
}

impl Solid {
    /// What a ring of corners makes that is swept through these places. Both ends are closed by strips from the first
    /// half of the ring to the second, so it need not be convex.
    pub(super) fn swept(name: &str, rings: &[Vec<[f64; 3]>]) -> Self {
        let mut solid = Self::wall(name, rings, false);
        let count = rings[0].len() as u32;
        let last = (rings.len() as u32 - 1) * count;
        for point in 0..count / 2 - 1 {
            let [a, b, c, d] = [point, point + 1, count - 2 - point, count - 1 - point];
            solid.faces.extend([[a, b, c], [a, c, d]]);
            solid.faces.extend([[a, c, b], [a, d, c]].map(|face| face.map(|corner| corner + last)));
        }
        solid.outwards()
    }

    /// The same as a loop: after the last place comes the first.
    pub(super) fn looped(name: &str, rings: &[Vec<[f64; 3]>]) -> Self {
        Self::wall(name, rings, true).outwards()
    }

    /// The same with both ends closed by fans about these two places.
    pub(super) fn between(name: &str, rings: &[Vec<[f64; 3]>], ends: [[f64; 3]; 2]) -> Self {
        let mut solid = Self::wall(name, rings, false);
        let count = rings[0].len() as u32;
        let (last, first) = ((rings.len() as u32 - 1) * count, solid.corners.len() as u32);
        solid.corners.extend(ends);
        for k in 0..count {
            let next = (k + 1) % count;
            solid.faces.push([first, k, next]);
            solid.faces.push([first + 1, last + next, last + k]);
        }
        solid.outwards()
    }

    /// Two triangles for each side of the ring between two places.
    fn wall(name: &str, rings: &[Vec<[f64; 3]>], is_closed: bool) -> Self {
        let (count, places) = (rings[0].len() as u32, rings.len() as u32);
        let mut faces = Vec::new();
        for place in 0..places - u32::from(!is_closed) {
            for point in 0..count {
                let at = |more: u32, point: u32| (place + more) % places * count + point % count;
                let [a, b, c, d] = [at(0, point), at(0, point + 1), at(1, point + 1), at(1, point)];
                faces.extend([[a, c, b], [a, d, c]]);
            }
        }
        Self { name: name.into(), corners: rings.concat(), faces }
    }

    fn outwards(mut self) -> Self {
        if self.volume() < 0.0 {
            self.faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        self
    }

    /// Only this part of it is left, about the mean of its corners.
    pub(super) fn shrunk(mut self, part: f64) -> Self {
        let n = self.corners.len() as f64;
        let middle = [0, 1, 2].map(|axis| self.corners.iter().map(|corner| corner[axis]).sum::<f64>() / n);
        for corner in &mut self.corners {
            (0..3).for_each(|axis| corner[axis] = middle[axis] + part * (corner[axis] - middle[axis]));
        }
        self
    }

    /// In mm³.
    pub(super) fn volume(&self) -> f64 {
        let of = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|corner| self.corners[corner as usize]);
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            a.iter().zip(cross).map(|(a, b)| a * b).sum::<f64>() / 6.0
        };
        self.faces.iter().map(of).sum()
    }
}

/// The solids as an OBJ in mm with z up.
pub(super) fn obj(what: &str, solids: &[Solid]) -> Vec<u8> {
    let mut text = format!("# {what}, made by `cargo xtask assets`: mm, z up.\n");
    let mut before = 1;
    for Solid { name, corners, faces } in solids {
        let _ = writeln!(text, "o {name}");
        for [x, y, z] in corners {
            let _ = writeln!(text, "v {x:.3} {y:.3} {z:.3}");
        }
        for [a, b, c] in faces {
            let _ = writeln!(text, "f {} {} {}", a + before, b + before, c + before);
        }
        before += corners.len() as u32;
    }
    text.into_bytes()
}

/// The solids as a GLB, in metres with y up, a node each, which says that it is a body.
pub(super) fn glb(solids: &[Solid]) -> Vec<u8> {
    let (mut bytes, mut views, mut accessors, mut meshes, mut nodes) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (index, Solid { name, corners, faces }) in solids.iter().enumerate() {
        let places: Vec<[f32; 3]> =
            corners.iter().map(|[x, y, z]| [*x, *z, -y].map(|mm| (mm / 1000.0) as f32)).collect();
        let end = |pick: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|axis| places.iter().map(|place| place[axis]).reduce(pick).unwrap_or(0.0))
        };
        let (least, most, begin) = (end(f32::min), end(f32::max), bytes.len());
        bytes.extend(places.iter().flatten().flat_map(|number| number.to_le_bytes()));
        let middle = bytes.len();
        bytes.extend(faces.iter().flatten().flat_map(|corner| corner.to_le_bytes()));
        views.push(format!(r#"{{"buffer":0,"byteOffset":{begin},"byteLength":{}}}"#, middle - begin));
        views.push(format!(r#"{{"buffer":0,"byteOffset":{middle},"byteLength":{}}}"#, bytes.len() - middle));
        accessors.push(format!(
            r#"{{"bufferView":{},"componentType":5126,"count":{},"type":"VEC3","min":{least:?},"max":{most:?}}}"#,
            2 * index,
            places.len()
        ));
        let count = 3 * faces.len();
        let view = 2 * index + 1;
        accessors.push(format!(r#"{{"bufferView":{view},"componentType":5125,"count":{count},"type":"SCALAR"}}"#));
        meshes.push(format!(r#"{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{view}}}]}}"#, 2 * index));
        nodes.push(format!(r#"{{"name":"{name}","mesh":{index},"extras":{{"plaus":"body"}}}}"#));
    }
    let scene: Vec<String> = (0..solids.len()).map(|index| index.to_string()).collect();
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0","generator":"cargo xtask assets"}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
        scene.join(","),
        nodes.join(","),
        meshes.join(","),
        accessors.join(","),
        views.join(","),
        bytes.len()
    )
    .into_bytes();
    // Both parts end on a multiple of four bytes; numbers already do.
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = Vec::new();
    let mut word = |number: usize| file.extend((number as u32).to_le_bytes());
    [0x4654_6c67, 2, 12 + 8 + json.len() + 8 + bytes.len(), json.len(), 0x4e4f_534a].into_iter().for_each(&mut word);
    file.extend(&json);
    let mut word = |number: usize| file.extend((number as u32).to_le_bytes());
    [bytes.len(), 0x004e_4942].into_iter().for_each(&mut word);
    file.extend(&bytes);
    file
}
