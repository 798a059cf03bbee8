//! Shapes from files, on the command line: a world made from a file, and a run that keeps its own copy.

use crate::common::Place;

/// A prism along y, 60 wide, 40 long, 35 high.
const WEDGE: &str = "o wedge\nv -30 -20 -10\nv 30 -20 -10\nv 0 -20 25\nv -30 20 -10\nv 30 20 -10\nv 0 20 25\n\
                     f 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 1 3 6 4\n";

const WORLD: &str = "[sampler]\nchains = 1\nwarmup = 2\niterations = 6\n[world.custom]\nduration_s = 0.2\n\
    [[world.custom.bodies]]\nname = 'wedge'\nshape = { hull_of = { file = 'shapes/wedge.obj' } }\nany_turn = true\n\
    at_mm = [0, 0, 100]\n";

#[test]
fn a_run_keeps_the_files_of_its_scenario() {
    let place = Place::new();
    std::fs::create_dir(place.path("shapes")).unwrap();
    place.write("shapes/wedge.obj", WEDGE);
    place.write("world.toml", WORLD);
    place.ok("check world.toml").says(&["wedge is simulated as a convex hull of 6 points, by 6 of them"]);
    place.ok("sample world.toml --out run --quiet");
    let copy = place.bytes("run").into_keys().find(|name| name.starts_with("asset-")).unwrap();
    // The files beside the scenario may change or be deleted, because the run has its own copy.
    std::fs::remove_dir_all(place.path("shapes")).unwrap();
    place.ends("check world.toml", 2).says(&["world.toml:9:30", "hull_of.file", "cannot read it"]);
    place.ok("resume run --iterations 9 --quiet");
    place.ok("export run --format csv --out draws.csv");
    place.write(&format!("run/{copy}"), WEDGE.replace("25", "26"));
    for command in ["resume run --iterations 12", "diagnose run", "export run --format csv --out again.csv"] {
        place.ends(command, 2).says(&["this copy of shapes/wedge.obj", "was changed after the run was made"]);
    }
    assert!(!place.path("again.csv").exists());
}

/// A mesh that is edited beside a run is told by `resume` and `replay`, which go on with the run's copy: their results
/// are those of the file as it was. An unchanged file is not told.
#[test]
fn an_edited_mesh_is_told() {
    let place = Place::new();
    std::fs::create_dir(place.path("shapes")).unwrap();
    place.write("shapes/wedge.obj", WEDGE);
    place.write("world.toml", WORLD);
    for run in ["run", "whole"] {
        place.ok(&format!("sample world.toml --out {run} --quiet"));
    }
    let told = "shapes/wedge.obj has changed since this run began";
    let replay = "replay run --sample 0:3";
    let before = place.ok(replay);
    for unchanged in [&before, &place.ok("resume whole --iterations 9 --quiet")] {
        assert!(!unchanged.err.contains("when this run began"), "{}", unchanged.err);
    }
    place.write("shapes/wedge.obj", WEDGE.replace("25", "35"));
    let replayed = place.ok(replay);
    replayed.says(&[told, "the run uses its own copy"]);
    assert_eq!(replayed.out, before.out);
    place.ok("resume run --iterations 9 --quiet").says(&[told]);
    assert_eq!(place.bytes("run"), place.bytes("whole"));
    // Likewise where scenario and run lie in different folders below the one where the command is typed.
    std::fs::create_dir_all(place.path("scenarios/mine")).unwrap();
    std::fs::create_dir(place.path("runs")).unwrap();
    std::fs::rename(place.path("shapes"), place.path("scenarios/mine/shapes")).unwrap();
    std::fs::rename(place.path("world.toml"), place.path("scenarios/mine/world.toml")).unwrap();
    std::fs::rename(place.path("run"), place.path("runs/run")).unwrap();
    place.ok("replay runs/run --sample 0:3").says(&[told]);
    // A run of the edited file is another one.
    place.ok("sample scenarios/mine/world.toml --out other --quiet");
    assert_ne!(place.ok("replay other --sample 0:3").out, before.out);
}

#[test]
fn a_file_makes_a_world() {
    let place = Place::new();
    place.write("wedge.obj", WEDGE);
    place.ok("new --from wedge.obj").says(&["wrote wedge.toml"]);
    place.ok("check wedge.toml").says(&["wedge is simulated as a convex hull"]);
    place.ends("new --from wedge.obj", 2).says(&["already exists"]);
    place.write("two.obj", format!("{WEDGE}{}", WEDGE.replace("o wedge", "o other")));
    place.ok("new --from two.obj my.toml").says(&["not taken over: which objects move"]);
    place.ends("new --from none.obj", 2).says(&["none.obj: cannot read it"]);
    place
        .ends("new --from ball.toml", 2)
        .says(&["must end in .glb, .gltf, .obj, .stl, .usd, .usda, .usdc, .usdz, .urdf or .xml"]);
}

#[test]
fn a_model_makes_a_world() {
    let place = Place::new();
    place.write("wedge.obj", WEDGE);
    place
        .write("inside.xml", "<mujocoinclude><worldbody><geom type='plane' size='1 1 1'/></worldbody></mujocoinclude>");
    let model = "<mujoco>\n<include file='inside.xml'/>\n<asset><mesh file='wedge.obj' scale='.001 .001 .001'/></asset>\n\
        <worldbody>\n<body name='cart' pos='0 0 .2'><freejoint/><geom type='mesh' mesh='wedge'/>\n\
        <body name='wheel' pos='0 .1 0'><joint name='axle' axis='0 1 0' armature='1'/><geom size='.05'/></body>\n\
        </body></worldbody></mujoco>";
    place.write("model.xml", model);
    place.ends("new --from model.xml strict.toml --strict", 2).says(&["--strict", "not taken over"]);
    assert!(!place.path("strict.toml").exists());
    place.ok("new --from model.xml").says(&["not taken over: armature of <joint> (line 6)", "wrote model.toml"]);
    place.ok("check model.toml").says(&["start_of_cart_x"]);
    place.ok(
        "sample model.toml --out run --quiet --set sampler.chains=1 --set sampler.warmup=1 --set sampler.iterations=3 \
              --set world.custom.duration_s=0.1",
    );
    place.write("model.xml", model.replace("pos='0 .1 0'", "pos='0 .1'"));
    place.ends("new --from model.xml other.toml", 2).says(&["model.xml: line 6, column 1: pos of <body>: 3 numbers"]);
    assert!(!place.path("other.toml").exists());
}
