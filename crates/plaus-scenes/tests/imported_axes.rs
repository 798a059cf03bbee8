//! Hinges and sliders of imported models: their limits, friction, springs, dampers and drives.

use crate::imported::{imported as of_glb, is_left_out};
use crate::imported_models::{bodies, imported as of_mjcf};
use crate::imported_physics::{file, node, shape};
use crate::imported_urdf::{imported as of_urdf, robot};
use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::{Scene, custom};
use serde_json::json;

/// What MJCF says of hinges and slides is kept: in degrees and mm, from the start, which `ref` is.
#[test]
fn models_in_mjcf_have_springs_and_dampers() {
    for (joint, kind, left_out) in [
        (
            "<joint type='slide' axis='1 0 0' range='-0.1 0.2' frictionloss='3' stiffness='40' springref='0.05' \
             damping='2'/>",
            "slider = { axis = [1, 0, 0], limits_mm = [-100, 200], friction_n = 3, \
             spring = { stiffness_n_per_m = 40, rest_mm = 50, damping_n_s_per_m = 2 } }",
            "",
        ),
        (
            "<joint axis='0 1 0' ref='10' stiffness='0.5' springref='40' damping='0.1'/>",
            "hinge = { axis = [0, 1, 0], spring = { stiffness_n_m_per_rad = 0.5, rest_deg = 30, \
             damping_n_m_s_per_rad = 0.1 } }",
            "",
        ),
        ("<joint damping='0.1'/>", "hinge = { axis = [0, 0, 1], spring = { damping_n_m_s_per_rad = 0.1 } }", ""),
        ("<joint type='slide' range='0.1 0.3'/>", "limits_mm = [0, 300]", "it starts beyond them"),
        ("<joint stiffness='1' springref='200'/>", "hinge = { axis = [0, 0, 1] }", "at rest at 200 degrees"),
        ("<joint type='ball' damping='1'/>", "ball = {}", "the spring and damping of its ball joint"),
        ("<joint type='slide'/><joint type='slide' axis='1 0 0'/>", "slider = {", "1 of its 2 slide joints"),
    ] {
        let (made, config) = of_mjcf(&bodies(&format!("<body name='thing'>{joint}<geom size='0.1'/></body>")));
        assert_eq!(config.joints.len(), 1, "{joint}");
        assert!(made.text.contains(kind), "{kind}\n{}", made.text);
        let told = made.left_out.iter().any(|line| line.contains(left_out));
        assert!(if left_out.is_empty() { made.left_out.is_empty() } else { told }, "{:?}", made.left_out);
    }
}

/// A slide with a spring swings as `m x″ = −k x` says, about where it is at rest.
#[test]
fn a_slide_swings_on_its_spring() {
    let (_, config) = of_mjcf(&bodies(
        "<body name='cart'><joint type='slide' axis='1 0 0' stiffness='36' springref='0.1'/>\
         <geom type='box' size='0.1 0.1 0.1' mass='4'/></body>",
    ));
    let scene = custom::Custom::new(&config).unwrap();
    let film = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
    for time in [0.2_f64, 0.5, 1.0] {
        let exact = 0.1 * (1.0 - (3.0 * time).cos());
        let at = film.motion.tracks[0].position(time) - film.motion.tracks[0].position(0.0);
        // What animations are exact to, 0.2 mm, and a thousandth of the cart's size, which the preset allows.
        assert!((at.x - exact).abs() < 2e-4 + 1e-4, "{at} for {exact}");
    }
}

/// A prismatic joint in URDF slides within its limits, with its friction and damping.
#[test]
fn models_in_urdf_slide() {
    let link = |name: &str, x: f64| {
        format!(
            "<link name='{name}'><inertial><mass value='2'/></inertial>\
             <collision><origin xyz='{x} 0 0'/><geometry><sphere radius='0.1'/></geometry></collision></link>"
        )
    };
    let (made, config) = of_urdf(&robot(&format!(
        "{}{}<joint name='rail' type='prismatic'><parent link='a'/><child link='b'/><axis xyz='0 1 0'/>\
         <limit lower='-0.2' upper='0.4'/><dynamics friction='1.5' damping='0.7'/></joint>",
        link("a", 0.0),
        link("b", 1.0)
    )));
    assert_eq!(config.joints.len(), 1);
    let kind = "slider = { axis = [0, 1, 0], limits_mm = [-200, 400], friction_n = 1.5, \
                spring = { damping_n_s_per_m = 0.7 } }";
    assert!(made.text.contains(kind), "{}", made.text);
}

/// Drives of `KHR_physics_rigid_bodies` become springs and motors; limits that are soft in one place, springs. What is
/// something else is told.
#[test]
fn drives_become_springs_and_motors() {
    let fixed = |key: &str, axes: &[usize]| json!({ key: axes, "min": 0, "max": 0 });
    let hinge = [fixed("linearAxes", &[0, 1, 2]), fixed("angularAxes", &[0, 1])];
    let slider = [fixed("linearAxes", &[0, 1]), fixed("angularAxes", &[0, 1, 2])];
    let soft = |key: &str| json!({ key: [2], "min": 0.5, "max": 0.5, "stiffness": 3, "damping": 0.2 });
    let drive = |of: &str, said: serde_json::Value| {
        let mut all = json!({ "type": of, "axis": 2, "mode": "force" });
        all.as_object_mut().unwrap().extend(said.as_object().unwrap().clone());
        all
    };
    for (limits, extra, drives, kind, told) in [
        (&hinge, Some(soft("angularAxes")), json!([]), "rest_deg = 28.64789, damping_n_m_s_per_rad = 0.2 }", ""),
        (&slider, Some(soft("linearAxes")), json!([]), "stiffness_n_per_m = 3, rest_mm = 500, damping", ""),
        (
            &slider,
            None,
            json!([drive("linear", json!({ "stiffness": 8, "positionTarget": 0.2 }))]),
            "slider = { axis = [0, -1, 0], spring = { stiffness_n_per_m = 8, rest_mm = 200 } }",
            "",
        ),
        (
            &hinge,
            None,
            json!([drive("angular", json!({ "damping": 5, "velocityTarget": 1, "maxForce": 2 }))]),
            "motor = { most_n_m = 2, speed_deg_s = 57.29578 }",
            "the damping of its angular drive",
        ),
        (
            &hinge,
            None,
            json!([drive("angular", json!({ "mode": "acceleration", "stiffness": 5 }))]),
            "hinge = { axis = [0, -1, 0] }",
            "its angular drive of z: nothing drives it here",
        ),
        (
            &slider,
            None,
            json!([drive("angular", json!({ "stiffness": 5 }))]),
            "slider = { axis = [0, -1, 0] }",
            "its angular drive of z: nothing drives it here",
        ),
    ] {
        let collider = json!({ "motion": {}, "collider": shape(0) });
        let mut held = collider.clone();
        held["joint"] = json!({ "connectedNode": 1, "joint": 0 });
        let nodes = json!([node("a", DVec3::ZERO, held), node("b", DVec3::ZERO, collider)]);
        let limits: Vec<_> = limits.iter().cloned().chain(extra).collect();
        let joints = json!({ "physicsJoints": [{ "limits": limits, "drives": drives }] });
        let (made, config) = of_glb(&file(&nodes, &joints, &json!([{ "type": "sphere" }])));
        assert_eq!(config.joints.len(), 1);
        assert!(made.text.contains(kind), "{kind}\n{}", made.text);
        if told.is_empty() {
            assert!(made.left_out.is_empty(), "{:?}", made.left_out);
        } else {
            is_left_out(&made, told);
        }
    }
}
