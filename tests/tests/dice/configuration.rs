//! Configurations that describe no world are refused, with the key and the limit.

use plaus_scenes::{Scenario, World};

fn refused(overrides: &[&str], said: &[&str]) {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let error = Scenario::read("dice.toml", "[world.dice]", &overrides).unwrap_err().to_string();
    for part in said {
        assert!(error.contains(part), "{error}\nlacks: {part}");
    }
}

#[test]
fn errors_name_the_key_and_the_limit() {
    let off = "constraints=[{face_up={}},{rest_at={x_mm=301}}]";
    refused(&[off], &["world.dice.constraints[1].rest_at.x_mm", "301 mm is off the table", "-300 to 300 mm"]);
    refused(
        &["constraints=[{rest_at={y_mm=-200.5}}]"],
        &["world.dice.constraints[0].rest_at.y_mm", "-200.5 mm is off the table", "-200 to 200 mm"],
    );
    refused(&["constraints=[{face_up={face=7}}]"], &["face", "7 is out of range", "from 1 to 6"]);
    refused(&["constraints=[{face_up={face=0}}]"], &["0 is out of range", "from 1 to 6"]);
    refused(&["constraints=[{rest_at={die=2}}]"], &["no die 2", "from 1 to 1"]);
    refused(&["constraints=[{rest_on={}}]"], &["rest_on", "rest_at"]);
    refused(&["constraints=[{rest_at={},face_up={}}]"], &["each needs a table of its own"]);
    refused(&["grid_mm=0"], &["world.dice.table.grid_mm", "0 is out of range", "from 0.1"]);
    refused(&["bounce_sd=0.4"], &["world.dice.table.bounce", "spread of 0.4", "leaves [0, 1]", "at most 0.05"]);
    refused(&["table.grip=0.05", "grip_sd=0.1"], &["world.dice.table.grip", "leaves [0, ∞)"]);
    refused(&["spilt.radius_mm=50", "spilt.bounce=0.02"], &["world.dice.spilt.bounce", "leaves [0, 1]"]);
    refused(&["table.bounce=1.2"], &["world.dice.table.bounce", "1.2 is out of range"]);
    refused(&["rounding_mm=8"], &["world.dice.die.rounding_mm", "less than half the shortest edge"]);
    refused(
        &["weights={everything=0,component=0,point=0,near=0,rethrow=0,recast=0,turn=0,shift=0}"],
        &["world.dice.weights", "no move has a positive weight"],
    );
}

/// For a list in a file, the error gives the place within the list.
#[test]
fn a_constraint_off_the_table_is_found_in_the_file() {
    let text = "[world.dice]\nconstraints = [\n  { face_up = {} },\n  { rest_at = { x_mm = 999.0 } },\n]";
    let error = Scenario::read("dice.toml", text, &[]).unwrap_err();
    assert_eq!((error.problems[0].line, error.problems[0].column), (Some(4), Some(24)), "{error}");
}

#[test]
fn the_scenarios_do_what_they_say() {
    let read = |text: &str| match Scenario::read("scenario", text, &[]).unwrap().world {
        World::Dice(config) => *config,
        other => panic!("{other:?}"),
    };
    let one = read(include_str!("../../../scenarios/dice-one.toml"));
    assert_eq!((one.dice, one.constraints.len()), (1, 2));
    let six = read(include_str!("../../../scenarios/dice-six.toml"));
    assert_eq!((six.dice, six.together, six.constraints.len()), (6, false, 12));
    let together = read(include_str!("../../../scenarios/dice-six-together.toml"));
    assert!(together.together && together.constraints == six.constraints);
}
