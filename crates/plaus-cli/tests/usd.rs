//! What is exported as USD is read again.

use crate::common::Place;

/// Radius of a ball and a cylinder, edge of a box and a step, and height of the cylinder, in mm; where the three begin.
type World = ([f64; 3], [[f64; 3]; 3]);

fn text(([radius, edge, height], at): &World) -> String {
    let step = 10.0 * edge;
    let mut text = format!(
        "[sampler]\nchains = 1\nwarmup = 1\niterations = 2\n[world.custom]\nduration_s = 0.3\n\
         [[world.custom.fixed]]\nname = 'step'\nshape = {{ box = {{ size_mm = [{step}, {step}, {edge}] }} }}\n"
    );
    let shapes = [
        ("ball", format!("ball = {{ radius_mm = {radius} }}")),
        ("brick", format!("box = {{ size_mm = [{edge}, {}, {height}] }}", 1.5 * edge)),
        ("can", format!("cylinder = {{ radius_mm = {radius}, height_mm = {height} }}")),
    ];
    for ((name, shape), [x, y, z]) in shapes.iter().zip(at) {
        text += &format!(
            "[[world.custom.bodies]]\nname = '{name}'\nshape = {{ {shape} }}\nat_mm = [{x}, {y}, {{ normal = [{z}, \
             1e-6] }}]\n"
        );
    }
    text
}

fn numbers(value: &toml::Value) -> Vec<f64> {
    let number = |value: &toml::Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    value.as_array().into_iter().flatten().filter_map(number).collect()
}

/// How far the shapes and first places of a world that was read again are from those of this one, in mm.
fn off((sizes, at): &World, again: &toml::Table) -> f64 {
    let world = again["world"]["custom"].as_table().unwrap();
    let find = |list: &str, name: &str| {
        let all = world[list].as_array().unwrap();
        all.iter().find(|one| one["name"].as_str() == Some(name)).unwrap_or_else(|| panic!("{name}: {again}")).clone()
    };
    let [radius, edge, height] = *sizes;
    let float = |value: &toml::Value| value.as_float().or_else(|| value.as_integer().map(|n| n as f64)).unwrap();
    let mut worst = 0.0_f64;
    for (name, at) in ["ball", "brick", "can"].iter().zip(at) {
        let one = find("driven", name);
        let first = numbers(&one["keys"][0]["at_mm"]);
        worst = at.iter().zip(&first).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
        let shape = one["shape"].get("compound").map_or(&one["shape"], |whole| &whole["pieces"][0]["shape"]);
        let mut sizes = match *name {
            "ball" => vec![(float(&shape["ball"]["radius_mm"]), radius)],
            "can" => {
                vec![(float(&shape["cylinder"]["radius_mm"]), radius), (float(&shape["cylinder"]["height_mm"]), height)]
            }
            // Its edges are drawn a little rounded: a hull.
            _ => Vec::new(),
        };
        worst = sizes.drain(..).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    let mut step = numbers(&find("fixed", "step_shape")["shape"]["box"]["size_mm"]);
    step.sort_by(f64::total_cmp);
    step.iter().zip([edge, 10.0 * edge, 10.0 * edge]).map(|(a, b)| (a - b).abs()).fold(worst, f64::max)
}

/// Shapes and places are those of the world that was exported, to the rounding of single precision; those of a twin
/// that is a thousandth larger are not.
#[test]
fn what_is_exported_comes_back() {
    for (nth, up) in ["y", "z", "y"].into_iter().enumerate() {
        let k = nth as f64;
        let at = [[-200.0, 30.0 * k, 300.0], [0.0, 10.5, 310.25 + k], [220.0, -17.0, 290.0 - 11.0 * k]];
        let world: World = ([20.0 + 3.25 * k, 45.0 - 2.5 * k, 70.0 + k], at);
        let place = Place::new();
        place.write("world.toml", text(&world));
        place.ok("sample world.toml --out run --quiet");
        place.ok(&format!("export run --format usda --sample 0:1 --up {up} --out again.usda"));
        place.ok("new --from again.usda");
        let again: toml::Table = std::fs::read_to_string(place.path("again.toml")).unwrap().parse().unwrap();
        let twin = (world.0.map(|size| 1.001 * size), world.1);
        assert!(off(&world, &again) < 2e-3, "{}\n{again}", off(&world, &again));
        assert!(off(&twin, &again) > 2e-2);
        place.ok("check again.toml --draws 2");
    }
}
