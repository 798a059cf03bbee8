//! Requirements whose numbers name quantities of the world, so that they differ from draw to draw.

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Simulated, State, Target};
use plaus_scenes::require::Stops;
use plaus_scenes::{AnyScratch, Scenario, Scene, Stage};

/// A ball that goes straight on, 1 s long, at `speed` m/s, and where it is wanted.
const WORLD: &str = "[world.custom]\ngravity = 0\nduration_s = 1\nfixed = []\n\
    [[world.custom.quantities]]\nname = 'target'\nvalue = { uniform = [500, 1500] }\n\
    [[world.custom.quantities]]\nname = 'width'\nvalue = { choice = { of = [30, 60] } }\n\
    [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 10 } }\n\
    velocity_m_s = [{ uniform = [0.5, 1.5] }, 0, 0]\n";

fn scenario(require: &str) -> Scenario {
    Scenario::read("drawn.toml", &format!("{WORLD}[[require]]\n{require}\n"), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn margins(stage: &Stage, nth: u64) -> Vec<f64> {
    let draw = stage.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
    let state = State::evaluate(stage, draw, &mut AnyScratch::default()).unwrap();
    state.outcome.marks().iter().map(|mark| mark.margin).collect()
}

/// The numbers of a draw, in the order of the variables: target, which width, speed.
fn numbers(stage: &Stage, nth: u64) -> [f64; 3] {
    let draw = stage.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
    let state = State::evaluate(stage, draw, &mut AnyScratch::default()).unwrap();
    let mut values = vec![0.0; stage.scalars().len()];
    stage.write_scalars(state.by_ref(), &mut values);
    ["target", "width", "ball.vx"].map(|name| {
        let place = stage.scalars().iter().position(|scalar| scalar.name == name);
        values[place.unwrap_or_else(|| panic!("{name}"))]
    })
}

/// The margin is that of the requirement with this draw's own numbers: a twin with those of another draw differs.
#[test]
fn numbers_are_those_of_the_draw() {
    let said = "all = [{ inside = { body = 'ball', x_mm = ['target - width', '0.5 * (target + target) + width'], \
                how = 'at_end', scale_mm = 20 } }, { speed = { body = 'ball', at_least = 'target / 1000 - 0.1', \
                when = { from_s = 0.1 } } }]";
    let stage = scenario(said).stage().unwrap();
    let (mut met, mut of_twin) = (0, 0.0_f64);
    for nth in 0..40 {
        let [target, width, vx] = numbers(&stage, nth);
        let with = |target: f64| {
            let (low, high, least) = (target - width, target + width, target / 1000.0 - 0.1);
            let plain = format!(
                "all = [{{ inside = {{ body = 'ball', x_mm = [{low:?}, {high:?}], how = 'at_end', scale_mm = 20 }} }}, \
                 {{ speed = {{ body = 'ball', at_least = {least:?}, when = {{ from_s = 0.1 }} }} }}]"
            );
            margins(&scenario(&plain).stage().unwrap(), nth)[0]
        };
        let found = margins(&stage, nth)[0];
        assert!((found - with(target)).abs() < 1e-9, "{nth}: {found}");
        let closed = (width - (1000.0 * vx - target).abs()) / 20.0;
        assert!(found <= closed + 1e-9, "{nth}: {found} is more than {closed}");
        met += u32::from(found >= 0.0);
        of_twin = of_twin.max((found - with(target + 100.0)).abs());
    }
    assert!(met > 0 && of_twin > 1.0, "{met}, {of_twin}");
}

/// A value beyond what its key allows is taken for the end: a width of 0.001 mm.
#[test]
fn numbers_stay_within_the_range_of_their_key() {
    let stage =
        scenario("passes = { body = 'ball', x_mm = 'target', z_mm = 0, within_mm = 'width - 100', scale_mm = 20 }");
    let stage = stage.stage().unwrap();
    for nth in 0..20 {
        let [target, _, vx] = numbers(&stage, nth);
        let margin = (1e-3 - (target - 1000.0 * vx).max(0.0)) / 20.0;
        assert!((margins(&stage, nth)[0] - margin).abs() < 1e-9, "{nth}");
    }
}

/// Stopping early changes no decision.
#[test]
fn hopeless_motions_are_stopped_soundly() {
    let said = "all = [{ impact = { body = 'ball', when = { to_s = 'target / 2000' } } }, \
                { speed = { body = 'ball', at_most = 'target / 1000', when = { from_s = 0, to_s = 0.5 } } }]";
    let scenario = Scenario::read(
        "drawn.toml",
        &format!(
            "{}[[require]]\n{said}\n",
            WORLD.replace(
                "fixed = []",
                "fixed = [{ name = 'wall', shape = { box = { size_mm = [20, 900, 900] } }, at_mm = [500, 0, 0] }]"
            )
        ),
        &[],
    );
    let scenario = scenario.unwrap_or_else(|error| panic!("{error}"));
    let twins = [Stops::Never, Stops::Soundly].map(|stops| scenario.stage().unwrap().stopping(stops));
    let floor = LogPotential::new(-2.0).unwrap();
    let mut above = 0;
    for nth in 0..60 {
        let [whole, sound] = twins.each_ref().map(|stage| {
            let draw = stage.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
            match stage.simulate(&draw, None, floor, &mut AnyScratch::default()).unwrap() {
                Simulated::Complete(answer) => stage.log_constraint(&answer).unwrap().value(),
                Simulated::CannotExceedFloor => f64::NEG_INFINITY,
            }
        });
        assert_eq!(whole > -2.0, sound > -2.0, "{nth}: {whole}, {sound}");
        above += u32::from(whole > -2.0);
    }
    assert!((1..60).contains(&above), "{above}");
}

/// A run stores formulas as they were written.
#[test]
fn formulas_are_written_and_read_again() {
    let read =
        scenario("named = { name = 'far', that = { height = { at_least_mm = 'width', at_most_mm = 'width + 1' } } }");
    let text = read.to_toml();
    assert!(text.contains("at_most_mm = \"width + 1\"") && !text.contains("varying"), "{text}");
    assert_eq!(Scenario::read("again.toml", &text, &[]).unwrap(), read);
    assert_eq!(Scenario::of_value(&read.to_value(), &plaus_scenes::files::NoFiles).unwrap(), read);
    assert!(read.stage().unwrap().asked().iter().any(|said| said == "far"));
    let changed = ["require[0].height.at_most_mm=2*width".to_owned()];
    let changed = Scenario::read("again.toml", &scenario("height = { at_most_mm = 5 }").to_toml(), &changed).unwrap();
    assert!(changed.to_toml().contains("at_most_mm = \"2*width\""));
}

#[test]
fn what_is_no_number_is_refused_at_its_key() {
    for (require, expected) in [
        ("height = { at_least_mm = 'widht' }", "there is no quantity \"widht\"; did you mean \"width\"?"),
        ("height = { at_least_mm = 'width +' }", "cannot be read as arithmetic"),
        ("height = { at_least_mm = 'normal(0, 1)' }", "give it to one of the `quantities`"),
        ("height = { at_least_mm = '30 mm' }", "write 30"),
        ("height = { at_least_mm = 'width + 5', at_most_mm = 'width' }", "no value is both"),
        ("bounces = { at_least = 'width' }", "expected an integer"),
    ] {
        let error =
            Scenario::read("drawn.toml", &format!("{WORLD}[[require]]\n{require}\n"), &[]).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("require[0]"), "{require}: {error}");
    }
    let other = "[world.ball2d]\n[[require]]\nrests_at = { x_mm = 'target' }\n";
    let error = Scenario::read("ball.toml", other, &[]).unwrap_err().to_string();
    assert!(error.contains("require[0].rests_at.x_mm") && error.contains("only a world of your own"), "{error}");
    let beats = "beats = { every_s = 'width / 100', times_from = { file = 'a.csv' } }";
    let error = Scenario::read("drawn.toml", &format!("{WORLD}[[require]]\n{beats}\n"), &[]).unwrap_err().to_string();
    assert!(error.contains("times_s"), "{error}");
}
