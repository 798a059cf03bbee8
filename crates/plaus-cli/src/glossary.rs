//! Words that the program uses and an animator need not know, for `plaus explain`.

/// Words, and what each means.
const WORDS: &[(&[&str], &str)] = &[
    (
        &["chain", "chains"],
        "one search for animations. It goes from animation to animation, changes something at random at every step, and \
         keeps the change or drops it such that, in the long run, each animation comes up as often as it is plausible. \
         A run has several chains, independent of each other: where they agree, the result no longer depends on where \
         they began.",
    ),
    (&["iteration", "iterations"], "one step of a chain: a change is proposed, simulated, and kept or dropped."),
    (
        &["draw", "draws", "sample"],
        "an animation that a chain was at and that was recorded; its number is CHAIN:DRAW, e.g. 0:17. Only what was \
         random is stored: the animation is simulated again from that.",
    ),
    (
        &["distinct", "solution", "solutions", "hit", "hits"],
        "a solution, or hit, is an animation in which what was demanded happens. Two solutions are distinct where they \
         differ in kind and not only by a little: by the number and order of impacts, or where things come to rest, \
         depending on the scene.",
    ),
    (
        &["warm-up", "warmup"],
        "the first iterations of each chain, in which it forgets where it began and finds out how large its steps should be. They are recorded, but are no part \
         of statistics; what they find is a solution all the same, of which `--solutions` takes each.",
    ),
    (
        &["log p", "log_p"],
        "the logarithm of how plausible an animation is, up to a constant: of two animations, the one with the larger \
         value is likelier by the exponential of the difference.",
    ),
    (&["k"], "how many parts of the wish are fulfilled: filled bins of a word, pins that end as they should."),
    (&["m"], "how many bodies take part: balls that are dropped."),
    (
        &["ln lambda", "lambda"],
        "how much each fulfilled part of a wish counts: an animation with one more is e^ln_lambda times as likely.",
    ),
    (&["acceptance", "accepted"], "the share of a move's proposals that a chain kept."),
    (
        &["r-hat", "rhat"],
        "compares the chains with each other: 1 where they agree, above 1.01 where they are still at different things. \
         It says whether averages over the run can be trusted; each single solution holds in any case.",
    ),
    (
        &["independent", "independent solutions"],
        "how many solutions, each drawn anew, those of the run are worth: counted by that random variable of theirs which \
         changes most slowly from solution to solution. A chain that stays near one solution has many distinct ones, \
         and few independent ones. Where draws of the prior are kept instead (`sampler.method`), each solution is \
         drawn by itself, and they are as many as were kept.",
    ),
    (&["ess"], "effective sample size: how many independent animations the recorded ones are worth for an average."),
    (&["mcse"], "Monte Carlo standard error: how far an average over the run is likely to be off."),
    (
        &["rung", "rungs", "tempering", "restart", "restarts"],
        "copies of a chain for which the wish counts less, down to not at all; they exchange animations, so that a chain \
         gets fresh starts and stays exact.",
    ),
];

/// What a word means; `None` for one that is no word of the program.
pub(crate) fn meaning(word: &str) -> Option<&'static str> {
    let word = word.trim().to_lowercase();
    WORDS.iter().find(|(names, _)| names.contains(&word.as_str())).map(|(_, meaning)| *meaning)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_summary_are_explained() {
        for word in ["chain", "distinct", "Log p", "R-hat", "ESS", "k", "m", "warm-up"] {
            assert!(meaning(word).is_some(), "{word}");
        }
        assert_eq!(meaning("sigma_d"), None);
    }
}
