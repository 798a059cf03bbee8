"""Writes reference.json beside this file: draws, and the statistics that ArviZ and emcee compute from them.

Re-make (only when a case is added; the Rust test never runs this):
    python3 -m venv /tmp/arviz && /tmp/arviz/bin/pip install arviz==0.23.4 emcee==3.1.6
    /tmp/arviz/bin/python crates/plaus-mcmc/tests/arviz/make_reference.py

The draws are rounded to a few decimals BEFORE the statistics are computed, so the JSON holds exactly the draws
that were used.
"""

import json
import math
import pathlib
import warnings

warnings.simplefilter("ignore")
import arviz as az  # noqa: E402
import emcee  # noqa: E402
import numpy as np  # noqa: E402

HERE = pathlib.Path(__file__).parent


def ar1(rng, rho, chains=4, draws=250):
    noise = rng.standard_normal((chains, draws)) * math.sqrt(1 - rho * rho)
    out = np.empty((chains, draws))
    out[:, 0] = rng.standard_normal(chains)
    for t in range(1, draws):
        out[:, t] = rho * out[:, t - 1] + noise[:, t]
    return out


def bimodal(rng, chains=4, draws=250):
    """Two modes at -3 and 3, left with probability 1/100 per iteration."""
    mode = np.where(rng.random((chains, 1)) < 0.5, -3.0, 3.0)
    flips = np.where(rng.random((chains, draws)) < 0.01, -1.0, 1.0)
    return mode * np.cumprod(flips, axis=1) + 0.5 * rng.standard_normal((chains, draws))


def discrete_walk(rng, chains=4, draws=250):
    """A lazy walk on 0..4: almost every draw is tied."""
    steps = rng.integers(-1, 2, (chains, draws))
    out = np.zeros((chains, draws))
    here = rng.integers(0, 5, chains)
    for t in range(draws):
        here = np.clip(here + steps[:, t], 0, 4)
        out[:, t] = here
    return out


def cases():
    def rng(key):
        return np.random.default_rng([2021, key])

    yield "independent", rng(0).standard_normal((4, 250)), 4
    for i, rho in enumerate([0.3, 0.9, 0.99, -0.5, -0.95]):
        yield f"ar1 {rho}", ar1(rng(10 + i), rho), 4
    yield "odd length", ar1(rng(20), 0.6, 3, 251), 4
    yield "bimodal", bimodal(rng(21)), 4
    yield "cauchy", rng(22).standard_cauchy((4, 250)), 3
    yield "cauchy walk", np.tan(0.49 * np.pi * np.tanh(ar1(rng(23), 0.9))), 3
    yield "discrete", discrete_walk(rng(24)), 0
    yield "tenths", discrete_walk(rng(25)) / 10, 1
    yield "coin", rng(26).integers(0, 2, (4, 250)).astype(float), 0
    yield "rare event", (rng(27).random((4, 250)) < 0.01).astype(float), 0
    yield "shifted", ar1(rng(28), 0.5) + np.array([[0.0], [0.0], [0.0], [2.0]]), 4
    yield "wider", ar1(rng(29), 0.5) * np.array([[1.0], [1.0], [1.0], [4.0]]), 4
    yield "drifting", ar1(rng(30), 0.3) + np.linspace(0, 3, 250), 4
    yield "stuck at the end", np.where(np.arange(250) < 150, ar1(rng(31), 0.5), 0.125), 4
    yield "far from zero", 1e6 + ar1(rng(32), 0.8), 3
    yield "constant", np.full((4, 50), 0.1), 1
    yield "each chain constant", np.repeat([[0.1], [0.7], [0.3], [0.4]], 50, axis=1), 1
    yield "single chain", ar1(rng(33), 0.7, 1, 1000), 4
    yield "slow single chain", ar1(rng(35), 0.95, 1, 1000), 4
    yield "two chains", ar1(rng(34), 0.7, 2, 64), 4
    for draws in [4, 5, 6, 7, 8, 9]:
        yield f"{draws} draws", ar1(rng(40 + draws), 0.5, 4, draws), 4
    yield "4 draws of one chain", ar1(rng(50), 0.5, 1, 4), 4


def number(x):
    x = float(x)
    return x if math.isfinite(x) else str(x)


def emcee_time(draws, rho1):
    """Only if both use the same rule: one chain with positive correlations, long enough to close the window."""
    if draws.shape[0] > 1 or draws.shape[1] < 100 or rho1 <= 0:
        return None
    return number(emcee.autocorr.integrated_time(draws[0], c=5, tol=0)[0])


def judge(draws):
    correlation = az.autocorr(draws[0])
    first = [number(x) for x in correlation[: min(20, draws.shape[1])]]
    low, median, high = np.quantile(draws, [0.05, 0.5, 0.95])
    return {
        "mean": number(draws.mean()),
        "sd": number(draws.std(ddof=1)),
        "q05": number(low),
        "median": number(median),
        "q95": number(high),
        "rhat": number(az.rhat(draws, method="rank")),
        "ess_bulk": number(az.ess(draws, method="bulk")),
        "ess_tail": number(az.ess(draws, method="tail")),
        "ess_mean": number(az.ess(draws, method="mean")),
        "mcse_mean": number(az.mcse(draws, method="mean")),
        "mcse_sd": number(az.mcse(draws, method="sd")),
        "autocorrelation": first,
        "emcee_time": emcee_time(draws, correlation[1]),
    }


def main():
    entries = []
    for name, draws, decimals in cases():
        draws = np.round(draws, decimals)
        rows = [[int(x) if decimals == 0 else float(x) for x in row] for row in draws]
        entries.append({"name": name, "reference": judge(draws), "draws": rows})
    header = {"arviz": az.__version__, "emcee": emcee.__version__, "numpy": np.__version__}
    lines = ",\n".join(json.dumps(entry, separators=(",", ":")) for entry in entries)
    text = f'{{"made_by":{json.dumps(header)},"cases":[\n{lines}\n]}}\n'
    (HERE / "reference.json").write_text(text)


main()
