//! Scenarios that are refused, and the shipped scenarios, which are accepted.

use plaus_scenes::Scenario;

fn complaint(text: &str) -> String {
    Scenario::read("test.toml", &format!("[world.bowling]\n{text}\n"), &[]).unwrap_err().to_string()
}

#[test]
fn values_out_of_range_are_refused_with_their_limit() {
    for (text, said) in [
        ("pins = [1, 11]", "11"),
        ("pins = [0]", "0"),
        ("pins = []", "pins"),
        ("pins = [6, 7]\nleave = [10]", "pin 10 cannot be left"),
        ("pins = [6, 6]", "named twice"),
        ("ln_lambda = -1.0", "ln_lambda"),
        ("pin_kg = 0.0", "pin_kg"),
        ("[world.bowling.release]\nradius_max_mm = 600.0", "wider than the lane: at most 527"),
        ("[world.bowling.release]\nradius_min_mm = 120.0", "before it begins"),
        ("[world.bowling.release]\ndensity_min = 2000.0", "before it begins"),
        ("[world.bowling.release]\nheight_mean = 0.5\nheight_sd = 0.0", "inside the lane"),
        ("[world.bowling.release]\nspeed_sd = -1.0", "speed_sd"),
        ("[world.bowling.contact]\nball_pin_restitution = 1.5", "0.95"),
        ("[world.bowling.weights]\nmirror = -1", "mirror"),
    ] {
        let message = complaint(text);
        assert!(message.contains(said), "{text}: {message}");
    }
}
