//! Moves that are wrong in the ways in which one goes wrong, each caught by the check that the right one passes; the
//! paper's errata among them.

use super::moves::{constrained, free};
use super::straight::{AnyMove, small};
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};
use plaus_scenes::spelling::{
    BirthDeath, ChangeAll, ChangeBall, ChangeVertices, Drops, RedrawVertices, Redrop, Spelling, Toggle,
};
use plaus_scenes::{Rules, Scene};

/// What is done to a right move to make it wrong.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// Whatever the ratio, 1 is used.
    Symmetric,
    /// What is known after the simulation only is forgotten.
    Forgets,
    /// The area of the drop rectangle in another unit: m² for mm².
    Unit,
    /// Positions that leave the rectangle come back at its edge.
    Clamps,
    /// Steps have a mean.
    Leans,
}

struct Faulty(AnyMove, Fault);

impl Move<Spelling> for Faulty {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn propose(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(target, current, candidate, stream)?;
        let Proposal::Candidate { log_ratio, path, later } = proposal else { return Ok(proposal) };
        let ring = target.prior().wrapped();
        Ok(match self.1 {
            Fault::Symmetric => Proposal::SYMMETRIC,
            Fault::Forgets => {
                Proposal::Candidate { log_ratio: log_ratio.times(later.unwrap_or(LogRatio::ONE))?, path, later: None }
            }
            Fault::Unit => {
                let balls = candidate.active() as f64 - current.draw.active() as f64;
                Proposal::Candidate {
                    log_ratio: LogRatio::new(log_ratio.value() - balls * math::ln(1e6))?,
                    path,
                    later,
                }
            }
            Fault::Clamps => {
                for (new, old) in candidate.balls.iter_mut().zip(&current.draw.balls) {
                    if let (Some(new), Some(old)) = (new, old) {
                        for axis in 0..2 {
                            // A step of more than half the rectangle went around.
                            let (low, high) = (ring[axis].low(), ring[axis].high());
                            if (new[axis] - old[axis]).abs() > 0.5 * (high - low) {
                                new[axis] = if new[axis] > old[axis] { low } else { high.next_down() };
                            }
                        }
                    }
                }
                proposal
            }
            Fault::Leans => {
                for (new, old) in candidate.offsets.iter_mut().zip(&current.draw.offsets) {
                    if new != old {
                        new[0] += 0.02;
                    }
                }
                proposal
            }
        })
    }

    fn log_ratio(
        &self,
        t: &Spelling,
        from: &StateOf<Spelling>,
        to: &StateOf<Spelling>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(t, from, to, path)
    }

    fn reverse(&self, path: Path) -> Path {
        self.0.reverse(path)
    }

    fn log_ratio_after(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &StateOf<Spelling>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        self.0.log_ratio_after(target, current, candidate, path)
    }
}

fn toggle() -> AnyMove {
    Box::new(Toggle { chance: 0.25, incomplete: false })
}

#[test]
fn the_paper_s_errata_change_the_law() {
    let twins: Vec<AnyMove> = vec![
        Box::new(ChangeAll { symmetric: true, radial_offsets: false }),
        Box::new(ChangeAll { symmetric: false, radial_offsets: true }),
        Box::new(ChangeAll { symmetric: true, radial_offsets: true }),
        Box::new(Toggle { chance: 0.25, incomplete: true }),
    ];
    for twin in twins {
        let report = free(&small(0.0), twin);
        assert!(!report.passed(), "not caught: {report}");
    }
}

#[test]
fn other_faults_change_the_law() {
    let twins: Vec<(AnyMove, Fault)> = vec![
        (toggle(), Fault::Symmetric),
        (toggle(), Fault::Unit),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Symmetric),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Forgets),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Unit),
        (Box::new(RedrawVertices { chance: 0.2 }), Fault::Symmetric),
        (Box::new(Redrop { aimed: 0.7 }), Fault::Symmetric),
        (Box::new(Redrop { aimed: 0.7 }), Fault::Forgets),
        (Box::new(ChangeBall { sd: 20.0 }), Fault::Clamps),
        (Box::new(ChangeVertices { chance: 0.2, sd: 0.2 }), Fault::Leans),
    ];
    for (kernel, fault) in twins {
        let report = free(&small(0.0), Box::new(Faulty(kernel, fault)));
        assert!(!report.passed(), "{fault:?} not caught: {report}");
    }
    // With the constraint on, aiming shows even more.
    let report = constrained(&small(1.0), Box::new(Faulty(Box::new(Redrop { aimed: 0.7 }), Fault::Symmetric)));
    assert!(!report.passed(), "not caught: {report}");
}

/// A fresh radial draw is likelier, under the Gaussian, than one of the Gaussian itself, by about a nat a vertex: the
/// paper's change-all effect.
#[test]
fn radial_offsets_gain_a_nat_a_vertex() {
    let scene = super::straight::scene(|_| ());
    let mean = |as_printed: bool| {
        let mut draw = Drops { offsets: Vec::new(), balls: Vec::new() };
        let mut stream = plaus_dist::Seed(1).chain(0).at(0, plaus_dist::Purpose::START);
        let sum: f64 = (0..20_000)
            .map(|_| {
                scene.prior().sample(as_printed, &mut draw, &mut stream);
                draw.offsets.iter().flatten().map(|x| -0.5 * math::square(x / 0.1)).sum::<f64>()
            })
            .sum();
        sum / 20_000.0
    };
    // −V/2 against −3V/2 with V = 48. One draw has a variance of 48 · ½ and 144 · ½: six standard errors of the means
    // are 0.21 and 0.36.
    assert!((mean(true) + 24.0).abs() < 0.21, "{}", mean(true));
    assert!((mean(false) + 72.0).abs() < 0.36, "{}", mean(false));
}

#[test]
fn rules_reach_the_moves_flag_by_flag() {
    let scene = small(0.0);
    let rules = |text: &str| -> Rules {
        let scenario = format!("[sampler.rules]\n{text}\n[world.spelling]");
        plaus_scenes::Scenario::read("rules", &scenario, &[]).unwrap().sampler.rules
    };
    assert!(scene.moves(&Rules::exact()).is_ok() && Rules::exact().is_exact());
    let flags =
        |text: &str| rules(text).flags().into_iter().filter(|flag| flag.1).map(|flag| flag.0).collect::<Vec<_>>();
    assert_eq!(flags("preset = \"as-printed\""), ["symmetric_redraws", "radial_offsets", "incomplete_toggles"]);
    assert_eq!(flags("radial_offsets = true"), ["radial_offsets"]);
    assert_eq!(flags("preset = \"as-printed\"\nradial_offsets = false"), ["symmetric_redraws", "incomplete_toggles"]);
    assert_eq!(flags("incomplete_toggles = true"), ["incomplete_toggles"]);
}
