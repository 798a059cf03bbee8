//! Contradictions between requirements that are known before anything is simulated.

use super::cast::Cast;
use super::claim::Claim;
use super::kinds::Require;
use crate::scene::ConfigError;

/// Refuses requirements if two of them contradict each other. Each comes with its key.
pub(crate) fn agree(all: &[(String, Require)], cast: &Cast) -> Result<(), ConfigError> {
    let claims: Vec<(usize, Claim)> = all
        .iter()
        .enumerate()
        .flat_map(|(at, (_, one))| one.claims().into_iter().map(move |claim| (at, claim)))
        .collect();
    for (nth, (later, claim)) in claims.iter().enumerate() {
        for (earlier, other) in &claims[..nth] {
            let Some(why) = other.contradicts(claim, cast) else { continue };
            let (key, beside) = (&all[*later].0, &all[*earlier].0);
            let beside = if earlier == later { String::new() } else { format!(": see `{beside}`") };
            return Err(ConfigError::new(key.clone(), why + &beside));
        }
    }
    Ok(())
}
