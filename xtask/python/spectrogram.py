#!/usr/bin/env python3
"""Draws spectrograms of WAV files one above the other: spectrogram.py OUT.png A.wav 'title' B.wav 'title' …

Needs numpy, scipy and matplotlib.
"""

import sys

import matplotlib
import numpy as np
from scipy import signal
from scipy.io import wavfile

matplotlib.use("Agg")
import matplotlib.pyplot as plt


def main():
    out, *rest = sys.argv[1:]
    sounds = list(zip(rest[::2], rest[1::2]))
    figure, axes = plt.subplots(len(sounds), 1, figsize=(9, 2.6 * len(sounds)), constrained_layout=True, squeeze=False)
    for (path, title), (axis,) in zip(sounds, axes):
        rate, samples = wavfile.read(path)
        samples = samples.astype(float) / 32768.0
        samples = samples if samples.ndim == 1 else samples.mean(axis=1)
        frequencies, times, power = signal.spectrogram(samples, rate, nperseg=512, noverlap=384)
        shown = 10.0 * np.log10(power + 1e-14)
        mesh = axis.pcolormesh(times, frequencies / 1e3, shown, vmin=-120, vmax=-30, cmap="magma", shading="auto")
        axis.set(title=f"{title}; loudest sample {np.abs(samples).max():.2f}", ylabel="kHz", ylim=(0, 16))
        figure.colorbar(mesh, ax=axis, label="dB/Hz")
    axes[-1][0].set_xlabel("s")
    figure.savefig(out, dpi=80)


if __name__ == "__main__":
    main()
