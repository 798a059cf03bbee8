//! Solutions that a run finds in its warm-up are kept, shown and named if the run looks for solutions, and are no part
//! of statistics.

use crate::common::Place;

/// Every command that takes a solution takes one of the warm-up.
#[test]
fn the_first_solutions_are_kept_and_can_be_looked_at() {
    let place = Place::new();
    place.ok("sample ball.toml --out run --solutions 5 --warmup 1000000 -q");
    let list = place.ok("export run --format events --all-distinct --out all.csv");
    assert!(list.err.contains("wrote all.csv"), "{}", list.err);
    // A table names its sample in the form that `--sample` takes.
    let table = std::fs::read_to_string(place.path("all.csv")).unwrap();
    let named = table.lines().nth(1).unwrap().splitn(3, ',').take(2).collect::<Vec<_>>().join(":");
    assert!(named.contains(":w"), "{named}");
    place.ok(&format!("export run --format events --sample {named} --out one.csv"));
    place.ok("gallery run --out page.html").says(&["distinct solutions"]);
    let page = std::fs::read_to_string(place.path("page.html")).unwrap();
    assert!(page.contains("gallery"), "{}", page.len());
    let said = place.ok("sample ball.toml --out other --solutions 5 --warmup 1000000").out;
    let named = said.split_whitespace().find(|word| word.contains(":w")).unwrap();
    place
        .ok(&format!("replay other --sample {named}"))
        .says(&[&format!("sample {named} rebuilt bit for bit"), "satisfies"]);
    place.ok(&format!("export other --format glb --sample {named} --out one.glb"));
    place.ends("replay other --sample 0:w99999999", 2).says(&["there is no draw 0:w99999999", "are w0 to w"]);
    place.ends("replay other --sample 0:x1", 2).says(&["0:w17"]);
    place.ends("export other --format glb --sample 0:17 --out none.glb", 2).says(&[
        "no draws after the warm-up",
        "0:w0 to 0:w",
        "`--all-distinct`",
    ]);
    // None of its draws enters statistics.
    place.ends("export run --format csv --out draws.csv", 2).says(&["which statistics leave out"]);
    place.ends("diagnose run", 2).says(&["which statistics leave out"]);
}

/// The solutions are the same however a run comes to them: at once, on any number of threads, in two parts, in pieces.
#[test]
fn where_a_run_ends_in_its_warm_up_follows_from_its_plan() {
    let place = Place::new();
    let run = "sample ball.toml -q --chains 5 --warmup 100000 --thin 3";
    for wanted in [1, 9] {
        let whole = format!("whole{wanted}");
        place.ok(&format!("{run} --solutions {wanted} --out {whole} --threads 1"));
        place.ok(&format!("{run} --solutions {wanted} --out threads{wanted} --threads 4"));
        assert!(place.bytes(&whole) == place.bytes(&format!("threads{wanted}")));
        for piece in 1..=3 {
            place.ok(&format!("{run} --solutions {wanted} --shard {piece}/3 --out cut{wanted}/{piece}"));
        }
        place.ok(&format!("merge cut{wanted} --out all{wanted} -q"));
        assert!(place.bytes(&whole) == place.bytes(&format!("all{wanted}")));
    }
    place.ok("resume whole1 --solutions 9 -q");
    assert!(place.bytes("whole1") == place.bytes("whole9"));
}

/// Draws after the warm-up do not depend on whether solutions were looked for.
#[test]
fn draws_for_statistics_are_those_of_any_run() {
    let place = Place::new();
    place.ok("sample ball.toml --out plain -q");
    place.ends("sample ball.toml --out hunt --solutions 100000 -q", 1);
    place.ok("export plain --format csv --out plain.csv");
    place.ok("export hunt --format csv --out hunt.csv");
    let read = |name| std::fs::read(place.path(name)).unwrap();
    assert!(read("plain.csv") == read("hunt.csv"));
    let count = |run: &str, key: &str| {
        let said = place.run(&format!("diagnose {run} --json")).out;
        serde_json::from_str::<serde_json::Value>(&said).unwrap()[key].as_u64().unwrap()
    };
    assert_eq!(count("plain", "distinct_while_adapting"), 0);
    let early = count("hunt", "distinct_while_adapting");
    assert!(early > 0 && count("hunt", "distinct") >= early);
    assert_eq!(count("hunt", "first_hit"), count("plain", "first_hit"));
}

/// A run stopped in its warm-up shows the solutions that it has, and says that they will not count later.
#[test]
fn solutions_of_a_run_stopped_in_its_warm_up_can_be_used() {
    let place = Place::new();
    let run = "sample ball.toml --out run --warmup 1000000000 --thin 100";
    let stopped = place.ok(&format!("{run} --max-time 500ms"));
    assert!(!stopped.out.contains("\n0 distinct solutions"), "{}", stopped.out);
    for part in ["still in the warm-up", "only solutions after the warm-up count", "plaus gallery run"] {
        assert!(stopped.out.contains(part), "{}", stopped.out);
    }
    place.ok("gallery run --out page.html").says(&["distinct solutions"]);
    place.ok("export run --format events --all-distinct --out all.csv");
    // Statistics wait for the end of the warm-up.
    place.ends("diagnose run", 2).says(&["which statistics leave out"]);
}

/// A run that looks for solutions for a given time uses all of it, however few iterations the scenario has. A number of
/// iterations on the command line still ends it.
#[test]
fn the_scenario_s_iterations_do_not_end_a_search_that_was_given_time() {
    let place = Place::new();
    let search = "sample ball.toml --solutions 1000000 --warmup 10 --max-time 1s --set";
    let timed = place.ends(&format!("{search} drop_height=4.5 --out timed"), 1);
    timed.says(&["continue with: plaus resume timed"]);
    assert!(timed.out.contains("out of time after") && !timed.out.contains(" of 1,000"), "{}", timed.out);
    let counted = place.ends(&format!("{search} iterations=10 --out counted"), 1);
    assert!(counted.out.contains("done: 20 iterations of each chain"), "{}", counted.out);
}
