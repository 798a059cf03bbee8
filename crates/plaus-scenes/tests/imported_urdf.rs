//! Worlds made from models in URDF: places and joints beside MuJoCo's own, which `xtask/python/mjcf_poses.py` wrote,
//! what moves, what is listed as left out, and what is refused.

use super::imported_models::{off, truth, weighed};
use glam::DVec3;
use plaus_asset::model::{Corners, JointKind, Model, Solid};
use plaus_scenes::custom::Config;
use plaus_scenes::{Assets, Scenario, World, import};

const CRANE: &str = include_str!("models/crane.urdf");
/// MuJoCo's numbers have twelve digits after the point.
const EXACT: f64 = 1e-11;
/// MuJoCo has the corners of meshes in single precision.
const SINGLE: f64 = 1e-6;

fn read(model: &str) -> Model {
    plaus_asset::read_model(model.as_bytes(), &mut |_| Err("none".into())).unwrap_or_else(|error| panic!("{error}"))
}

/// A robot with this inside.
pub(crate) fn robot(inside: &str) -> String {
    format!("<robot name='r'>{inside}</robot>")
}

fn made(path: &str, model: &str, mesh: &str) -> Result<(import::Imported, Config), import::ImportError> {
    let mut files = Assets::default();
    files.insert(path, model.as_bytes());
    files.insert(mesh, include_bytes!("models/shapes/wedge.stl").as_slice());
    let made = import::scenario(path, false, None, &files)?;
    let scenario =
        Scenario::read_with("a.toml", &made.text, &[], &files).unwrap_or_else(|error| panic!("{error}\n{}", made.text));
    let World::Custom(config) = scenario.world else { panic!() };
    Ok((made, *config))
}

pub(crate) fn imported(model: &str) -> (import::Imported, Config) {
    made("crane.urdf", model, "shapes/wedge.stl").unwrap_or_else(|error| panic!("{error}"))
}

fn refused(inside: &str) -> String {
    made("a.urdf", &robot(inside), "none.stl").unwrap_err().to_string()
}

/// Links, joints, shapes and corners of meshes are where MuJoCo has them. Of models that differ in one number, they are
/// not.
#[test]
fn everything_is_where_mujoco_has_it() {
    let truth = truth("crane");
    let model = read(CRANE);
    assert!(off(&model, &truth) < EXACT, "{}", off(&model, &truth));
    for (from, to) in [
        ("rpy=\"0.2 0.1 -0.4\"", "rpy=\"-0.4 0.1 0.2\""),
        ("<axis xyz=\"0 0.6 0.8\"/>", "<axis xyz=\"0 0.8 0.6\"/>"),
        ("rpy=\"0.1 -0.2 0.7\"", "rpy=\"0.1 0.2 0.7\""),
    ] {
        let twin = CRANE.replace(from, to);
        assert_ne!(twin, CRANE, "{from}");
        assert!(off(&read(&twin), &truth) > 1e-3, "{from} to {to}");
    }
    let beam =
        model.bodies.iter().flat_map(|body| &body.geoms).find(|geom| geom.name.as_deref() == Some("beam")).unwrap();
    let Solid::Mesh(index) = beam.solid else { panic!("{beam:?}") };
    assert_eq!(model.meshes[index].from, Corners::File("shapes/wedge.stl".into()));
    let wedge = plaus_asset::read("wedge.stl", include_bytes!("models/shapes/wedge.stl")).unwrap();
    let corners: Vec<DVec3> = truth["geoms"]["beam"]["corners"]
        .as_array()
        .unwrap()
        .iter()
        .map(|corner| DVec3::from_array([0, 1, 2].map(|k| corner[k].as_f64().unwrap())))
        .collect();
    for own in wedge.whole().corners {
        let at = beam.at + beam.turn * model.meshes[index].place(own);
        let nearest = corners.iter().map(|corner| corner.distance(at)).fold(f64::INFINITY, f64::min);
        assert!(nearest < SINGLE, "{own} is at {at}: {nearest}");
    }
}

/// What moves and how; masses are those of the file; all links pass through each other; the rest is told.
#[test]
fn links_become_bodies() {
    let (made, config) = imported(CRANE);
    let names: Vec<&str> = config.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["base", "mast", "jib", "hook"], "{}", made.text);
    assert!(config.bodies.iter().all(|body| body.no_contact == ["robot"]));
    assert_eq!(config.fixed.iter().map(|fixed| fixed.name.as_str()).collect::<Vec<_>>(), ["floor"]);
    assert_eq!(config.joints.iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["slew", "luff", "hoist"]);
    assert!(made.text.contains("friction_n_m = 0.25") && made.text.contains("limits_deg = [-28.6"), "{}", made.text);
    assert_eq!(config.bodies[0].colour, "#cc1a33");
    assert_eq!(
        made.left_out,
        [
            "hook: its joint's `mimic` of luff: it moves by itself",
            "<compiler> in <mujoco> (line 5)",
            "<mu1> in <gazebo> (line 65)",
            "hook: that it can touch nothing: here it can",
        ]
    );
    // The eigenvalues of the tensor in the file; its shape alone has others.
    let (mass, _, moments) = weighed(&config, 0);
    let root = (0.05_f64 * 0.05 + 0.01 * 0.01).sqrt();
    let right = [0.45 - root, 0.45 + root, 0.6];
    let off = |moments: [f64; 3]| (0..3).map(|k| (moments[k] - right[k]).abs()).fold(0.0, f64::max);
    assert!((mass - 12.5).abs() < 1e-5 && off(moments) < 1e-7, "{mass} {moments:?}");
    let mut twin = config.clone();
    twin.bodies[0].inertia = None;
    assert!(off(weighed(&twin, 0).2) > 0.01);
}

/// A root stands still if it is called `world`, or has no mass with all that is fixed to it.
#[test]
fn a_root_without_mass_stands_still() {
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision>";
    let heavy = format!("{ball}<inertial><mass value='2'/></inertial>");
    let two = |top: &str, [first, second]: [&str; 2], kind: &str| {
        let joint = format!("<joint name='j' type='{kind}'><parent link='{top}'/><child link='b'/></joint>");
        robot(&format!("<link name='{top}'>{first}</link>{joint}<link name='b'>{second}</link>"))
    };
    for (top, first, second, kind, is_free) in [
        ("world", "", heavy.as_str(), "fixed", false),
        ("a", "", &heavy, "fixed", true),
        ("a", ball, &heavy, "continuous", false),
        ("a", &heavy, ball, "fixed", true),
        ("a", ball, ball, "fixed", false),
    ] {
        let model = read(&two(top, [first, second], kind));
        let free = model.bodies.iter().flat_map(|body| &body.joints).any(|joint| joint.kind == JointKind::Free);
        assert_eq!(free, is_free, "{top} {kind}");
    }
}

/// A package is the folder that holds the model's own, or one beside it.
#[test]
fn files_of_packages_are_found() {
    let said = |file: &str| {
        robot(&format!(
            "<link name='a'><inertial><mass value='1'/></inertial><collision><geometry>\
             <mesh filename='{file}' scale='0.001 0.001 0.001'/></geometry></collision></link>"
        ))
    };
    for (path, file, mesh) in [
        ("urdf/a.urdf", "package://arm/shapes/wedge.stl", "shapes/wedge.stl"),
        ("arm/urdf/a.urdf", "package://looks/wedge.stl", "looks/wedge.stl"),
        ("a.urdf", "package://arm/wedge.stl", "wedge.stl"),
        ("urdf/a.urdf", "../shapes/wedge.stl", "shapes/wedge.stl"),
    ] {
        let (made, _) = made(path, &said(file), mesh).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert!(made.text.contains(&format!("file = \"{mesh}\"")), "{}", made.text);
    }
    let error = made("urdf/a.urdf", &said("package://arm/none.stl"), "wedge.stl").unwrap_err().to_string();
    assert!(error.contains("package://arm/none.stl is not found"), "{error}");
}

#[test]
fn what_is_no_robot_is_refused() {
    let link = "<link name='a'/><link name='b'/>";
    let joint = |kind: &str, parent: &str, child: &str| {
        format!("<joint name='j' type='{kind}'><parent link='{parent}'/><child link='{child}'/></joint>")
    };
    let shape = |inside: &str| format!("<link name='a'><collision><geometry>{inside}</geometry></collision></link>");
    for (inside, said) in [
        (String::new(), "every link is the child of a joint"),
        (link.to_owned(), "neither \"a\" nor \"b\" is the child of a joint"),
        (format!("{link}{}", joint("screw", "a", "b")), "\"screw\" is unknown"),
        (format!("{link}{}", joint("fixed", "a", "c")), "there is no link \"c\""),
        (
            format!("{link}{}{}", joint("fixed", "a", "b"), joint("fixed", "b", "a")),
            "every link is the child of a joint",
        ),
        (format!("{link}{0}{0}", joint("fixed", "a", "b")), "link \"b\" is the child of two joints"),
        (format!("{link}<link name='a'/>"), "another link has this name"),
        (shape("<box size='1 0 1'/>"), "three lengths in m, more than 0"),
        (shape("<sphere/>"), "a length in m, more than 0"),
        (shape("<sphere radius='two'/>"), "are not finite numbers"),
        (shape("<mesh/>"), "filename of <mesh>: it is needed"),
        (shape(""), "it needs a <geometry> with a shape"),
    ] {
        let error = refused(&inside);
        assert!(error.contains(said) && error.contains("line 1, column"), "{inside}: {error}");
    }
}
