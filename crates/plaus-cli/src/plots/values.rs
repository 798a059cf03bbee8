//! The numbers of a run's solutions.

use plaus_run::{RunFileError, RunReader};
use plaus_scenes::{Role, Scalar, Scene};

/// Some scalars of all recorded solutions.
pub(crate) struct Values {
    /// For each recorded state that is a solution: how often it counts, and its scalars. In chains that is how many
    /// draws recorded it; independent draws, and solutions that were searched for, count once, however long a chain
    /// stayed at them.
    pub(crate) rows: Vec<(u64, Vec<f64>)>,
    /// How many draws there are, solutions and others, counted likewise.
    pub(crate) draws: u64,
    /// What a reader of the shares must know; empty for independent draws.
    pub(crate) caution: &'static str,
}

impl Values {
    /// The scalars with these numbers, in the phases in which solutions count.
    ///
    /// # Errors
    /// [`RunFileError`] if the records are damaged.
    pub(crate) fn of(run: &RunReader<'_>, wanted: &[usize]) -> Result<Self, RunFileError> {
        let (width, manifest) = (run.scene().scalars().len(), run.run().manifest());
        let (caution, once) = match (manifest.plan.climbs > 0, manifest.is_independent()) {
            (true, _) => ("; they were searched for, not sampled, so their shares mean nothing", true),
            (false, true) => ("", true),
            (false, false) => {
                ("; draws of a chain resemble each other: `plaus diagnose` counts independent ones", false)
            }
        };
        let of_chain = |chain| -> Result<Self, RunFileError> {
            let (mut found, mut values) = (Self { rows: Vec::new(), draws: 0, caution }, vec![0.0; width]);
            let mut has_begun = false;
            for &phase in run.counted() {
                run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
                    let is_known = once && has_begun && repeats.accepted == 0;
                    has_begun = true;
                    if is_known {
                        return Ok(());
                    }
                    let draws = if once { 1 } else { repeats.draws };
                    found.draws += draws;
                    if repeats.entry.class.is_some() {
                        run.scene().write_scalars(repeats.entry.state.by_ref(), &mut values);
                        found.rows.push((draws, wanted.iter().map(|&index| values[index]).collect()));
                    }
                    Ok(())
                })?;
            }
            Ok(found)
        };
        let chains = run.each_chain(of_chain)?;
        let draws = chains.iter().map(|chain| chain.draws).sum();
        Ok(Self { rows: chains.into_iter().flat_map(|chain| chain.rows).collect(), draws, caution })
    }

    /// Draws that are solutions.
    pub(crate) fn solutions(&self) -> u64 {
        self.rows.iter().map(|(draws, _)| draws).sum()
    }
}

/// Where something ends on the plan: a name, and the numbers of its two coordinates among a scene's scalars.
pub(crate) struct Place {
    /// What ends there; empty if the scene has only one thing.
    pub(crate) name: String,
    /// The scalars of x and y.
    pub(crate) at: [usize; 2],
}

/// All pairs of outcomes that are coordinates in the plan.
pub(crate) fn places(scalars: &[Scalar]) -> Vec<Place> {
    let of_x = |(index, x): (usize, &Scalar)| {
        let (before, after) = x.name.rsplit_once("_x").filter(|_| x.role == Role::Outcome)?;
        let wanted = format!("{before}_y{after}");
        let y = scalars.iter().position(|y| y.name == wanted && y.unit == x.unit && y.role == Role::Outcome)?;
        let name = match before.rsplit_once('.') {
            Some((body, _)) => body.to_owned(),
            None => after.trim_start_matches('_').to_owned(),
        };
        Some(Place { name, at: [index, y] })
    };
    scalars.iter().enumerate().filter_map(of_x).collect()
}
