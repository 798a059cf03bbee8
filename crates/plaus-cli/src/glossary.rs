//! Words in the program's output that an animator may not know, for `plaus explain`.

/// Words, and what each means.
const WORDS: &[(&[&str], &str)] = &[
    (
        &["chain", "chains"],
        "a walk from animation to animation. At every step it changes something at random, \
         and keeps or drops the change, so that in the long run each animation comes up as often as it is plausible. \
         A run has several chains, independent of each other: where they agree, the result no longer depends on where \
         they began.",
    ),
    (&["iteration", "iterations"], "one step of a chain: a change is proposed, simulated, and kept or dropped."),
    (
        &["draw", "draws", "sample", "samples", "state", "states", "recorded state"],
        "one set of values for everything uncertain, and the animation that follows from it, as a chain recorded it. Its number is CHAIN:DRAW: 0:17 is draw 17 of chain 0, and 0:w17 \
         is draw 17 of that chain's warm-up (w). Only the random values are stored; the animation is simulated again \
         from them.",
    ),
    (
        &["distinct", "solution", "solutions", "hit", "hits", "satisfied", "satisfying"],
        "a solution, or hit, is an animation in which everything happens that the scenario asks for. Two solutions are \
         distinct if they differ in kind, and not only by a little: in the number and order of impacts, or in where \
         things come to rest, depending on the scene. `sampler.distinct_scale` says how far apart things must be to \
         count as different: `--set distinct_scale=2` means twice as far as usual, 0.5 half as far. A solution is \
         named by its chain and draw: 0:17 is draw 17 of chain 0, 0:w17 is draw 17 of its warm-up (w). A run with \
         `--solutions K` counts only those that look clearly different: some body's way, or how it ends, differs by \
         3 % of what is seen, times `distinct_scale`.",
    ),
    (
        &["climb", "climbs", "search", "searches", "found", "weighted"],
        "a search for one solution: from a fresh draw of the prior a chain moves towards the requirements until they \
         are met. `--solutions` does so where draws from the prior seldom succeed. What it finds is plausible, but \
         carries no statistical weight: how many of a kind there are says nothing about how often it happens. \
         `--exact` counts only sampled solutions, which represent the distribution.",
    ),
    (
        &["warm-up", "warmup"],
        "the first iterations of each chain. In these it forgets where it began, and finds out how large its steps \
         should be. They are recorded, but statistics leave them out. A solution found in them is still a solution, \
         and `--solutions` counts it.",
    ),
    (
        &["log p", "log_p"],
        "the logarithm of how plausible an animation is, up to a constant. Of two animations, the one with the larger \
         value is likelier, by the exponential of the difference.",
    ),
    (&["k"], "how many of the things asked for happen: bins of a word that are filled, pins that end as they should."),
    (&["m"], "in bowling: how many of the pins that should stand do stand, and have not moved far."),
    (&["active"], "in spelling: how many of the balls are dropped."),
    (
        &["ln lambda", "lambda"],
        "how much each thing asked for counts: an animation with one more of them is e^ln_lambda times as likely.",
    ),
    (&["acceptance", "accepted"], "the share of a move's proposals that a chain kept."),
    (
        &["r-hat", "rhat"],
        "compares the chains with each other: 1 if they agree, above 1.01 if they still explore different things. It \
         says whether averages over the run can be trusted. Each single solution is right in any case.",
    ),
    (
        &["independent", "independent solutions"],
        "how many independently drawn solutions the run's solutions are worth. The estimate uses the random \
         variable that changes most slowly from solution to solution. A chain that stays near one solution has many \
         distinct ones, and few independent ones. With independent draws from the prior (`sampler.method`), every \
         solution kept is independent of the others.",
    ),
    (
        &["run", "runs", "run folder"],
        "what one `plaus sample` makes: a folder with the scenario, all recorded draws, and checkpoints from which \
         `plaus resume` continues.",
    ),
    (
        &["checkpoint", "checkpoints"],
        "the state of all chains on disk, from which `plaus resume` continues after a stop or a crash.",
    ),
    (&["gallery"], "one HTML page that plays the solutions of a run; `plaus gallery RUN --out page.html` writes it."),
    (&["d"], "in ball2d: the unit of length, the ball's diameter."),
    (
        &["counting", "splitting", "stepping stones", "stones", "importance", "importance sampling"],
        "the methods of `plaus chance`. Counting: the share of draws from the prior that meet the requirement. \
         Splitting: repeatedly keep the best draws, copy and perturb them. Stepping stones: chains for which the \
         requirement counts more and more; the ratios between neighbours multiply up. Importance sampling: draws from \
         a widened prior, each hit weighted by the ratio of the two densities.",
    ),
    (
        &["posterior"],
        "what remains likely once the requirement is known to be met: the law from which a run draws its solutions.",
    ),
    (
        &["prior"],
        "what the scenario says about each uncertain value before anything is asked for. A draw from the prior is an \
         animation that simply happens; most of them meet no requirement.",
    ),
    (
        &["law", "laws", "uncertain", "distribution"],
        "how likely each value of an uncertain number is, for example `{ normal = [1.0, 0.5] }`: about 1, give or take \
         0.5.",
    ),
    (
        &["move", "moves"],
        "a way in which a chain changes an animation: it draws a value anew, or changes one a little.",
    ),
    (
        &["outcome", "outcomes"],
        "what an animation leads to, such as where a ball comes to rest. Variables are what goes into it.",
    ),
    (
        &["variable", "variables", "scalar", "scalars"],
        "a number of each animation that is recorded for statistics: an uncertain value (variable of the draw), or an \
         outcome.",
    ),
    (
        &["requirement", "requirements", "constraint", "constraints"],
        "what must happen. A constraint can be met more or less well. The worse it is met, the less likely a chain \
         keeps the animation. A requirement (`require`) is met or not, and every solution meets all of them.",
    ),
    (
        &["margin", "margins"],
        "how well a requirement is met, in nats: 0 or more if it is met; below 0, how much is lacking, divided by the \
         `scale` among its keys.",
    ),
    (
        &["accuracy", "preset", "draft", "standard", "fine", "reference"],
        "how closely the simulator follows the laws of motion: draft, standard, fine or reference. Finer ones take \
         longer.",
    ),
    (
        &["barrier"],
        "how hard it is to get from animations of the prior to solutions, as tempered chains measured it. A chain \
         needs about twice as many rungs as this number says.",
    ),
    (&["rms"], "root mean square: the typical size of differences. Their squares are averaged, and the root is taken."),
    (
        &["ess", "ess bulk", "ess tail", "effective sample size"],
        "effective sample size: the number of independent animations whose averages would be as precise. Bulk is for \
         means, tail for the ends of the distribution.",
    ),
    (&["scene", "scenes"], "a kind of world that plaus knows: ball2d, spelling, bowling, dice, or custom, your own."),
    (
        &["scenario", "scenarios"],
        "a file that describes one world of a scene, what is uncertain in it, and what must happen.",
    ),
    (
        &["nat", "nats", "log constraint"],
        "the unit of log p: one nat more makes an animation 2.7 times as likely. A requirement that is missed by 3 nats \
         makes it 20 times less likely; by 200 nats, as good as impossible. The log constraint is what all that is \
         asked for adds to log p.",
    ),
    (
        &["acceptance rule", "exact acceptance", "exact", "hastings", "hastings ratio"],
        "how a chain decides whether to keep a change. Exact: so that in the long run animations come up exactly as \
         often as they are plausible. For that, a change that is easier to make than to undo is kept less often; the \
         correction is called the Hastings ratio.",
    ),
    (
        &["mcmc", "markov chain monte carlo"],
        "Markov chain Monte Carlo, the method by which plaus samples: see `plaus explain chain`.",
    ),
    (
        &["seed", "seeds"],
        "the number that decides everything random. The same scenario and seed give the same run again.",
    ),
    (
        &["piece", "pieces", "shard", "shards"],
        "some of a run's chains, sampled on their own, perhaps on another machine. `plaus merge` puts the pieces \
         together.",
    ),
    (&["eta"], "estimated time of arrival: how much longer it may take at the present speed."),
    (&["thin", "thinning"], "how many iterations there are for each one that is recorded: with 10, every tenth is."),
    (&["mcse"], "Monte Carlo standard error: how far an average over the run is likely to be off."),
    (
        &["rung", "rungs", "tempering", "restart", "restarts"],
        "copies of a chain for which the requirements count less, down to not at all. They exchange animations with \
         it, so that the chain gets fresh starts and remains exact.",
    ),
];

/// The meaning of a word; `None` for a word that the glossary does not have.
pub(crate) fn meaning(word: &str) -> Option<&'static str> {
    let word = word.trim().to_lowercase();
    WORDS.iter().find(|(names, _)| names.contains(&word.as_str())).map(|(_, meaning)| *meaning)
}

/// The words, each in its first form.
pub(crate) fn words() -> impl Iterator<Item = &'static str> {
    WORDS.iter().filter_map(|(names, _)| names.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_summary_are_explained() {
        for word in ["chain", "distinct", "Log p", "R-hat", "ESS", "k", "m", "warm-up", "prior", "move", "outcome"]
            .into_iter()
            .chain(["scene", "scenario", "nats", "log constraint", "exact acceptance", "shard", "MCMC", "ETA"])
            .chain(["scalar", "ESS bulk", "ESS tail", "barrier", "requirement", "margin", "MCSE", "rung", "RMS"])
        {
            assert!(meaning(word).is_some(), "{word}");
        }
        assert_eq!(meaning("sigma_d"), None);
    }

    #[test]
    fn each_word_has_one_meaning() {
        let mut all: Vec<&str> = WORDS.iter().flat_map(|(names, _)| names.iter().copied()).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
