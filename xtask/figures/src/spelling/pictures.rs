//! Figures 5 and 8: two different solutions each of HI and ACM, falling, from above and in perspective.

use super::{Word, acm, hi};
use crate::canvas::{self, HPos, Picture, bold, colour, text, write};
use crate::render::{Camera, Quality, render};
use crate::report::thousands;
use crate::{Result, Work};
use glam::DVec3;
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal};
use plaus_scenes::Scene;
use plaus_scenes::spelling::{Drops, Rest};

/// The chain from which solutions are taken.
const SEED: u64 = 1;
/// Iterations between two looks for a second solution.
const APART: u64 = 500;
/// Iterations after which two words should have been found, even if fewer iterations were asked for.
const MOST: u64 = 20_000;

/// The three columns of a figure: title, direction to the eye, up, field of view in degrees, time.
const VIEWS: [(&str, DVec3, DVec3, f64, f64); 3] = [
    ("falling", DVec3::new(0.28, 0.75, 1.0), DVec3::Y, 24.0, 0.55),
    ("at rest, from above", DVec3::new(0.0, 1.0, 0.0), DVec3::NEG_Z, 12.0, 1.0),
    ("at rest", DVec3::new(-0.3, 0.8, 1.0), DVec3::Y, 24.0, 1.0),
];

/// A full word with its iteration.
struct Solution {
    iteration: u64,
    draw: Drops,
    rest: Rest,
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    one(work, "figure-5", &hi(|_| ())?, "HI", (420.0, 300.0))?;
    one(work, "figure-8", &acm(|_| ())?, "ACM", (520.0, 285.0))
}

/// Two full words of one chain: the first that it finds, and of the later ones the one with the fewest balls in the
/// same bins.
fn choose(word: &Word, looks: u64) -> Result<(Vec<Solution>, usize)> {
    let mut chain = Chain::start(&word.scene, &word.moves, Seed(SEED).chain(0))?;
    let mut found: Vec<Solution> = Vec::new();
    let mut best: Option<(usize, Solution)> = None;
    let same = |a: &Rest, b: &Rest| a.bins.iter().zip(&b.bins).filter(|(a, b)| a.is_some() && a == b).count();
    // Continues if that was too short to find two.
    while chain.iteration() < looks * APART || (best.is_none() && chain.iteration() < MOST) {
        chain.step()?;
        let state = chain.state();
        let due = found.is_empty() || chain.iteration().is_multiple_of(APART);
        if !due || word.scene.class(state.by_ref()).is_none() {
            continue;
        }
        let this = Solution { iteration: chain.iteration(), draw: state.draw.clone(), rest: state.outcome.clone() };
        let Some(first) = found.first() else {
            found.push(this);
            continue;
        };
        let common = same(&first.rest, &this.rest);
        if best.as_ref().is_none_or(|(least, _)| common < *least) {
            best = Some((common, this));
        }
    }
    let (common, second) = best.ok_or("the chain of the pictures has no second full word")?;
    found.push(second);
    Ok((found, common))
}

fn one(work: &mut Work, name: &str, word: &Word, text_of: &str, panel: (f64, f64)) -> Result<()> {
    work.say(format_args!("{name}: two of the words that a chain of seed {SEED} finds for {text_of}"));
    let (solutions, common) = choose(word, work.size(40, 3))?;
    let (gap, head) = (14.0, 62.0);
    let mut pictures = Vec::new();
    for (row, solution) in (0_u8..).zip(&solutions) {
        let animation = word.scene.animate(&solution.draw)?;
        let frame = animation.view.and_then(|view| view.frame).ok_or("the scene says nothing of what to look at")?;
        for (column, (_, from, up, field, share)) in (0_u8..).zip(VIEWS) {
            let dense = work.size(1.25, 0.25);
            let (width, height) = ((panel.0 * dense) as u32, (panel.1 * dense) as u32);
            let quality = Quality { width, height, rays: work.size(8, 2) };
            let camera = Camera::fitting(frame, from, up, field, panel.0 / panel.1);
            let image = render(&animation, share * animation.motion.duration, &camera, quality)?;
            let at = (gap + f64::from(column) * (panel.0 + gap), head + f64::from(row) * (panel.1 + 34.0));
            pictures.push(Picture { at, width: panel.0, image });
        }
    }
    let size = ((3.0 * panel.0 + 4.0 * gap) as u32, (head + 2.0 * (panel.1 + 34.0)) as u32);
    let balls = word.bins();
    canvas::save_with(&work.out, name, size, &pictures, |area| {
        let title = format!("Two ways in which {balls} balls spell {text_of}");
        write(area, &title, &bold(20.0, colour::INK), HPos::Left, (gap, 24.0))?;
        for (picture, (column, solution)) in
            pictures.iter().zip(solutions.iter().flat_map(|solution| VIEWS.iter().zip(std::iter::repeat(solution))))
        {
            let words = format!("iteration {}: {}", thousands(solution.iteration), column.0);
            write(area, &words, &text(13.0, colour::INK), HPos::Left, (picture.at.0, picture.at.1 - 11.0))?;
        }
        Ok(())
    })?;
    work.report.figure(
        name,
        format!(
            "Two of the full words of one exact chain (default moves, seed {SEED}), as the paper's {}: the first that it finds, and, of those every {APART} iterations later, the one \
             that has fewest balls in the same bins ({common} of {balls}). A ball has the same colour in all pictures \
             (eight colours in turn), so colours show in which order bins are \
             filled. Left: on the way; green plates are the designated bins.",
            name.replace('-', " "),
        ),
    );
    Ok(())
}
