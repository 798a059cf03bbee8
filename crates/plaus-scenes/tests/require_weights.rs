//! A state that meets a combination of requirements weighs 1, however many of its parts it meets: what chains sample of
//! random combinations, compared with draws of the prior that meet them by plain logic.

use plaus_dist::{Purpose, Seed, Stream};
use plaus_mcmc::{Chain, Decision, State, StateRefOf, Target};
use plaus_scenes::ball2d::{self, Ball2d};
use plaus_scenes::require::{Asked, Mark, Require};
use plaus_scenes::{Rules, Scene};
use rand::RngExt;

/// A ball that asks for nothing itself.
fn ball() -> Ball2d {
    let (collisions, constrained) = (3, Some(false));
    Ball2d::new(&ball2d::Config { collisions, constrained, ..ball2d::Config::default() }).unwrap()
}

/// A combination of places at which a ball may come to rest, in mm: the middle of each with its half width.
enum Tree {
    Rests([f64; 2]),
    All(Vec<Tree>),
    Any(Vec<Tree>),
    AtLeast(usize, Vec<Tree>),
    Not(Box<Tree>),
}

impl Tree {
    fn random(stream: &mut Stream, depth: u32) -> Self {
        let mut several = |least: u32| {
            (0..stream.random_range(least..=3)).map(|_| Self::random(stream, depth - 1)).collect::<Vec<_>>()
        };
        if depth == 0 {
            return Self::Rests([stream.random_range(-150.0..200.0), stream.random_range(40.0..120.0)]);
        }
        let parts = several(2);
        match stream.random_range(0..5) {
            0 => Self::All(parts),
            1 => Self::AtLeast(stream.random_range(1..=2), parts),
            2 => Self::Not(Box::new(Self::All(parts))),
            _ => Self::Any(parts),
        }
    }

    fn text(&self) -> String {
        let list =
            |parts: &[Self]| parts.iter().map(|one| format!("{{ {} }}", one.text())).collect::<Vec<_>>().join(", ");
        match self {
            Self::Rests([x, within]) => format!("rests_at = {{ x_mm = {x}, within_mm = {within}, scale_mm = 60 }}"),
            Self::All(parts) => format!("all = [{}]", list(parts)),
            Self::Any(parts) => format!("any = [{}]", list(parts)),
            Self::AtLeast(count, parts) => format!("at_least = {{ count = {count}, of = [{}] }}", list(parts)),
            Self::Not(part) => format!("not = {{ {} }}", part.text()),
        }
    }

    fn is_met(&self, x: f64) -> bool {
        match self {
            Self::Rests([middle, within]) => (x - middle).abs() <= *within,
            Self::All(parts) => parts.iter().all(|one| one.is_met(x)),
            Self::Any(parts) => parts.iter().any(|one| one.is_met(x)),
            Self::AtLeast(count, parts) => parts.iter().filter(|one| one.is_met(x)).count() >= *count,
            Self::Not(part) => !part.is_met(x),
        }
    }

    /// The wrong weight: densities of alternatives are added.
    fn added(&self, x: f64) -> f64 {
        match self {
            Self::Any(parts) => parts.iter().map(|one| one.added(x)).sum(),
            Self::All(parts) => parts.iter().map(|one| one.added(x)).product(),
            _ => f64::from(u8::from(self.is_met(x))),
        }
    }
}

/// Where the ball of a state rests, in mm; infinite if it never does. And the mark that the requirement gives it.
fn rest(asked: &Asked<Ball2d>, state: StateRefOf<'_, Asked<Ball2d>>) -> Option<(f64, Mark)> {
    let motion = asked.motion(state.draw).ok()?;
    let last = motion.tracks.first()?.pieces.last().filter(|piece| piece.rests())?;
    Some((1e3 * last.position.x, asked.judge(&motion, &[])[0]))
}

/// Draws of the prior, and iterations of each chain.
const NUMBER: u64 = 40_000;
/// Pieces of a chain whose means give its standard error: each far longer than the chain's correlation.
const STRETCHES: usize = 20;

/// Mean of the place, of states of a chain that meet the requirement; with its standard error.
fn sampled(scene: &Asked<Ball2d>) -> [f64; 2] {
    let moves = scene.moves(&Rules::default()).unwrap();
    let mut chain = Chain::start(scene, &moves, Seed(6).chain(0)).unwrap();
    (0..NUMBER / 20).for_each(|_| _ = chain.step().unwrap());
    let mut sums = [[0.0; 2]; STRETCHES];
    let mut seen = rest(scene, chain.state().by_ref());
    for sum in &mut sums {
        for _ in 0..NUMBER / STRETCHES as u64 {
            if chain.step().unwrap().decision == Decision::Accepted {
                seen = rest(scene, chain.state().by_ref());
            }
            if let Some((x, _)) = seen.filter(|(_, mark)| mark.met()) {
                *sum = [sum[0] + 1.0, sum[1] + x];
            }
        }
    }
    let [count, whole] = sums.iter().fold([0.0; 2], |all, one| [all[0] + one[0], all[1] + one[1]]);
    let mean = whole / count;
    // Of a ratio of sums, by the delta method.
    let squares: f64 = sums.iter().map(|[count, sum]| (sum - mean * count).powi(2)).sum();
    let n = STRETCHES as f64;
    [mean, (squares * n / (n - 1.0)).sqrt() / count]
}

/// Weighted mean of places, with its standard error.
fn weighed(places: &[f64], weight: impl Fn(f64) -> f64) -> [f64; 2] {
    let whole: f64 = places.iter().map(|&x| weight(x)).sum();
    let mean = places.iter().map(|&x| weight(x) * x).sum::<f64>() / whole;
    let squares: f64 = places.iter().map(|&x| (weight(x) * (x - mean)).powi(2)).sum();
    [mean, squares.sqrt() / whole]
}

#[test]
fn what_is_met_weighs_one_however_often() {
    let mut places = Vec::new();
    let free = Asked::new(ball(), &[toml::from_str("rests_at = {}").unwrap()]).unwrap();
    for nth in 0..NUMBER {
        let draw = free.start(&mut Seed(5).chain(1).at(nth, Purpose::START));
        let state = State::evaluate(&free, draw, &mut Default::default()).unwrap();
        places.extend(rest(&free, state.by_ref()).map(|(x, _)| x));
    }
    let (mut trees, mut caught) = (0, 0);
    for seed in 0.. {
        let tree = Tree::random(&mut Seed(seed).chain(2).at(0, Purpose::START), 2);
        let share = places.iter().filter(|&&x| tree.is_met(x)).count() as f64 / places.len() as f64;
        if !(0.05..0.95).contains(&share) {
            continue;
        }
        let one: Require = toml::from_str(&tree.text()).unwrap();
        let scene = Asked::new(ball(), &[one]).unwrap();
        for nth in 0..200 {
            let draw = scene.start(&mut Seed(7).chain(1).at(nth, Purpose::START));
            let state = State::evaluate(&scene, draw, &mut Default::default()).unwrap();
            if let Some((x, mark)) = rest(&scene, state.by_ref()) {
                assert_eq!((tree.is_met(x), tree.is_met(x)), (mark.met(), mark.log == 0.0), "{} at {x}", tree.text());
            }
        }
        let found = sampled(&scene);
        let off = |truth: [f64; 2]| (found[0] - truth[0]).abs() / found[1].hypot(truth[1]);
        let z = off(weighed(&places, |x| f64::from(u8::from(tree.is_met(x)))));
        // One in 16,000 right ones is as far off.
        assert!(z < 4.0, "{}: {z} standard errors", tree.text());
        caught += u32::from(off(weighed(&places, |x| tree.added(x))) > 4.0);
        trees += 1;
        if trees == 8 {
            break;
        }
    }
    assert!(caught >= 2, "adding densities shows in {caught} of {trees}");
}
