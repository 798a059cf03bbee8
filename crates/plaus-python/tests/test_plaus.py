"""The package as users have it: installed in its own environment. Run by `cargo xtask wheel --check`."""

import filecmp
import json
import math
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading
import time
import traceback

import numpy as np
import pytest

import plaus
from plaus import sim

SCENARIOS = pathlib.Path(os.environ["PLAUS_SCENARIOS"])
# The `plaus` built from the same sources, to compare bytes with; if it is not given, the one of the wheel.
COMMAND = [os.environ.get("PLAUS_COMMAND") or str(pathlib.Path(sys.executable).with_name("plaus"))]


@pytest.fixture(autouse=True)
def interruptible():
    """Ctrl-C has an effect even if the tests run in the background, where shells let programs ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def short(**how):
    """A run of a second or less."""
    return plaus.sample(SCENARIOS / "ball2d.toml", **{"iterations": 2000, "warmup": 200, "progress": False, **how})


@pytest.fixture(scope="module")
def run():
    return short()


def files(folder):
    return sorted(path.name for path in pathlib.Path(folder).iterdir())


def same_bytes(one, other):
    names = files(one)
    assert names == files(other)
    matching, different, broken = filecmp.cmpfiles(one, other, names, shallow=False)
    assert not different and not broken, (different, broken)


# --- scenarios


def test_how_scenarios_are_made_is_told():
    with pytest.raises(TypeError, match="use Scenario.from_file"):
        plaus.Scenario("ball.toml")
    with pytest.raises(FileNotFoundError, match="No such file or directory: 'nofile.toml'"):
        plaus.Scenario.from_file("nofile.toml")


def test_scenarios_from_file_text_and_dictionary_are_equal():
    text = "[world.ball2d]\ntarget = 2\ncollisions = 3\n"
    one = plaus.Scenario.from_text(text)
    other = plaus.Scenario.from_dict({"world": {"ball2d": {"target": 2, "collisions": np.int64(3)}}})
    third = plaus.Scenario.default("ball2d").set("target=2", collisions=3)
    assert one == other == third and hash(one) == hash(other)
    assert one != one.set(sigma_d=0.2)
    assert one.check()["world"]["ball2d"]["collisions"] == 3
    assert pickle.loads(pickle.dumps(one.set(seed=4))) == one.set(seed=4)
    assert plaus.Scenario.from_file(SCENARIOS / "dice-one.toml").scene == "dice"


def test_files_beside_a_scenario_go_with_it(tmp_path):
    (tmp_path / "beats.csv").write_text("0.25\n0.75\n")
    world = "[world.ball2d]\n[[require]]\nbeats = { each = 'beat', times_from = { file = 'beats.csv' } }\n"
    (tmp_path / "beats.toml").write_text(world)
    one = plaus.Scenario.from_file(tmp_path / "beats.toml")
    (tmp_path / "beats.csv").unlink()
    assert pickle.loads(pickle.dumps(one)).set(seed=4) == one.set(seed=4) != one


def test_a_wrong_scenario_says_where_and_what_would_mend_it():
    with pytest.raises(plaus.ScenarioError) as caught:
        plaus.Scenario.from_text("[world.ball2d]\nsigma_d = -1\ntraget = 2\n")
    error = caught.value
    assert [problem.line for problem in error.problems] == [2, 3]
    assert (error.line, error.key) == (2, "world.ball2d.sigma_d")
    assert error.problems[1].column == 1 and "target" in error.problems[1].hint
    with pytest.raises(plaus.ScenarioError) as caught:
        plaus.Scenario.default("ball2d").set("sigma_d=wide")
    assert caught.value.problems[0].said == "sigma_d=wide" and caught.value.line is None
    with pytest.raises(TypeError, match=r"write set\(key=value\)"):
        plaus.Scenario.default("ball2d").set("chains", 3)
    with pytest.raises(plaus.ScenarioError, match="ball2d, bowling, spelling, dice"):
        plaus.Scenario.default("billiards")


@pytest.mark.parametrize("wrong", [object(), {1, 2}, None, b"x"])
def test_a_dictionary_of_wrong_types_is_refused_with_its_place(wrong):
    with pytest.raises(TypeError, match="world.ball2d.target"):
        plaus.Scenario.from_dict({"world": {"ball2d": {"target": wrong}}})


def test_a_scenario_with_a_nan_is_refused():
    with pytest.raises(plaus.ScenarioError):
        plaus.Scenario.default("ball2d").set(target=math.nan)


# --- runs


@pytest.mark.parametrize("scenario", ["ball2d", "dice-one", "spelling-hi"])
def test_bytes_are_those_of_the_command(scenario, tmp_path):
    how = ["--seed", "7", "--chains", "3", "--iterations", "300", "--warmup", "100"]
    path = SCENARIOS / f"{scenario}.toml"
    command = [*COMMAND, "sample", path, "--out", tmp_path / "a", *how, "--set", "sampler.thin=2", "--quiet"]
    assert subprocess.run(command, check=False, capture_output=True).returncode in (0, 1)
    plaus.sample(
        path, out=tmp_path / "b", seed=7, chains=3, iterations=300, warmup=100, set=["sampler.thin=2"], threads=1
    )
    same_bytes(tmp_path / "a", tmp_path / "b")


def test_draws_are_those_of_the_export(run, tmp_path):
    run.export(tmp_path / "draws.csv")
    header, *rows = (tmp_path / "draws.csv").read_text().splitlines()
    draws = run.draws
    assert header.split(",") == list(draws)
    assert len(rows) == draws.rows == run.chains * run.draw_count
    for index in (0, 77, len(rows) - 1):
        for name, text in zip(header.split(","), rows[index].split(","), strict=True):
            value = draws[name][index]
            assert value == (text == "true" if name == "satisfied" else float(text)), name
    assert draws.units["rest_x"] == "D"


def test_arrays_are_not_to_be_written_to(run):
    with pytest.raises(ValueError, match="read-only"):
        run.draws["rest_x"][0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        run.poses().position[0] = 0.0


def test_columns_share_memory_with_what_was_read(run):
    tree = pytest.importorskip("xarray") and run.to_datatree()
    values = tree["posterior"]["rest_x"].values
    assert not values.flags.owndata and values.shape == (run.chains, run.draw_count)
    assert set(tree.children) == {"posterior", "sample_stats", "warmup_posterior", "warmup_sample_stats"}
    assert np.array_equal(values.reshape(-1), run.draws["rest_x"])
    assert tree["posterior"]["rest_x"].attrs["unit"] == "D" and tree.attrs["seed"] == run.seed


def test_arviz_says_what_we_say(run):
    az = pytest.importorskip("arviz")
    data = run.to_inferencedata()
    ours = {row["name"]: row["summary"] for row in run.diagnose()["scalars"]}
    theirs = float(az.rhat(data)["rest_x"].values) if hasattr(az.rhat(data), "data_vars") else None
    if theirs is None:
        theirs = float(az.rhat(data)["posterior"]["rest_x"].values)
    assert theirs == pytest.approx(ours["rest_x"]["rhat"], rel=1e-9)


def test_the_most_different_solutions_begin_with_the_likeliest(run):
    five = run.most_different(5)
    assert five == run.most_different(12)[:5] and all(one in run.solutions for one in five)
    assert len({one.sample for one in five}) == 5
    assert five[0].log_p == max(one.log_p for one in run.solutions)
    assert run.most_different(0) == []


def test_solutions_replays_and_events_agree(run):
    solution = run.solutions[3]
    replay = run.replay(3)
    assert (replay.chain, replay.draw, False) == solution.sample and replay.log_p == solution.log_p and replay.satisfied
    assert run.replay(str(solution.sample)).facts == run.replay(solution).facts == replay.facts
    poses = replay.poses(fps=100)
    assert poses.position.shape == (len(poses.times), 1, 3) and poses.bodies == replay.bodies == ["ball_0"]
    assert np.allclose(np.linalg.norm(poses.orientation, axis=2), 1.0)
    events = replay.events
    # At an impact the ball's centre is its radius away from the point of contact, along the normal.
    at = replay.poses(times=events["t"]).position[:, 0]
    gaps = np.linalg.norm(at - events.point, axis=1)
    assert np.allclose(gaps, gaps[0], atol=1e-9) and events.count == len(events["t"]) >= 3
    assert run.replays([3, 4])[0].facts == replay.facts


def test_a_missing_solution_or_draw_is_named(run):
    with pytest.raises(IndexError, match="there is no solution 100000"):
        run.replay(100_000)
    with pytest.raises(plaus.RunError, match="there is no draw 0:99999"):
        run.replay((0, 99_999))
    with pytest.raises(ValueError, match="CHAIN:DRAW"):
        run.replay("seventeen")
    with pytest.raises(TypeError, match="names no sample"):
        run.replay(1.5)
    for fps in (0.0, -1.0, math.nan, math.inf, 1e12):
        with pytest.raises(ValueError, match="fps"):
            run.poses(0, fps)
    with pytest.raises(ValueError, match="NaN is not a time"):
        run.replay().poses(times=[math.nan])


def test_a_gallery_shows_itself_in_a_frame_that_sees_nothing(run, tmp_path):
    gallery = run.gallery(5)
    assert gallery.shown == 5 and gallery.distinct == len(run.solutions)
    html = gallery._repr_html_()
    assert (
        html.startswith('<iframe sandbox="allow-scripts allow-downloads" srcdoc="') and "allow-same-origin" not in html
    )
    gallery.save(tmp_path / "page.html")
    with pytest.raises(FileExistsError):
        gallery.save(tmp_path / "page.html")
    with pytest.raises(ValueError, match="from 1 to 5000"):
        run.gallery(0)


def test_exports_are_those_of_the_command(run, tmp_path):
    run.export(tmp_path / "one.glb", samples=0, fps=30)
    sample = str(run.solutions[0].sample)
    command = [
        *COMMAND,
        "export",
        run.path,
        "--format",
        "glb",
        "--sample",
        sample,
        "--fps",
        "30",
        "--out",
        tmp_path / "two.glb",
    ]
    subprocess.run(command, check=True, capture_output=True)
    assert (tmp_path / "one.glb").read_bytes() == (tmp_path / "two.glb").read_bytes()
    run.export(tmp_path / "events.json", samples=[0, 1])
    assert len(json.loads((tmp_path / "events.json").read_text())["impacts"]) == 2
    run.export(tmp_path / "all.glb", samples=[0, 1])
    subprocess.run(
        [*COMMAND, "export", run.path, "--format", "glb", "--sample", sample, "--sample"]
        + [str(run.solutions[1].sample), "--into", tmp_path / "both.glb"],
        check=True,
        capture_output=True,
    )
    assert (tmp_path / "all.glb").read_bytes() == (tmp_path / "both.glb").read_bytes()
    with pytest.raises(plaus.RunError, match="already exists"):
        run.export(tmp_path / "one.glb", samples=0)


def test_a_run_can_be_kept_opened_and_gone_on_with(tmp_path):
    kept = short(iterations=500).save(tmp_path / "kept")
    longer = plaus.resume(kept.path, iterations=1500, progress=False)
    assert longer.ending == "complete" and longer.draw_count == 1500
    whole = short(iterations=500, out=tmp_path / "whole").resume(iterations=1500, progress=False)
    assert np.array_equal(whole.draws["rest_x"], longer.draws["rest_x"])
    opened = plaus.Run(kept.path)
    assert opened.draw_count == 1500 and opened.ending is None and opened.scenario.scene == "ball2d"


def always(_outcome):
    return True


def test_runs_and_requirements_are_pickled_or_say_what_to_pickle(tmp_path):
    asked = plaus.Requirement(always, name="always", most=None)
    copy = pickle.loads(pickle.dumps(asked))
    assert (copy.function, copy.name, copy.most) == (always, "always", None)
    kept = plaus.sample(plaus.Scenario.default("ball2d"), solutions=1, out=tmp_path / "run")
    copy = pickle.loads(pickle.dumps(kept))
    assert copy.path == kept.path and copy.manifest == kept.manifest
    with pytest.raises(TypeError, match="pickle the run"):
        pickle.dumps(kept.replay(0))
    with pytest.raises(TypeError, match="a folder by `out`"):
        pickle.dumps(plaus.sample(plaus.Scenario.default("ball2d"), solutions=1))


def test_a_piece_has_the_chains_that_it_has_in_the_whole(tmp_path):
    how = ["--chains", "4", "--iterations", "500", "--warmup", "100", "--quiet"]
    path = SCENARIOS / "ball2d.toml"
    for shard in ["1/2", "2/2"]:
        command = [*COMMAND, "sample", path, *how, "--shard", shard, "--out", tmp_path / "pieces" / shard[0]]
        assert subprocess.run(command, check=False, capture_output=True).returncode in (0, 1)
    piece = plaus.Run(tmp_path / "pieces" / "2")
    assert piece.chains == 2 and sorted(set(piece.draws["chain"])) == [2, 3]
    whole = plaus.sample(path, chains=4, iterations=500, warmup=100, out=tmp_path / "whole", progress=False)
    assert np.array_equal(piece.draws["rest_x"], whole.draws["rest_x"][1000:])
    subprocess.run([*COMMAND, "merge", tmp_path / "pieces", "--out", tmp_path / "merged"], check=True)
    same_bytes(tmp_path / "whole", tmp_path / "merged")
    pytest.importorskip("xarray")
    assert list(piece.to_datatree()["posterior"]["chain"].values) == [2, 3]


def test_a_job_is_not_submitted_to_python(tmp_path):
    words = ["submit", str(SCENARIOS / "ball2d.toml"), "--to", "local", "--shards", "2", "--out", str(tmp_path / "job")]
    command = [pathlib.Path(sys.executable).with_name("plaus"), *words]
    made = subprocess.run(command, check=False, capture_output=True, text=True)
    assert made.returncode == 2 and "--program" in made.stderr, made.stderr
    named = subprocess.run([*command, "--program", command[0]], check=False, capture_output=True, text=True)
    assert named.returncode == 0, named.stderr


def test_a_temporary_run_goes_with_its_object():
    made = short(iterations=50)
    path = made.path
    assert os.path.isdir(path)
    del made
    assert not os.path.exists(os.path.dirname(path))


def test_a_run_of_another_version_says_so(tmp_path):
    made = short(iterations=50).save(tmp_path / "run")
    manifest = pathlib.Path(made.path) / "manifest.json"
    manifest.write_text(manifest.read_text().replace('"plaus": "', '"plaus": "9'))
    with pytest.raises(plaus.RunError, match="checksum"):
        plaus.Run(made.path)
    manifest.write_text('{"format": 99}')
    with pytest.raises(plaus.RunError, match="format 99"):
        plaus.Run(made.path)
    with pytest.raises(FileNotFoundError, match="there is no such run"):
        plaus.Run(tmp_path / "nothing")
    with pytest.raises(plaus.RunError, match="already exists"):
        short(out=tmp_path / "run")


@pytest.mark.parametrize(
    ("how", "error"),
    [
        ({"chains": 0}, ValueError),
        ({"chains": 2.5}, TypeError),
        ({"seed": -1}, ValueError),
        ({"solutions": True}, TypeError),
        ({"max_time": 0}, ValueError),
        ({"max_time": math.nan}, ValueError),
        ({"callback": 3}, TypeError),
        ({"requirement": "all"}, TypeError),
        ({"set": ["sigma_d=-1"]}, plaus.ScenarioError),
        ({"threads": -1}, ValueError),
    ],
)
def test_arguments_that_make_no_run_are_refused(how, error):
    with pytest.raises(error):
        short(**how)


def test_wrong_scenarios_are_refused():
    with pytest.raises(TypeError, match="not a int"):
        plaus.sample(3)
    with pytest.raises(FileNotFoundError):
        plaus.sample("no/such/file.toml")


# --- while it runs


def test_a_callback_sees_how_far_it_is_and_stops_it():
    seen = []

    def stop(progress):
        seen.append(progress)
        return len(seen) < 3

    made = short(iterations=10_000_000, callback=stop)
    assert made.ending == "callback" and len(seen) == 3 and made.iterations > 0
    assert 0 < seen[-1].share < 1 and seen[-1].per_second > 0 and "iterations/s" in str(seen[-1])
    assert short(iterations=10_000_000, max_time=0.3).ending == "out_of_time"
    assert short(iterations=10_000_000, solutions=5).ending == "enough_solutions"


def test_what_a_callback_raises_is_raised():
    def broken(_):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        short(iterations=10_000_000, callback=broken)


def ctrl_c_once(is_far):
    """A callback that lets the process be interrupted shortly after the call, not during it."""
    sent = []

    def callback(progress):
        if not sent and is_far(progress):
            sent.append(threading.Timer(0.05, lambda: os.kill(os.getpid(), signal.SIGINT)))
            sent[0].start()

    return callback


def ctrl_c_once_there_are_draws():
    return ctrl_c_once(lambda progress: min(progress.iterations, default=0) > 3000)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of another kind")
def test_ctrl_c_gives_what_was_found():
    made = short(iterations=10_000_000, callback=ctrl_c_once_there_are_draws())
    assert made.ending == "interrupted" and made.draw_count > 0 and made.solutions
    assert made.resume(max_time=0.2, progress=False).ending == "out_of_time"


def test_python_goes_on_while_it_samples():
    beats = []
    stop = threading.Event()

    def beat():
        while not stop.is_set():
            beats.append(time.perf_counter())
            time.sleep(0.005)

    other = threading.Thread(target=beat)
    other.start()
    short(iterations=10_000_000, max_time=0.5)
    stop.set()
    other.join()
    # If the lock were not released, there would be only one beat or two.
    assert len(beats) > 10


def test_two_samplers_at_once(tmp_path):
    made = {}
    jobs = [threading.Thread(target=lambda seed=seed: made.update({seed: short(seed=seed)})) for seed in (1, 2)]
    [job.start() for job in jobs]
    [job.join() for job in jobs]
    assert np.array_equal(made[1].draws["rest_x"], short(seed=1).draws["rest_x"])
    assert not np.array_equal(made[1].draws["rest_x"], made[2].draws["rest_x"])
    # Into the same folder: one of them makes it, the other is refused.
    caught = []

    def into_one():
        try:
            short(out=tmp_path / "run", iterations=200_000)
        except plaus.RunError as error:
            caught.append(error)

    jobs = [threading.Thread(target=into_one) for _ in range(2)]
    [job.start() for job in jobs]
    [job.join() for job in jobs]
    assert len(caught) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_in_the_middle(run):
    child = []

    def fork(_):
        if child:
            return
        child.append(os.fork())
        if child == [0]:
            # The child has none of its parent's threads, and works nevertheless.
            ok = run.replay(1).satisfied and short(iterations=100).ending == "complete" and run.gallery(2).shown == 2
            os._exit(0 if ok else 1)

    made = short(iterations=10_000_000, max_time=2.0, callback=fork)
    assert os.waitstatus_to_exitcode(os.waitpid(child[0], 0)[1]) == 0
    assert made.ending == "out_of_time" and os.path.isdir(made.path) and os.path.isdir(run.path)


# --- chances

# A result that few balls reach, with little work.
RARE = ["collisions=1", "sigma_theta_deg=3", "target=4.2", "sigma_d=0.1", "tolerance=0.1", "downward=reject"]


def rare(**how):
    """A chance of a second or less."""
    little = {"batches": 4, "draws": 50, "particles": 20, "steps": 5, "rungs": 4, "iterations": 100}
    return plaus.chance(SCENARIOS / "ball2d.toml", **{"set": RARE, "progress": False, **little, **how})


def test_a_chance_is_what_the_command_says(tmp_path):
    made = rare(out=tmp_path / "a.json", threads=1)
    little = "--batches=4 --draws=50 --particles=20 --steps=5 --rungs=4 --iterations=100 --json".split()
    keys = [f"--set={key}" for key in RARE]
    words = ["chance", SCENARIOS / "ball2d.toml", *keys, *little, "--out", tmp_path / "b.json"]
    said = subprocess.run([*COMMAND, *words], check=False, capture_output=True, text=True)
    assert said.returncode in (0, 1), said.stderr
    assert json.loads(said.stdout) == made.facts
    assert filecmp.cmp(tmp_path / "a.json", tmp_path / "b.json", shallow=False)
    shown = subprocess.run([*COMMAND, "chance", tmp_path / "a.json"], check=False, capture_output=True, text=True)
    assert shown.stdout == str(made) and "splitting" in str(made)
    assert made.methods == ["counting", "splitting", "stones", "importance"] and made.batches == (16, 16)
    assert (made.ending, made.path) == ("complete", str(tmp_path / "a.json")) and made.seconds > 0
    again = plaus.Chance.open(tmp_path / "a.json")
    assert again.facts == made.facts and again.ending is None and again.scenario.scene == "ball2d"
    best = made.best
    assert best in made.estimates and made.probability == best.probability and made.error == best.error
    assert made.interval[0] <= best.interval[0] <= best.probability <= best.interval[1]
    assert made.settled == (not made.doubts) and all(one["kind"] for one in made.doubts)


def test_a_chance_is_that_of_plain_draws():
    made = plaus.chance(
        {"world": {"ball2d": {"collisions": 1, "target": 0.0, "tolerance": 0.5}}},
        set=["downward=reject"],
        methods="counting",
        batches=8,
        draws=4000,
        progress=False,
    )
    assert made.methods == ["counting"] and made.why == "as asked for"
    # The share of plain draws that `check` finds estimates the same probability, from other draws.
    plain = made.scenario.check(draws=20_000)
    assert set(plain) == {"states", "all", "clauses", "never_together", "failures", "ends"} and plain["states"] == 20_000
    p = plain["all"] / plain["states"]
    assert 0.05 < p < 0.95 and abs(made.probability - p) < 5 * math.hypot(made.error, math.sqrt(p * (1 - p) / 20_000))


def test_requirements_of_a_scenario_are_counted_one_by_one():
    require = "[[require]]\nimpact = { when = { at_s = 0.3, within_ms = 10 } }\n"
    text = f"[world.ball2d]\ntarget = 0\ntolerance = 0.5\n{require}"
    scenario = plaus.Scenario.from_text(text)
    found = scenario.check(draws=500)
    assert len(found["clauses"]) == 2 and all(0 <= clause["met"] <= 500 for clause in found["clauses"])
    assert found["all"] <= min(clause["met"] for clause in found["clauses"])
    made = plaus.chance(scenario, methods=["counting"], batches=2, draws=250, progress=False)
    assert [part.name for part in made.parts] == [clause["asked"] for clause in found["clauses"]]
    assert all(part.probability >= made.probability for part in made.parts)
    for wrong, error in [(0, ValueError), (-1, OverflowError), (1.5, TypeError)]:
        with pytest.raises(error):
            scenario.check(draws=wrong)


def test_a_chance_that_was_cut_short_goes_on(tmp_path):
    seen = []
    how = {"batches": 40, "iterations": 10_000, "progress": False}
    enough = lambda far: seen.append(far) or far.batches < 3
    cut = rare(out=tmp_path / "cut.json", callback=enough, threads=1, **how)
    assert cut.ending == "callback" and 3 <= cut.batches[0] < 160, cut
    assert seen[-1].batches >= 3 and seen[-1].batches_planned == 160 and "simulations/s" in str(seen[-1])
    late = rare(out=tmp_path / "cut.json", max_time=1e-9, **how)
    assert late.ending == "out_of_time" and late.batches[0] >= cut.batches[0]
    done = rare(out=tmp_path / "cut.json", **how)
    rare(out=tmp_path / "whole.json", **how)
    assert done.ending == "complete" and filecmp.cmp(tmp_path / "cut.json", tmp_path / "whole.json", shallow=False)
    nothing = rare(draws=10**9, max_time=0.01)
    assert nothing.best is None and math.isnan(nothing.probability) and nothing.interval == (0.0, 1.0), nothing


@pytest.mark.skipif(sys.platform == "win32", reason="signals of another kind")
def test_ctrl_c_gives_what_batches_say(tmp_path):
    made = rare(batches=100_000, out=tmp_path / "a.json", callback=ctrl_c_once(lambda far: far.batches > 2))
    assert made.ending == "interrupted" and 2 < made.batches[0] < 100_000
    assert plaus.Chance.open(tmp_path / "a.json").batches == made.batches
    with pytest.raises(KeyboardInterrupt):
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        plaus.Scenario.default("bowling").check(draws=10**9)


def test_chances_that_cannot_be_asked_are_refused(tmp_path):
    for how, error in [
        ({"batches": 1}, ValueError),
        ({"particles": 10**9}, ValueError),
        ({"rungs": 1.5}, TypeError),
        ({"draws": 0}, ValueError),
        ({"seed": -1}, ValueError),
        ({"methods": ["luck"]}, ValueError),
        ({"methods": [1]}, TypeError),
        ({"max_time": math.nan}, ValueError),
        ({"callback": 3}, TypeError),
        ({"set": "traget=1"}, plaus.ScenarioError),
        ({"set": [*RARE, "preset=as-printed"], "methods": ["stones"]}, plaus.RunError),
    ]:
        with pytest.raises(error):
            rare(**how)
    rare(out=tmp_path / "a.json", methods=["counting"])
    before = (tmp_path / "a.json").read_bytes()
    for other in ({"seed": 8}, {"methods": ["splitting"]}, {"draws": 60}):
        with pytest.raises(plaus.RunError, match="a.json: holds another run"):
            rare(**{"out": tmp_path / "a.json", "methods": ["counting"], **other})
    assert (tmp_path / "a.json").read_bytes() == before
    (tmp_path / "a.json").write_bytes(before.replace(b'"hits"', b'"hitz"'))
    with pytest.raises(plaus.RunError, match="not an estimate of a chance"):
        plaus.Chance.open(tmp_path / "a.json")
    with pytest.raises(FileNotFoundError):
        plaus.Chance.open(tmp_path / "none.json")

    def wrong(far):
        raise ValueError("of the callback")

    with pytest.raises(ValueError, match="of the callback"):
        rare(callback=wrong, batches=1000)


# --- requirements


def slow_end(outcome):
    """The ball should come to rest slightly farther to the right than the scenario asks for."""
    x = outcome["rest_x"]
    return -0.5 * ((x - 1.05) / 0.02) ** 2, abs(x - 1.05) < 0.05


def test_a_requirement_is_asked_by_the_chain(tmp_path):
    required = plaus.Requirement(slow_end)
    with_it = short(requirement=required, out=tmp_path / "a", threads=2)
    without = short()
    mean = lambda made: made.draws["rest_x"].mean()
    # The factor's own width is 0.02; the scenario's is 0.1, around 1.
    assert abs(mean(with_it) - 1.05) < 0.02 and abs(mean(without) - 1.05) > 0.03
    satisfied = with_it.draws["satisfied"]
    assert (np.abs(with_it.draws["rest_x"][satisfied] - 1.05) < 0.05).all() and satisfied.any()
    assert required.cost.calls > 0 and required.cost.seconds > 0
    assert with_it.manifest["requirement"] == "slow_end" and with_it.replay(0).satisfied
    # The same bytes, whatever the number of threads, and also if the run is continued.
    short(requirement=slow_end, out=tmp_path / "b", threads=1)
    same_bytes(tmp_path / "a", tmp_path / "b")
    part = short(requirement=slow_end, out=tmp_path / "c", iterations=700)
    with pytest.raises(plaus.RunError, match="slow_end"):
        plaus.resume(part.path, iterations=2000, progress=False)
    gone_on = part.resume(iterations=2000, progress=False)
    assert np.array_equal(gone_on.draws["rest_x"], with_it.draws["rest_x"])

    def other(outcome):
        return slow_end(outcome)[0] - 1.0, True

    with pytest.raises(plaus.RunError, match="does the requirement answer as before"):
        plaus.resume(part.path, iterations=3000, requirement=plaus.Requirement(other, name="slow_end"), progress=False)


def test_a_requirement_has_the_law_it_should_have():
    # The factor exp(-x²/2s²) in addition to the scenario's own. The reference is the scenario with weights.
    made = short(requirement=slow_end, iterations=20_000)
    plain = short(iterations=20_000)
    x = plain.draws["rest_x"]
    weights = np.exp(-0.5 * ((x - 1.05) / 0.02) ** 2)
    expected = (weights * x).sum() / weights.sum()
    ours = made.diagnose()
    row = next(row for row in ours["scalars"] if row["name"] == "rest_x")
    # Standard error of the weighted mean, with the effective sample size of the plain chain divided among the
    # weights.
    plain_row = next(row for row in plain.diagnose()["scalars"] if row["name"] == "rest_x")
    share = plain_row["summary"]["ess_bulk"] / len(x)
    size = share * weights.sum() ** 2 / (weights**2).sum()
    spread = math.sqrt((weights * (x - expected) ** 2).sum() / weights.sum())
    error = math.hypot(spread / math.sqrt(size), row["summary"]["mcse_mean"])
    assert abs(made.draws["rest_x"].mean() - expected) < 5 * error


def test_a_requirement_sees_motion_and_impacts():
    seen = []

    def look(outcome):
        if not seen:
            seen.append((outcome.bodies, outcome.rest, outcome.motion.events["t"], outcome.scalars, repr(outcome)))
        return True

    made = short(requirement=look, iterations=50)
    bodies, rest, times, scalars, text = seen[0]
    assert bodies == ["ball_0"] == list(rest) and len(rest["ball_0"]) == 3
    assert len(times) >= 3 and (np.diff(times) >= 0).all() and "rest_x" in scalars and "rest_x=" in text
    assert np.array_equal(made.draws["rest_x"], short(iterations=50).draws["rest_x"])


def test_the_traceback_of_a_requirement_is_the_users():
    calls = []

    def brittle(outcome):
        calls.append(outcome)
        if len(calls) > 40:
            return {}["missing"]
        return 0.0, True

    with pytest.raises(KeyError, match="missing") as caught:
        short(requirement=brittle, threads=1)
    error = caught.value
    assert "brittle" in "".join(traceback.format_exception(error))
    assert any("iteration" in note and "chain" in note for note in error.__notes__)
    assert error.plaus_iteration >= 0 and isinstance(error.plaus_chain, int)
    # Called again with the same argument, it fails again.
    with pytest.raises(KeyError, match="missing"):
        brittle(error.plaus_given)


@pytest.mark.parametrize(
    ("answer", "error"),
    [
        (None, TypeError),
        (1.0, TypeError),
        ((1.0,), TypeError),
        (("high", True), TypeError),
        ((math.nan, True), ValueError),
        ((math.inf, True), ValueError),
        ((0.5, True), plaus.RunError),
    ],
)
def test_answers_that_are_none_are_refused(answer, error):
    with pytest.raises(error, match="answered|exceeds"):
        short(requirement=lambda _: answer)


def test_an_impossible_requirement_says_so():
    with pytest.raises(plaus.RunError, match="none of 10000 start draws"):
        short(requirement=lambda _: False, chains=1)


# --- requirements in processes of their own


def looks_at_motion(outcome):
    """A requirement that needs numbers, poses at rest and impacts."""
    log, met = slow_end(outcome)
    assert outcome.rest["ball_0"] == outcome.motion.poses(times=[outcome.motion.duration])[1][0, 0].tolist()
    return log, met and len(outcome.motion.events["t"]) >= 3


def test_a_requirement_in_processes_has_the_same_bytes(tmp_path):
    seen = []

    def remembers(outcome):
        seen.append(outcome)
        return looks_at_motion(outcome)

    required = plaus.Requirement(remembers, name="it", processes=2)
    short(requirement=required, out=tmp_path / "a", iterations=500)
    assert not seen, "it was called in this process"
    assert required.cost.calls > 0 < required.cost.seconds
    short(requirement=plaus.Requirement(looks_at_motion, name="it"), out=tmp_path / "b", iterations=500)
    same_bytes(tmp_path / "a", tmp_path / "b")
    made = plaus.Run(tmp_path / "a").resume(requirement=required, iterations=800, progress=False)
    assert made.draw_count == 800


def test_dice_reach_other_processes_with_their_tables():
    def judge(outcome):
        return -abs(outcome["rest_x_1"]) / 50.0 - outcome.motion.duration, True

    one, two = (
        plaus.sample(
            SCENARIOS / "dice-one.toml",
            requirement=plaus.Requirement(judge, processes=processes),
            iterations=100,
            warmup=20,
            progress=False,
        )
        for processes in (0, 2)
    )
    assert all(np.array_equal(one.draws[name], two.draws[name]) for name in one.draws)


def test_two_samplers_with_one_requirement_in_processes(tmp_path):
    required = plaus.Requirement(slow_end, processes=1)
    work = lambda seed: short(requirement=required, seed=seed, iterations=300, out=tmp_path / str(seed))
    jobs = [threading.Thread(target=work, args=(seed,)) for seed in (1, 2)]
    [job.start() for job in jobs]
    [job.join() for job in jobs]
    short(requirement=slow_end, seed=2, iterations=300, out=tmp_path / "alone")
    same_bytes(tmp_path / "2", tmp_path / "alone")


def test_what_a_requirement_raises_in_another_process_is_raised_here():
    class Odd(Exception):
        """Cannot be pickled: its constructor needs the outcome."""

        def __init__(self, outcome, text):
            super().__init__(text)

    for raises, kind in [(lambda outcome: {}["missing"], KeyError), (lambda outcome: 1 / 0, ZeroDivisionError)]:
        with pytest.raises(kind) as caught:
            short(requirement=plaus.Requirement(raises, processes=2))
        text = "".join(traceback.format_exception(caught.value))
        assert "test_plaus.py" in text and "in <lambda>" in text and "iteration" in caught.value.__notes__[0]
        with pytest.raises(kind):
            raises(caught.value.plaus_given)

    def odd(outcome):
        raise Odd(outcome, "by heart")

    with pytest.raises(plaus.RunError, match="Odd: by heart"):
        short(requirement=plaus.Requirement(odd, processes=1))
    with pytest.raises(plaus.RunError, match="has ended: exit code 3"):
        short(requirement=plaus.Requirement(lambda outcome: os._exit(3), processes=1))
    with pytest.raises(TypeError, match="expected"):
        short(requirement=plaus.Requirement(lambda outcome: "yes", processes=1))
    for wrong, error in [(-1, ValueError), (1.5, TypeError), (True, TypeError)]:
        with pytest.raises(error, match="processes"):
            plaus.Requirement(slow_end, processes=wrong)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of another kind")
def test_ctrl_c_with_processes_gives_what_was_found_and_leaves_none_behind():
    import multiprocessing

    required = plaus.Requirement(slow_end, processes=2)
    made = short(requirement=required, iterations=10_000_000, callback=ctrl_c_once_there_are_draws())
    assert made.ending == "interrupted" and made.draw_count > 0
    assert not multiprocessing.active_children()


# --- targets


def normal_target(**more):
    return plaus.Target(
        lambda rng: [rng.normal(), rng.normal()],
        lambda x: -0.5 * float(x @ x),
        lambda x: -0.5 * (x[0] - 2.0) ** 2,
        **more,
    )


def test_a_target_in_python_is_sampled():
    made = plaus.sample_target(normal_target(met=lambda x: bool(x[0] > 1.0)), [plaus.Move.walk(1.0)], iterations=4000)
    # The product of two normals: mean 1, variance 1/2. 16,000 draws of a walk are worth at least 1,000 independent
    # ones.
    assert abs(made.x[..., 0].mean() - 1.0) < 5 * math.sqrt(0.5 / 1000)
    assert abs(made.x[..., 1].mean()) < 5 / math.sqrt(1000)
    assert np.array_equal(made.satisfied, made.x[..., 0] > 1.0) and 0.1 < made.acceptance["walk"] < 0.9
    again = plaus.sample_target(normal_target(), [plaus.Move.walk(1.0)], iterations=4000)
    assert np.array_equal(again.x, made.x)


def test_moves_are_checked_and_wrong_ones_are_caught():
    right = plaus.Move(
        lambda x, rng: [x[0] * math.exp(rng.normal(0, 0.3)), x[1]],
        lambda x, y: math.log(abs(y[0] / x[0])),
        name="scale",
    )
    wrong = plaus.Move(lambda x, rng: [x[0] * math.exp(rng.normal(0, 0.3)), x[1]], name="scale")
    assert plaus.check_moves(
        normal_target(), [plaus.Move.walk(0.5), plaus.Move.redraw(), right], bound=0.0, samples=4000
    )
    report = plaus.check_moves(normal_target(), [wrong])
    assert not report and report.p < 1e-6 and "FAILED" in str(report)


def test_what_functions_of_a_target_raise_is_the_users():
    def start(_):
        raise OSError("no start")

    with pytest.raises(OSError, match="no start"):
        plaus.sample_target(plaus.Target(start, lambda x: 0.0), [plaus.Move.redraw()])
    for wrong, error in [
        (lambda x: "high", TypeError),
        (lambda x: math.nan, plaus.RunError),
        (lambda x: 1 / 0, ZeroDivisionError),
    ]:
        with pytest.raises(error):
            plaus.sample_target(plaus.Target(lambda rng: 0.0, wrong), [plaus.Move.redraw()])
    with pytest.raises(TypeError, match="a point of 2"):
        plaus.sample_target(normal_target(), [plaus.Move(lambda x, rng: [1.0])])
    with pytest.raises(ValueError, match="no move has a positive weight"):
        plaus.sample_target(normal_target(), [])


# --- the simulator


def test_a_ball_falls_bounces_and_rests():
    world = sim.World()
    world.law(friction=0.3, restitution=0.5)
    world.plane((0, 0, 0), (0, 0, 1))
    world.ball(0.1)
    drops = world.run([[[0, 0, 1.1]], [[0, 0, 2.1]]], times=[0.0, 0.2, 5.0], events=True)
    assert (drops.ending == 0).all() and np.allclose(drops.position[:, 0, 2], 0.1, atol=1e-9)
    assert np.allclose(drops.positions[:, 1, 0, 2], [1.1, 2.1] - 0.5 * 9.81 * np.array(0.2**2))
    first = [drops.events["t"][drops.events["start"] == start][0] for start in (0, 1)]
    assert np.allclose(first, np.sqrt(2 * np.array([1.0, 2.0]) / 9.81), atol=1e-12)
    assert (drops.events["other"] == -1).all() and len(drops) == 2


def test_bodies_of_every_kind_come_to_rest():
    world = sim.World(duration=30)
    world.law(friction=0.4, restitution=0.3)
    world.law("felt", friction=0.8, restitution=0.1)
    world.table(np.zeros((3, 3)), 0.1)
    world.block((-1, -1, -0.2), (1, 1, -0.1))
    numbers = [
        world.ball(0.01, density=2500),
        world.cuboid((0.02, 0.03, 0.04), rounding=0.001, mass=0.01),
        world.hull(np.vstack([np.eye(3), -np.eye(3)]) * 0.02, material="felt"),
    ]
    assert numbers == [0, 1, 2] and world.bodies == 3
    places = np.array([[[0, 0, 0.05], [0.2, 0, 0.05], [-0.2, 0, 0.05]]])
    made = world.run(places, spin=np.random.default_rng(1).normal(0, 3, places.shape))
    assert made.ending[0] in (0, 1) and (made.position[0, :, 2] > 0).all()
    assert np.allclose(np.linalg.norm(made.orientation, axis=2), 1.0)


def test_bits_do_not_depend_on_threads():
    world = sim.World.dice()
    rng = np.random.default_rng(2)
    starts = dict(position=np.tile([0, 0, 0.1], (40, 1, 1)), spin=rng.normal(0, 20, (40, 1, 3)))
    one, two = (world.run(**starts, threads=threads) for threads in (1, 3))
    for name in ("position", "orientation", "time", "impacts"):
        assert np.array_equal(getattr(one, name), getattr(two, name)), name


def test_worlds_of_scenarios():
    for name, bodies in [("dice-six", 6), ("bowling-strike", 11), ("spelling-hi", 10)]:
        world = sim.World.from_scenario(plaus.Scenario.from_file(SCENARIOS / f"{name}.toml"))
        assert world.bodies == bodies and world.places.shape == (bodies, 3)
        assert world.run(world.places[None]).ending[0] in (0, 1)
    with pytest.raises(ValueError, match="closed form"):
        sim.World.from_scenario(plaus.Scenario.default("ball2d"))


def test_starts_that_cannot_be_are_refused():
    world = sim.World.dice()
    with pytest.raises(plaus.WorldError, match="start 1"):
        world.run([[[0, 0, 0.1]], [[0, 0, 0.0]]])
    with pytest.raises(plaus.WorldError, match="start 0"):
        world.run([[[0, math.nan, 0.1]]])
    with pytest.raises(ValueError, match="shape"):
        world.run([[0, 0, 0.1]])
    with pytest.raises(ValueError, match="velocity"):
        world.run([[[0, 0, 0.1]]], velocity=[[[0, 0, 1], [0, 0, 1]]])
    with pytest.raises(TypeError, match="position"):
        world.run([["a", "b", "c"]])
    with pytest.raises(ValueError, match="not a time"):
        world.run([[[0, 0, 0.1]]], times=[math.nan])
    with pytest.raises(ValueError, match="has no bodies"):
        sim.World().run([[[0, 0, 0]]])
    with pytest.raises(ValueError, match="there is no law"):
        lawless = sim.World()
        lawless.ball(1.0)
        lawless.run([[[0, 0, 0]]])
    with pytest.raises(plaus.WorldError):
        bad = sim.World()
        bad.law(friction=-1, restitution=0.5)
        bad.ball(1.0)
        bad.run([[[0, 0, 0]]])


@pytest.mark.skipif(
    not pathlib.Path("/proc/sys/vm/overcommit_memory").exists()
    or pathlib.Path("/proc/sys/vm/overcommit_memory").read_text().strip() != "0",
    reason="only where the system says that there is no such memory",
)
def test_memory_that_runs_out_is_an_exception():
    # 4e11 poses: ten terabytes.
    with pytest.raises(MemoryError, match="no memory"):
        sim.World.dice().run(np.tile([0, 0, 0.1], (200_000, 1, 1)), times=np.zeros(2_000_000))


# Runs in a process of its own: the remaining address space is limited, then filled from inside a chain.
OUT_OF_MEMORY = '''
import pathlib, resource, sys
import plaus

def held():
    return int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()

def bounded(more):
    resource.setrlimit(resource.RLIMIT_AS, (held() + more, resource.RLIM_INFINITY))

def raises(call, text):
    try:
        call()
    except MemoryError as error:
        assert text in str(error), error
    else:
        raise AssertionError("no exception")

little = {"threads": 1, "progress": False}
hoard = []

def greedy(outcome):
    hoard.append(bytearray(1 << 24))
    return True

asked = plaus.Requirement(greedy)
plaus.sample(sys.argv[1], iterations=10, **little)
bounded(1 << 28)
raises(lambda: plaus.sample(sys.argv[1], requirement=asked, **little), "")
assert len(hoard) > 4
hoard.clear()
target = plaus.Target(lambda rng: [0.0] * 2000, lambda x: 0.0)
raises(lambda: plaus.sample_target(target, [plaus.Move.walk(1.0)], iterations=10**12, warmup=0), "no memory")
print("alive", plaus.Scenario.from_file(sys.argv[1]).scene)
'''


@pytest.mark.skipif(sys.platform != "linux", reason="where the address space can be bounded")
def test_memory_that_runs_out_inside_a_chain_is_an_exception():
    call = [sys.executable, "-c", OUT_OF_MEMORY, SCENARIOS / "ball2d.toml"]
    done = subprocess.run(call, check=False, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout == "alive ball2d\n", done.stderr


# --- the package


def test_the_command_comes_with_it():
    command = pathlib.Path(sys.executable).with_name("plaus")
    said = subprocess.run([command, "--version"], check=True, capture_output=True, text=True).stdout
    assert said == f"plaus {plaus.__version__}\n"
    assert subprocess.run([command, "diagnose", "no/such/run"], check=False, capture_output=True).returncode == 2
    module = [sys.executable, "-m", "plaus", "explain", "sigma_d"]
    assert "sigma_d" in subprocess.run(module, check=True, capture_output=True, text=True).stdout


def test_licences_and_types_are_in_the_wheel():
    import importlib.metadata

    names = [str(path) for path in importlib.metadata.files("plaus")]
    for wanted in ("py.typed", "_plaus.pyi", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"):
        assert any(name.endswith(wanted) for name in names), (wanted, names)


def test_every_name_is_documented_and_typed():
    import inspect

    for name in plaus.__all__:
        thing = getattr(plaus, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
            for key, member in vars(thing).items():
                if not key.startswith("_") and callable(member):
                    assert inspect.getdoc(member), f"{name}.{key}"


CUBE = np.array([(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = [face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))]


def test_meshes_are_recognized():
    turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    found = plaus.recognize(CUBE * (1, 2, 3) @ turn.T + (5, 0, 0), FACES)
    assert found.kind == "box" and np.allclose(sorted(found.size), (1, 2, 3))
    assert np.allclose(found.center, turn @ (0.5, 1.0, 1.5) + (5, 0, 0))
    assert found.deviation < 1e-12 and found.gap < 1e-12
    # Its edges are along the columns of its rotation, which says how it lies, whatever their order.
    assert np.allclose(found.rotation @ np.diag(found.size) ** 2 @ found.rotation.T, turn @ np.diag([1, 4, 9]) @ turn.T)
    dented = CUBE.copy()
    dented[-1] -= 0.02
    assert plaus.recognize(dented, FACES) is None
    assert plaus.recognize(dented, FACES, tolerance=0.05).kind == "box"
    for vertices, triangles, told in [
        (CUBE[:, :2], FACES, "three numbers in each row"),
        (CUBE, [(0, 1, 8)], "8 is not the index of one of 8 vertices"),
        (CUBE, [(0, 1, -1)], "-1 is not the index"),
        (CUBE * np.nan, FACES, "not finite"),
        (CUBE, CUBE[0], "2 dimensions"),
    ]:
        with pytest.raises(ValueError, match=told):
            plaus.recognize(vertices, triangles)
    with pytest.raises(ValueError, match="tolerance"):
        plaus.recognize(CUBE, FACES, tolerance=-1.0)


@pytest.mark.parametrize("turned", [1, -1], ids=["outwards", "inwards"])
def test_a_hollow_mesh_is_cut_into_convex_pieces(turned):
    # An L, drawn out along z.
    outline = np.array([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], dtype=float)
    corners = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in outline])
    ends = [(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 5, 4)]
    sides = [face for n in range(6) for m in [(n + 1) % 6] for face in ((n, m, m + 6), (n, m + 6, n + 6))]
    faces = np.array([*ends, *(tuple(6 + np.array(face[::-1])) for face in ends), *sides])[:, ::turned]
    found = plaus.convex_pieces(corners, faces)
    assert len(found.corners) > 1
    every = np.concatenate(found.corners)
    assert np.allclose(every.min(axis=0), corners.min(axis=0)) and np.allclose(every.max(axis=0), corners.max(axis=0))
    # Its voxels are 1/64 of its largest extent.
    assert found.deviation < 3 * 3 / 64 and found.lack < 3 / 64
    # Beyond the inner corner there is nothing but what stands out.
    assert (np.minimum(*(every[:, :2] - 1).T) <= found.deviation + 1e-9).all()
    assert plaus.convex_pieces(CUBE, FACES) is None, "what is convex is not cut"
