//! Moves with typical mistakes. Each is caught by the check that the right move passes.

use super::moves::{constrained, free};
use super::plain::{AnyMove, small};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::library::{RedrawAll, RedrawGroup, Sizes, Symmetry};
use plaus_mcmc::{At, ModelError, Move, Proposal, Transition};
use plaus_scenes::dice::{Dice, Draw, Point, Shift, component, turn};

/// How a right move is made wrong.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Fault {
    /// Uses the ratio 1, whatever the right one is.
    Symmetric,
    /// Leaves out the part of the ratio that is known only after the simulation.
    Forgets,
    /// Makes changed control points too high by a standard deviation.
    Leans,
}

pub(crate) struct Faulty(pub(crate) AnyMove, pub(crate) Fault);

impl Move<Dice> for Faulty {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, candidate, stream)?;
        let Proposal::Candidate { path, .. } = proposal else { return Ok(proposal) };
        Ok(match self.1 {
            Fault::Symmetric => Proposal::SYMMETRIC,
            Fault::Forgets => Proposal::Candidate { log_ratio: LogRatio::ONE, path, later: None },
            Fault::Leans => {
                for (table, before) in candidate.tables.iter_mut().zip(&at.state.draw.tables) {
                    for (site, score) in table.changed_points().to_vec() {
                        if score != before.score(site) {
                            table.set(site, score + 1.0);
                        }
                    }
                }
                proposal
            }
        })
    }

    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(step)
    }

    fn log_ratio_after(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio_after(step)
    }
}

#[test]
fn faults_change_the_law() {
    let sizes = Sizes::new(0.9, 1.0);
    let dice = small(|_| ());
    let twins: Vec<(AnyMove, Fault)> = vec![
        // As in the paper: everything is drawn anew, and counted as symmetric.
        (Box::new(RedrawAll::exact("everything")), Fault::Symmetric),
        (Box::new(RedrawGroup { name: "rethrow" }), Fault::Symmetric),
        (Box::new(component(&dice, sizes)), Fault::Symmetric),
        (Box::new(Shift { sd: 0.02 }), Fault::Forgets),
    ];
    for (kernel, fault) in twins {
        let report = free(&dice, false, Box::new(Faulty(kernel, fault)));
        assert!(!report.passed(), "{fault:?} not caught: {report}");
    }
    // One die on a small table where only the height is random: few points are far from the measured ones.
    let bumpy = small(|config| {
        (config.dice, config.table.bounce_sd, config.table.grip_sd) = (1, 0.0, 0.0);
        (config.table.length_mm, config.table.width_mm) = (240.0, 60.0);
        config.constraints.remove(1);
    });
    for fault in [Fault::Forgets, Fault::Leans] {
        let report = free(&bumpy, false, Box::new(Faulty(Box::new(Point::near(sizes)), fault)));
        assert!(!report.passed(), "{fault:?} not caught: {report}");
    }
    let report = free(&bumpy, false, Box::new(Faulty(Box::new(Point::anywhere(sizes)), Fault::Leans)));
    assert!(!report.passed(), "not caught: {report}");
    for right in [Box::new(Point::near(sizes)) as AnyMove, Box::new(Point::anywhere(sizes))] {
        let report = free(&bumpy, false, right);
        assert!(report.passed(), "{report}");
    }
    // With the constraint on, the fault of aiming shows even more.
    let report = constrained(&dice, false, Box::new(Faulty(Box::new(Shift { sd: 0.02 }), Fault::Forgets)));
    assert!(!report.passed(), "not caught: {report}");
    // The same on a flat table, where a shift may have any length.
    let flat = small(|config| (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (0.0, 0.0, 0.0));
    let report = constrained(&flat, false, Box::new(Faulty(Box::new(Shift { sd: 0.02 }), Fault::Forgets)));
    assert!(!report.passed(), "not caught: {report}");
}

/// A slab that always lies on its large faces shows another face only if its pips are turned as if it were a cube.
#[test]
fn a_slab_that_is_taken_for_a_cube_changes_the_law_of_faces() {
    let slab = || small(|config| config.die.edge_x_mm = 8.0);
    assert_eq!(slab().prior().turns(), 8);
    let turn = || Box::new(Symmetry { name: "turn", map: turn });
    let report = free(&slab(), true, turn());
    assert!(report.passed(), "{report}");
    let wrong = slab().taken_for_cubes();
    let toy = super::plain::Plain { dice: &wrong, flat: true };
    let moves = plaus_mcmc::view::lend::<super::plain::Plain<'_>>(plaus_mcmc::Mixture::of(turn())).unwrap();
    let plan = plaus_mcmc::check::OneStep { samples: 2000, ..Default::default() };
    let free = plaus_mcmc::check::prior(&toy);
    let report = plaus_mcmc::check::one_step(&toy, &moves, free, &super::plain::statistics(), plan).unwrap();
    assert!(!report.passed(), "not caught: {report}");
}
