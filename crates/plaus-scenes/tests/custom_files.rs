//! The user's own shapes: compounds, and shapes from files. A shape is the same however it is described. If something
//! is wrong with a file, the error points to where the scenario names it.

use crate::common::{ROOF, WEDGE, shapes};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, StateOf, Target};
use plaus_scenes::animation::{Form, Shape};
use plaus_scenes::custom::{Custom, Ending};
use plaus_scenes::files::hash_of;
use plaus_scenes::{Assets, Scenario, Scene, World};

fn read(text: &str, files: &Assets) -> Result<Scenario, String> {
    Scenario::read_with("world.toml", text, &[], files).map_err(|error| error.to_string())
}

/// The scene of a text, with the shapes that all tests share.
fn scene(text: &str) -> Custom {
    let scenario = read(text, &shapes()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = &scenario.world else { panic!() };
    Custom::new(config).unwrap()
}

/// The state of the first draw.
fn state(scene: &Custom) -> StateOf<Custom> {
    let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    State::evaluate(scene, draw, &mut Default::default()).unwrap()
}

/// Where its bodies end.
fn ends(scene: &Custom) -> Vec<glam::DVec3> {
    let Ending::Done(done) = state(scene).outcome else { panic!() };
    done.bodies.iter().map(|last| last.place).collect()
}

fn world(fixed: &str, shape: &str, rest: &str) -> String {
    format!(
        "[world.custom]\nduration_s = 0.6\n{fixed}\n[[world.custom.bodies]]\nname = 'body'\nshape = {shape}\n{rest}\n\
         [[world.custom.materials]]\nname = 'wood'\nrestitution = 0.3\n"
    )
}

const FLIGHT: &str = "at_mm = [30, 10, 150]\nturn_deg = [20, -30, 40]\nvelocity_m_s = [0.4, 0.1, 0]\nmaterial = 'wood'";

/// The wedge as points in the scenario, as the hull of a file, as a compound of that hull alone, and as a compound that
/// is turned and turned back. All have one motion, up to rounding; one or two impacts make that no larger than a
/// micrometre.
#[test]
fn one_shape_described_in_several_ways_has_one_motion() {
    let points = "{ hull = { points_mm = [[-30, -20, -10], [30, -20, -10], [0, -20, 25], [-30, 20, -10], \
                  [30, 20, -10], [0, 20, 25]] } }";
    let file = "hull_of = { file = 'wedge.obj', up = 'z' }";
    let said = [
        points.to_owned(),
        format!("{{ {file} }}"),
        "{ hull_of = { file = 'wedge.obj', up = 'z', object = 'wedge', unit_mm = 1 } }".into(),
        format!("{{ compound = {{ pieces = [{{ shape = {{ {file} }} }}] }} }}"),
    ];
    let places: Vec<_> = said.iter().map(|shape| ends(&scene(&world("", shape, FLIGHT)))[0]).collect();
    for (place, shape) in places.iter().zip(&said) {
        assert!((*place - places[0]).length() < 1e-6, "{shape}: {place} beside {}", places[0]);
    }
    let larger = "{ hull_of = { file = 'wedge.obj', up = 'z', unit_mm = 1.5 } }";
    let larger = ends(&scene(&world("", larger, FLIGHT)))[0];
    assert!((larger - places[0]).length() > 1e-3, "another size moves otherwise");
    let lying = "{ hull_of = { file = 'wedge.obj' } }";
    let lying = ends(&scene(&world("", lying, FLIGHT)))[0];
    assert!((lying - places[0]).length() > 1e-4, "an OBJ's y axis is up where nothing else is said");
}

/// A ball that comes down on the roof rolls down the side where it landed. On a turned box with the same surface it
/// takes the same way, to within the skins' difference.
#[test]
fn meshes_collide_as_they_look() {
    let ball = "{ ball = { radius_mm = 20 } }";
    let rest = "at_mm = [60, 0, 140]\nmaterial = 'wood'";
    let roof = "[[world.custom.fixed]]\nname = 'roof'\nshape = { mesh = { file = 'roof.obj', up = 'z' } }";
    // At this time it has come down the slope, and has not left it.
    let at_end = |fixed: &str| {
        let text = world(fixed, ball, rest).replace("duration_s = 0.6", "duration_s = 0.3");
        ends(&scene(&text))[0]
    };
    let on_mesh = at_end(roof);
    // The right slope: from (0, 120) to (200, 0), its normal (3, 5)/√34; the box 40 thick below it.
    let slope = (120.0_f64 / 200.0).atan();
    let (middle, down) = ([100.0, 60.0], [slope.sin() * 20.0, slope.cos() * 20.0]);
    let slab = format!(
        "[[world.custom.fixed]]\nname = 'slab'\nshape = {{ box = {{ size_mm = [{}, 400, 40] }} }}\n\
         at_mm = [{}, 0, {}]\nturn_deg = [0, {}, 0]",
        (200.0_f64 * 200.0 + 120.0 * 120.0).sqrt(),
        middle[0] - down[0],
        middle[1] - down[1],
        slope.to_degrees()
    );
    let on_box = at_end(&slab);
    assert!(on_mesh.x > 0.15, "it went down the right side: {on_mesh}");
    assert!((on_mesh - on_box).length() < 1e-4, "{on_mesh} {on_box}");
}

/// The roof by its heights is the roof of the file: one motion and one picture. Higher ground is met earlier, and
/// heights may be laws.
#[test]
fn ground_by_its_heights_is_the_mesh_of_its_points() {
    let ball = "{ ball = { radius_mm = 20 } }";
    let rest = "at_mm = [60, 0, 140]\nmaterial = 'wood'";
    let by =
        |shape: &str| scene(&world(&format!("[[world.custom.fixed]]\nname = 'roof'\nshape = {shape}"), ball, rest));
    let of_heights = |ridge: &str| {
        let row = format!("[0, {ridge}, 0]");
        by(&format!("{{ heights = {{ spacing_mm = 200, rows_mm = [{row}, {row}, {row}] }} }}"))
    };
    let (file, heights) = (by("{ mesh = { file = 'roof.obj', up = 'z' } }"), of_heights("120"));
    let [on_file, on_heights, on_higher] = [&file, &heights, &of_heights("125")].map(|scene| ends(scene)[0]);
    assert!((on_file - on_heights).length() < 1e-6, "{on_file} {on_heights}");
    assert!((on_file - on_higher).length() > 1e-3, "{on_file} {on_higher}");
    let highest = |scene: &Custom| {
        let animation = scene.animate(&state(scene).draw).unwrap();
        let Form::Mesh { vertices, triangles } = &animation.scenery[0].form else { panic!() };
        (vertices.iter().map(|vertex| vertex.y).fold(0.0, f64::max), triangles.len())
    };
    assert_eq!(highest(&heights), (0.12, 8));
    let (height, _) = highest(&of_heights("{ uniform = [100, 110] }"));
    assert!((0.1..=0.11).contains(&height), "{height}");
}

/// The file's own triangles are drawn, at the body's place.
#[test]
fn files_are_drawn_as_they_are() {
    let roof = "[[world.custom.fixed]]\nname = 'roof'\nshape = { mesh = { file = 'roof.obj', up = 'z', unit_mm = 2 } }";
    let scene = scene(&world(roof, "{ hull_of = { file = 'wedge.obj', up = 'z' } }", "at_mm = [0, 0, 400]"));
    let animation = scene.animate(&state(&scene).draw).unwrap();
    let Form::Mesh { vertices, triangles } = &animation.scenery[0].form else { panic!() };
    assert_eq!((vertices.len(), triangles.len()), (6, 4));
    let top = vertices.iter().map(|vertex| vertex.y).fold(0.0, f64::max);
    assert!((top - 0.24).abs() < 1e-12, "{top}");
    let Shape::Solid { vertices, triangles } = &*animation.motion.tracks[0].shape else { panic!() };
    assert_eq!((vertices.len(), triangles.len()), (6, 8));
    let [of_hull, of_certainty] = &scene.notes()[..] else { panic!() };
    assert_eq!(of_hull, "body is simulated as a convex hull of 6 points, by 6 of them");
    assert!(of_certainty.starts_with("nothing is uncertain"), "{of_certainty}");
}

/// A compound has the total mass of its pieces, each with its own density, and their common centre of mass.
#[test]
fn compounds_balance_where_their_pieces_do() {
    let pieces = "{ compound = { pieces = [{ shape = { ball = { radius_mm = 20 } }, density = 3 }, \
                  { shape = { ball = { radius_mm = 20 } }, at_mm = [80, 0, 0] }] } }";
    let scene = scene(&world("fixed = []", pieces, "at_mm = [0, 0, 100]").replace("0.6", "0.001"));
    let [x, y, z] = (ends(&scene)[0] * 1e3).to_array();
    assert!((x - 20.0).abs() < 1e-9 && y.abs() < 1e-9 && (z - 100.0).abs() < 0.01, "{x} {y} {z}");
}

/// The effective scenario can be read back with the files it came with; with other files it is refused.
#[test]
fn the_effective_scenario_knows_its_files() {
    let text = world("", "{ hull_of = { file = 'wedge.obj' } }", "at_mm = [0, 0, 100]");
    let scenario = read(&text, &shapes()).unwrap();
    let (effective, files) = (scenario.to_toml(), scenario.world.assets());
    assert!(effective.contains(&format!("hash = \"{}\"", hash_of(WEDGE.as_bytes()))), "{effective}");
    assert_eq!(files.iter().map(|(path, _)| path).collect::<Vec<_>>(), ["wedge.obj"]);
    assert_eq!(read(&effective, &files).unwrap(), scenario);
    let mut changed = Assets::default();
    changed.insert("wedge.obj", WEDGE.replace("25", "26").into_bytes());
    let error = read(&effective, &changed).unwrap_err();
    assert!(error.contains("hull_of.hash: wedge.obj has changed: its hash is"), "{error}");
    assert!(read(&text, &changed).is_ok(), "a scenario that pins nothing takes what is there");
}

/// Things that can be wrong with a file, each with the place that is blamed and parts of the message.
#[test]
fn bad_files_are_refused_where_they_are_named() {
    let mut files = shapes();
    for (name, contents) in [
        ("broken.obj", "v 1 2\nf 1 2 3".to_owned()),
        ("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9".into()),
        ("nan.obj", ROOF.replace("v 0 -200 120", "v nan -200 120")),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3".into()),
        ("needle.obj", format!("{ROOF}v 9 9 9\nv 8 8 8\nf 7 8 8\n")),
        ("inside_out.obj", ROOF.replace("f 2 3 6 5", "f 2 5 6 3")),
        ("empty.obj", "# nothing\n".into()),
        ("noise.glb", "glTF but no more".into()),
        ("noise.stl", "solid of no facets".into()),
        ("cup.fbx", String::new()),
    ] {
        files.insert(name, contents.into_bytes());
    }
    let refused = |shape: &str, place: &str, parts: &[&str]| {
        let text = format!("[world.custom]\n[[world.custom.fixed]]\nname = 'thing'\nshape = {shape}\n");
        let error = read(&text, &files).expect_err(&text);
        let column = shape.find(place).map_or(1, |at| at + "shape = ".len() + 1);
        assert!(error.starts_with(&format!("world.toml:4:{column}: world.custom.fixed[0].shape")), "{shape}: {error}");
        parts.iter().for_each(|part| assert!(error.contains(part), "{shape}: {error}"));
    };
    let named = |file: &str, parts: &[&str]| {
        refused(&format!("{{ mesh = {{ file = '{file}' }} }}"), &format!("'{file}'"), &[parts, &[file]].concat());
    };
    named("cup.obj", &["mesh.file", "not among the files"]);
    named("../cup.obj", &["outside the scenario's folder", "anywhere = true"]);
    named("/etc/passwd", &["outside the scenario's folder"]);
    named("cup.fbx", &["must end in .glb, .gltf, .obj, .stl, .usd, .usda, .usdc or .usdz"]);
    named("broken.obj", &["not a valid OBJ"]);
    named("far.obj", &["not a valid OBJ"]);
    named("empty.obj", &["no triangles"]);
    named("noise.glb", &["not a valid GLB"]);
    named("noise.stl", &["not a valid STL"]);
    named("nan.obj", &["corner 1 of \"roof\" is not finite"]);
    refused("{ mesh = { file = 'needle.obj' } }", "shape", &["triangle 4 is degenerate"]);
    refused("{ mesh = { file = 'inside_out.obj' } }", "shape", &["triangle 2", "disagree on which side is outside"]);
    refused("{ hull_of = { file = 'flat.obj' } }", "'flat.obj'", &["within", "of one plane"]);
    let uneven = "{ heights = { spacing_mm = 5, rows_mm = [[0, 1], [0, 1, 2]] } }";
    refused(uneven, "[0, 1, 2]", &["heights.rows_mm[1]: 3 heights, but the first row has 2"]);
    let narrow = "{ heights = { spacing_mm = 5, rows_mm = [[0], [1]] } }";
    refused(narrow, "shape", &["heights in a row is 1, expected at least 2"]);
    let other = "{ mesh = { file = 'roof.obj', object = 'rof' } }";
    refused(other, "'rof'", &["has no object \"rof\"; did you mean \"roof\"? known: roof"]);
    let other = "{ mesh = { file = 'roof.obj', object = 'roof_{i}' } }";
    refused(other, "'roof_{i}'", &["mesh.object", "in an array (`count`)"]);
    let odd = "{ mesh = { file = 'roof.obj', unit_mm = { normal = [1, 0.1] } } }";
    refused(odd, "unit_mm", &["mesh.unit_mm", "-inf to inf"]);
    let piece = "{ compound = { pieces = [{ shape = { hull_of = { file = 'none.obj' } } }] } }";
    refused(piece, "'none.obj'", &["compound.pieces[0].shape.hull_of.file"]);
    let piece = "{ compound = { pieces = [{ shape = { ball = { radius_mm = -1 } } }] } }";
    refused(piece, "-1", &["compound.pieces[0].shape.ball.radius_mm", "out of range"]);
    refused("{ compound = { pieces = [] } }", "[]", &["a list of 0 is out of range"]);
    let piece = "{ compound = { pieces = [{ shape = { plane = {} } }] } }";
    refused(piece, "plane", &["compound.pieces[0].shape", "ball"]);
    let error = Scenario::read("world.toml", &world("", "{ hull_of = { file = 'wedge.obj' } }", ""), &[]).unwrap_err();
    assert!(error.to_string().contains("read only as text"), "{error}");
}

/// In an array, the name of an object is numbered: each member has a shape of its own, as if it were written out.
#[test]
fn members_of_an_array_are_objects_of_their_own() {
    let second = WEDGE.replace("o wedge", "o part_3").replace("0 -20 25", "0 -20 45").replace("0 20 25", "0 20 45");
    let parts = format!("{}{}", WEDGE.replace("o wedge", "o part_2"), shifted(&second, 6));
    let mut files = Assets::default();
    files.insert("parts.obj", parts.as_bytes());
    let ends = |bodies: &str| {
        let text = format!("[world.custom]\nduration_s = 0.3\n{bodies}");
        let scenario = read(&text, &files).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let World::Custom(config) = &scenario.world else { panic!() };
        ends(&Custom::new(config).unwrap())
    };
    let body = |name: &str, object: &str, at: &str| {
        format!(
            "[[world.custom.bodies]]\nname = '{name}'\nturn_deg = [20, 30, 0]\nat_mm = [{at}, 0, 90]\n\
             shape = {{ hull_of = {{ file = 'parts.obj', up = 'z', object = '{object}' }} }}\n"
        )
    };
    let array = ends(&(body("part", "part_{i+2}", "'200 * i'") + "count = 2\n"));
    assert_eq!(array, ends(&(body("part_1", "part_2", "0") + &body("part_2", "part_3", "200"))));
    assert_ne!(array, ends(&(body("part_1", "part_2", "0") + &body("part_2", "part_2", "200"))));
}

/// The text of an object whose faces name corners after so many others.
fn shifted(text: &str, corners: u32) -> String {
    let of_line = |line: &str| match line.strip_prefix("f ") {
        Some(face) => {
            let moved = face.split(' ').map(|corner| (corner.parse::<u32>().unwrap() + corners).to_string());
            format!("f {}\n", moved.collect::<Vec<_>>().join(" "))
        }
        None => format!("{line}\n"),
    };
    text.lines().map(of_line).collect()
}
