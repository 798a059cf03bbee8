#!/usr/bin/env python3
"""Runs pieces of plaus on real engines, with accidents, and compares the merged run with that of one machine, byte for
byte.

    check_engines.py --plaus PLAUS --venv FOLDER --work FOLDER [--quick] [--speed SECONDS] ENGINE...

Engines: hyperqueue and openjd, from PyPI into a virtual environment of the check's own; slurm, if its programs are
installed. On each, a piece is killed in the middle, another finds its disk full, and the engine itself is killed; then
the job is submitted again. A copy of the pieces is refused with one missing, one there twice, and one of another
scenario.
Exit codes: 0 right, 1 wrong, 77 the packages could not be installed.
"""

import argparse
import json
import os
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import time
import tomllib
from pathlib import Path

from environment import environment

REQUIREMENTS = ["hyperqueue==0.27.0", "openjd-cli==0.8.0"]
# Names with characters that are special in shells, TOML, JSON and templates.
JOB = "it's a \"job\" $HOME {x} %j {{Param.Piece0}}"
FILE = "ball's \"2d\".toml"
PIECES = 4
# No step takes minutes unless it hangs.
PATIENCE = 600


class Wrong(Exception):
    """Something is wrong."""


def demand(condition, what):
    if not condition:
        raise Wrong(what)


def wait_for(what, condition, seconds=PATIENCE):
    end = time.monotonic() + seconds
    while not condition():
        demand(time.monotonic() < end, f"{what}: not within {seconds} s")
        time.sleep(0.02)


# Stands in for plaus: one piece is killed in the middle, one finds its disk full; each once.
ACCIDENTS = """#!/bin/sh
case "$*" in *--shard=task/*) piece="${SLURM_ARRAY_TASK_ID}" ;; *) piece=${*#*--shard=}; piece=${piece%%/*} ;; esac
folder=$(dirname -- "$0")
case "$1" in sample) room=200 ;; chance) room=4 ;; *) exec "$PLAUS" "$@" ;; esac
if [ "$piece" = 2 ] && mkdir -- "$folder/full" 2>/dev/null; then
    trap '' XFSZ
    ulimit -f "$room"
elif [ "$piece" = 3 ] && mkdir -- "$folder/killed" 2>/dev/null; then
    "$PLAUS" "$@" &
    plaus=$!
    sleep 0.7
    kill -KILL "$plaus"
    wait "$plaus"
    exit 137
fi
exec "$PLAUS" "$@"
"""


class Job:
    """A job in a folder of its own, with the whole run to compare with."""

    # The message of a piece whose disk is full.
    FULL = "The run is safe up to iteration"
    CALLED = ""

    def __init__(self, arguments, engine):
        self.engine, self.plaus = engine, str(arguments.plaus.resolve())
        self.place = arguments.work.resolve() / f"{engine}{self.CALLED}"
        shutil.rmtree(self.place, ignore_errors=True)
        self.place.mkdir(parents=True)
        self.path = self.place / JOB
        # Whether any piece has reported that its disk is full.
        self.named = False
        scenario = self.place / FILE
        shutil.copy(arguments.scenario, scenario)
        # Installed where all machines can see it, under a name that needs quoting.
        accidents = self.place / "plaus with 'accidents'.sh"
        accidents.write_text(ACCIDENTS.replace("$PLAUS", self.plaus))
        accidents.chmod(0o755)
        self.begin(scenario, ["--to", engine, "--shards", PIECES, "--program", accidents], arguments.quick)

    def begin(self, scenario, to, quick):
        """Makes the whole run, and writes the job."""
        # Each piece takes a few seconds, and its records a few megabytes.
        length = 600_000 if quick else 3_000_000
        self.run = ["--chains", "6", "--set", "rungs=2", "--iterations", str(length), "--thin", "20", "--seed", "3"]
        self.call("sample", scenario, "--out", self.place / "whole", "--quiet", *self.run)
        self.call("submit", scenario, *to, "--out", self.path, *self.run)

    def is_done(self):
        return (self.path / "run").exists()

    def call(self, *words, code=0):
        words = [self.plaus, *map(str, words)]
        done = subprocess.run(words, capture_output=True, text=True, cwd=self.place)
        demand(done.returncode in (code if isinstance(code, tuple) else (code,)), f"{words}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def status(self):
        done = subprocess.run([self.plaus, "status", "--json", str(self.path)], capture_output=True, text=True)
        status = json.loads(done.stdout)
        failed = [piece["why"] for piece in status["pieces"] if piece["standing"] == "failed"]
        self.named = self.named or any(self.FULL in (why or "") for why in failed)
        return status

    def standings(self):
        return self.status()["summary"]["standings"]

    def write_again(self):
        self.status()
        self.call("submit", "--again", self.path)

    def at_work(self):
        """Whether any piece has done a part of its iterations."""
        signals = [piece["signal"] for piece in self.status()["pieces"]]
        return any(signal and 0 < signal["iteration"] < signal["end"] for signal in signals)

    def has_named_a_full_disk(self):
        self.status()
        return self.named

    def is_the_whole(self):
        whole, merged = self.place / "whole", self.path / "run"
        names = sorted(path.name for path in whole.iterdir())
        demand(names == sorted(path.name for path in merged.iterdir()), f"{merged}: not the files of {whole}")
        for name in names:
            same = (whole / name).read_bytes() == (merged / name).read_bytes()
            demand(same, f"{merged / name}: not the bytes of {whole / name}")
        return len(names)

    def had_accidents(self):
        demand((self.place / "full").exists() and (self.place / "killed").exists(), "no accident happened")
        demand(self.named, "no full disk was named")

    def refuses(self):
        """Checks that a merge refuses pieces that make no whole, says why, and leaves nothing behind."""
        pieces, out = self.path / "pieces", self.place / "refused"
        merge = ["merge", pieces, "--out", out]
        aside = self.place / "aside"
        (pieces / "2").rename(aside)
        demand("piece 2/4 is missing" in self.call(*merge, code=2), "a missing piece is not named")
        other = ["--shard", "2/4", "--out", pieces / "2", "--quiet", "--set", "sigma_d=0.3"]
        self.call("sample", self.place / FILE, *self.run, *other, "--max-time", "0s", code=1)
        said = self.call(*merge, code=2)
        demand("does not belong to the same run" in said and "pieces/2" in said, f"another scenario is not named: {said}")
        shutil.rmtree(pieces / "2")
        aside.rename(pieces / "2")
        shutil.copytree(pieces / "2", pieces / "twice")
        said = self.call(*merge, code=2)
        demand("pieces/twice: is piece 2/4" in said, f"a piece that is there twice is not named: {said}")
        shutil.rmtree(pieces / "twice")
        demand(not out.exists(), "a refused merge left something")


class ChanceJob(Job):
    """The same for a chance: a piece is a number of batches, in one file."""

    FULL = "File too large"
    CALLED = "-chance"

    def begin(self, scenario, to, quick):
        # Each piece takes a few seconds, and each of its batches some tenths of a second.
        work = ["--particles", "200", "--steps", "100"] if quick else ["--particles", "400", "--steps", "200"]
        self.run = ["--set", "tolerance=0.02", "--batches", "16", "--seed", "3", *work, "--iterations", "4000"]
        # Exit code 1 if methods disagree; only the bytes matter here.
        self.call("chance", scenario, "--out", self.place / "whole.json", "--quiet", *self.run, code=(0, 1))
        self.call("submit", "--chance", scenario, *to, "--out", self.path, *self.run)

    def is_done(self):
        return (self.path / "chance.json").exists()

    def at_work(self):
        batches = [piece.get("batches") for piece in self.status()["pieces"]]
        return any(of and 0 < of[0] < of[1] for of in batches)

    def is_the_whole(self):
        whole, merged = self.place / "whole.json", self.path / "chance.json"
        demand(whole.read_bytes() == merged.read_bytes(), f"{merged}: not the bytes of {whole}")
        return 1

    def refuses(self):
        pieces, out = self.path / "pieces", self.place / "refused.json"
        merge, two, aside = ["merge", pieces, "--out", out], pieces / "2.json", self.place / "aside.json"
        two.rename(aside)
        demand("piece 2/4 is missing" in self.call(*merge, code=2), "a missing piece is not named")
        other = ["--method", "counting", "--batches", "16", "--seed", "4", "--quiet"]
        self.call("chance", self.place / FILE, "--shard", "2/4", "--out", two, *other)
        said = self.call(*merge, code=2)
        demand("does not belong to the other pieces" in said and "2.json" in said, f"another scenario is not named: {said}")
        shutil.copy(aside, two)
        shutil.copy(aside, pieces / "twice.json")
        said = self.call(*merge, code=2)
        demand("twice.json: is piece 2/4" in said, f"a piece that is there twice is not named: {said}")
        (pieces / "twice.json").unlink()
        demand(not out.exists(), "a refused merge left something")


# Lines that our part of a server prints begin with this; HyperQueue prints lines of its own.
SAID = "plaus: "


def start_server(words, folder):
    """Our part of a server; its progress bars go to a file."""
    log = open(folder / "server.txt", "a")
    return subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True, cwd=folder)


def answer(server):
    """The next line that a server prints; empty if the server has ended."""
    for line in server.stdout:
        if line.startswith(SAID):
            return line.removeprefix(SAID).strip()
    return ""


def check_hyperqueue(job, python):
    """A server with two workers on the loopback interface, killed in the middle with all its tasks."""

    def serve():
        script = [str(python), __file__, "--serve", str(job.place / "server")]
        shutil.rmtree(job.place / "server", ignore_errors=True)
        server = start_server(script, job.place)
        demand(answer(server) == "ready", "HyperQueue does not start")
        return server

    def submit(server):
        job.write_again()
        server.stdin.write(json.dumps(str(job.path / "submit" / "job.toml")) + "\n")
        server.stdin.flush()

    server = serve()
    submit(server)
    wait_for("a full disk", job.has_named_a_full_disk)
    wait_for("pieces at work", job.at_work)
    server.send_signal(signal.SIGKILL)
    server.wait()
    wait_for("tasks end with their worker", lambda: "running" not in job.standings())
    rounds = 0
    server = serve()
    while not job.is_done():
        rounds += 1
        demand(rounds <= 4, f"the job does not come to its end: {job.standings()}")
        submit(server)
        demand(answer(server) in ("done", "failed"), "HyperQueue says nothing")
    server.stdin.close()
    server.wait()
    return f"{rounds} submissions after the first"


def serve(folder):
    """The server with two workers of one core each; submits the job files that it is given."""
    from hyperqueue import Job as Tasks
    from hyperqueue.cluster import LocalCluster, WorkerConfig
    from hyperqueue.output import StdioDef

    Path(folder).mkdir()
    with LocalCluster(folder, WorkerConfig(cores=1)) as cluster:
        cluster.start_worker(WorkerConfig(cores=1))
        client = cluster.client()
        print(f"{SAID}ready", flush=True)
        for line in sys.stdin:
            file = tomllib.loads(Path(json.loads(line)).read_text())
            tasks, known = Tasks(max_fails=None), {}
            for task in file["task"]:
                deps = [known[id] for id in task.get("deps", [])]
                known[task["id"]] = tasks.program(
                    task["command"],
                    cwd=task["cwd"],
                    stdout=None,
                    stderr=StdioDef.from_path(os.path.join(task["cwd"], task["stderr"])),
                    deps=deps,
                    crash_limit=task["crash_limit"],
                )
            done = client.wait_for_jobs([client.submit(tasks)], raise_on_error=False)
            print(f"{SAID}{'done' if done else 'failed'}", flush=True)


def check_openjd(job, python):
    """`openjd run`, killed in the middle, then run again until the job is done."""
    openjd = python.parent / "openjd"

    def run():
        job.write_again()
        words = [str(openjd), "run", str(job.path / "submit" / "template.json")]
        log = open(job.place / "openjd.txt", "a")
        return subprocess.Popen(words, stdout=log, stderr=log, cwd=job.place)

    session = run()
    wait_for("pieces at work", job.at_work)
    session.send_signal(signal.SIGKILL)
    session.wait()
    rounds = 0
    while not job.is_done():
        rounds += 1
        demand(rounds <= 6, f"the job does not come to its end: {job.standings()}")
        run().wait()
    return f"{rounds} runs after the first"


def check_slurm(job, _):
    """A controller and a node on this machine; the node's daemon is killed in the middle with all its steps."""
    cluster = Slurm(job.place / "slurm")
    try:
        submit = ["submit", "--again", job.path, "--go"]
        env = {**os.environ, "SLURM_CONF": str(cluster.config)}

        def go():
            done = subprocess.run([job.plaus, *map(str, submit)], env=env, capture_output=True, text=True)
            demand(done.returncode == 0, f"submit: {done.stdout}{done.stderr}")

        go()
        wait_for("a full disk", job.has_named_a_full_disk)
        wait_for("pieces at work", job.at_work)
        cluster.kill_node()
        time.sleep(3)  # Slurm waits a moment before it asks about a job that has just begun
        cluster.start_node()
        rounds = 0
        while True:
            wait_for("Slurm's queue", lambda: cluster.is_idle())
            if job.is_done():
                break
            job.status()
            rounds += 1
            demand(rounds <= 4, f"the job does not come to its end: {job.standings()}")
            go()
        return f"{rounds} submissions after the first"
    finally:
        cluster.stop()


class Slurm:
    """One node on the loopback interface, run by the user who runs this script."""

    def __init__(self, folder):
        import getpass
        import socket

        host, user = socket.gethostname().split(".")[0], getpass.getuser()
        for name in ["state", "spool"]:
            (folder / name).mkdir(parents=True)
        self.folder, self.config = folder, folder / "slurm.conf"
        settings = {
            "ClusterName": "plaus", "SlurmctldHost": f"{host}(127.0.0.1)", "SlurmUser": user, "SlurmdUser": user,
            "AuthType": "auth/none", "CredType": "cred/none", "SlurmctldPort": 26817, "SlurmdPort": 26818,
            "StateSaveLocation": folder / "state", "SlurmdSpoolDir": folder / "spool",
            "SlurmctldPidFile": folder / "slurmctld.pid", "SlurmdPidFile": folder / "slurmd.pid",
            "SlurmctldLogFile": folder / "slurmctld.log", "SlurmdLogFile": folder / "slurmd.log",
            "ProctrackType": "proctrack/pgid", "TaskPlugin": "task/none", "SelectType": "select/cons_tres",
            "SelectTypeParameters": "CR_Core", "JobAcctGatherType": "jobacct_gather/none", "MpiDefault": "none",
            "ReturnToService": 2, "JobRequeue": 1, "BatchStartTimeout": 1, "SlurmdTimeout": 6, "SchedulerParameters": "sched_interval=1,batch_sched_delay=1",
        }
        lines = [f"{key}={value}" for key, value in settings.items()]
        lines.append(f"NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN")
        lines.append(f"PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP")
        self.config.write_text("\n".join(lines) + "\n")
        self.env = {**os.environ, "SLURM_CONF": str(self.config)}
        self.controller = self.start("slurmctld", "-D", "-c")
        self.start_node()

    def start(self, *words):
        log = open(self.folder / "daemons.txt", "a")
        return subprocess.Popen(words, env=self.env, stdout=log, stderr=log)

    def start_node(self):
        self.node = self.start("slurmd", "-D")
        ready = {"idle", "mixed", "allocated"}
        wait_for("a node that takes jobs", lambda: self.ask("sinfo", "-h", "-o", "%T").strip() in ready, 60)

    def ask(self, *words):
        return subprocess.run(words, env=self.env, capture_output=True, text=True).stdout

    def is_idle(self):
        """Whether nothing runs or can run. A merge whose pieces failed would wait for ever, so it is cancelled."""
        queue = [line.split(None, 2) for line in self.ask("squeue", "-h", "-o", "%A %T %r").splitlines()]
        for number, _, why in [line for line in queue if "DependencyNeverSatisfied" in line[2]]:
            self.ask("scancel", number)
        return not queue

    def kill_node(self):
        """Kills everything that the node runs, as if its power failed."""
        steps = self.ask("ps", "-eo", "pid=,args=").splitlines()
        mine = [line.split(None, 1) for line in steps if str(self.folder.parent) in line or "slurmstepd: [" in line]
        own = {os.getpid(), os.getppid(), self.controller.pid}
        self.node.kill()
        for number, command in mine:
            if int(number) not in own and ("slurmstepd" in command or " sample " in command):
                try:
                    os.kill(int(number), signal.SIGKILL)
                except ProcessLookupError:
                    pass
        self.node.wait()

    def stop(self):
        for daemon in [self.node, self.controller]:
            daemon.terminate()
            daemon.wait()


def twice_at_once(job):
    """Starts the same piece twice at once: the second process waits, and finds nothing to do."""
    out = job.place / "once"
    words = [job.plaus, "sample", str(job.place / FILE), *job.run, "--shard", "1/4", "--out", str(out), "--continue", "-q"]
    first, second = (subprocess.Popen(words, stderr=subprocess.PIPE, text=True, cwd=job.place) for _ in range(2))
    said = [process.communicate()[1] for process in (first, second)]
    demand((first.returncode, second.returncode) == (0, 0), f"a piece twice at once: {said}")
    for path in (job.path / "pieces" / "1").glob("chain-*"):
        demand(path.read_bytes() == (out / path.name).read_bytes(), f"{path.name}: not the same bytes")


def processor():
    """Processor seconds of all processes that were started from here and have ended, including their children."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def measure_start(job):
    """Seconds from the start to the end of a piece of one iteration, and its processor seconds."""
    times, begun = [], processor()
    for index in range(21):
        words = ["sample", job.place / FILE, "--chains", "4", "--warmup", "0", "--iterations", "1", "-q"]
        begin = time.perf_counter()
        job.call(*words, "--shard", "1/4", "--out", job.place / f"start-{index}")
        times.append(time.perf_counter() - begin)
    return statistics.median(times), (processor() - begun) / len(times)


def measure_speed(job, python, seconds):
    """Speed of two pieces on two workers of HyperQueue, as a share of one process with two threads, in pairs of runs: by
    the clock, and by processor time, which does not depend on what else the machine does."""
    scenario = job.place / FILE
    probe, begin = 200_000, time.perf_counter()
    run = ["--chains", "2", "--thin", "100", "--warmup", "0"]
    job.call("sample", scenario, *run, "--iterations", probe, "--threads", 2, "-q", "--out", job.place / "probe")
    length = int(probe * seconds / (time.perf_counter() - begin))
    shares = []
    for index in range(3):
        begin, spent = time.perf_counter(), processor()
        whole = job.place / f"speed-{index}"
        job.call("sample", scenario, *run, "--iterations", length, "--threads", 2, "-q", "--out", whole)
        alone = (time.perf_counter() - begin, processor() - spent)
        folder = job.place / f"job-{index}"
        job.call("submit", scenario, *run, "--iterations", length, "--to", "hyperqueue", "--shards", 2, "--out", folder)
        spent = processor()
        server = start_server([str(python), __file__, "--serve", str(job.place / f"server-{index}")], job.place)
        demand(answer(server) == "ready", "HyperQueue does not start")
        begin = time.perf_counter()
        server.stdin.write(json.dumps(str(folder / "submit" / "job.toml")) + "\n")
        server.stdin.flush()
        demand(answer(server) == "done", "HyperQueue did not run the pieces")
        shared = time.perf_counter() - begin
        server.stdin.close()
        server.wait()
        shared = (shared, processor() - spent)
        clock, spent = (one / two for one, two in zip(alone, shared))
        shares.append((clock, spent))
        one, two = ([f"{time:.1f} s" for time in times] for times in (alone, shared))
        print(
            f"  one process, 2 threads: {one[0]}, {one[1]} of processor; 2 workers, merge and server included: {two[0]}, "
            f"{two[1]}; speed {clock:.3f} by the clock, {spent:.3f} by the processor",
            flush=True,
        )
    return [statistics.median(share) for share in zip(*shares)]


def measure(job, python, speed):
    """The checks that need only one engine."""
    twice_at_once(job)
    took, spent = (1000 * seconds for seconds in measure_start(job))
    print(f"a piece of one iteration: {took:.0f} ms (median of 21), {spent:.0f} ms of processor", flush=True)
    if speed:
        clock, spent = measure_speed(job, python, speed)
        print(f"speed: {clock:.3f} by the clock, {spent:.3f} by the processor (medians of 3 pairs)", flush=True)


CHECKS = {"hyperqueue": check_hyperqueue, "openjd": check_openjd, "slurm": check_slurm}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plaus", type=Path)
    parser.add_argument("--scenario", type=Path)
    parser.add_argument("--venv", type=Path)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--quick", action="store_true", help="short runs")
    parser.add_argument("--speed", type=float, help="measure the speed, in runs of so many seconds")
    parser.add_argument("--serve", help=argparse.SUPPRESS)
    parser.add_argument("engines", nargs="*", choices=list(CHECKS) + [[]])
    arguments = parser.parse_args()
    if arguments.serve:
        serve(arguments.serve)
        return 0
    python = environment(arguments.venv.absolute(), REQUIREMENTS)
    for engine in arguments.engines:
        if engine == "slurm" and not all(shutil.which(name) for name in ["slurmctld", "slurmd", "sbatch"]):
            print("slurm: SKIPPED, it is not installed (Debian: slurm-wlm)", flush=True)
            continue
        try:
            for kind in (Job, ChanceJob):
                begin = time.monotonic()
                job = kind(arguments, engine)
                how = CHECKS[engine](job, python)
                files = job.is_the_whole()
                job.had_accidents()
                job.refuses()
                what = f"{files} files are those" if kind is Job else "batches of a chance are those"
                print(f"{engine}: {what} of one machine; {how}; {time.monotonic() - begin:.0f} s", flush=True)
                if engine == arguments.engines[0] and kind is Job:
                    measure(job, python, arguments.speed)
        except Wrong as wrong:
            print(f"{engine}: WRONG: {wrong}", flush=True)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
