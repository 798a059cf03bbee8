"""Whether videos and loops show what they should, as ffmpeg and Pillow read them: check_pictures.py --venv V PLAUS RUN WORK"""

import argparse
import math
import os
import subprocess
import sys
from pathlib import Path

from environment import environment

REQUIREMENTS = ["imageio-ffmpeg==0.8.1", "pillow==13.0.0", "numpy==2.4.6"]
WIDTH, HEIGHT, FPS, START, END = 320, 180, 10, 0.1, 0.5
# A loop shows a motion of less than 0.8 s at a quarter of its speed, and holds its end for a second.
SPEED, HOLD = 0.25, 1000


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("plaus", type=Path)
    parser.add_argument("run", type=Path)
    parser.add_argument("work", type=Path, help="folder to write to")
    arguments = parser.parse_args()
    if arguments.venv:
        python = environment(arguments.venv, REQUIREMENTS)
        rest = [arguments.plaus, arguments.run, arguments.work]
        return subprocess.run([python, __file__, *map(os.fspath, rest)]).returncode
    return check(arguments.plaus, arguments.run, arguments.work)


def check(plaus: Path, run: Path, work: Path) -> int:
    import imageio_ffmpeg
    import numpy as np
    from PIL import Image

    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    work.mkdir(parents=True, exist_ok=True)

    def export(form: str, start: float, end: float) -> Path:
        out = work / f"{start}-{end}.{form}"
        words: list = ["--format", form, "--sample", "0:0", "--out", out, "--force", "--size", f"{WIDTH}x{HEIGHT}"]
        words += ["--time-range", f"{start}:{end}"] + (["--fps", str(FPS)] if form != "png" else [])
        subprocess.run([plaus, "export", run, *words], check=True, env={**os.environ, "PLAUS_FFMPEG": ffmpeg})
        return out

    wrong = []
    raw = [ffmpeg, "-v", "error", "-i", export("mp4", START, END), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    video = np.frombuffer(subprocess.run(raw, check=True, stdout=subprocess.PIPE).stdout, np.uint8)
    frames = math.ceil((END - START) * FPS - 1e-9) + 1
    if video.size != frames * WIDTH * HEIGHT * 3:
        wrong.append(f"the video has {video.size / (WIDTH * HEIGHT * 3)} frames, not {frames}")
    video = video[: video.size // (WIDTH * HEIGHT * 3) * (WIDTH * HEIGHT * 3)].reshape(-1, HEIGHT, WIDTH, 3)
    # The sound lasts as long as the video, or until it has faded, and is not silent.
    raw = [ffmpeg, "-v", "error", "-i", work / f"{START}-{END}.mp4", "-f", "s16le", "-ac", "1", "-"]
    sound = np.frombuffer(subprocess.run(raw, check=True, stdout=subprocess.PIPE).stdout, np.int16)
    after, loudest = sound.size / 48000 - (END - START), np.abs(sound).max(initial=0)
    if not -0.05 < after < 2.0 or loudest < 1000:
        wrong.append(f"{sound.size / 48000:.3f} s of sound, loudest {loudest}")
    loop = Image.open(export("gif", START, END))
    slow, first = math.ceil((END - START) / SPEED * FPS - 1e-9) + 1, loop.info["duration"]
    if loop.n_frames != slow or loop.size != (WIDTH, HEIGHT) or first != 1000 // FPS:
        wrong.append(f"the loop has {loop.n_frames} frames, not {slow}, of {first} ms, {loop.size}")
    # The last frame is the picture of the end. Both codecs lose colour, but not place: a frame that is one too early
    # differs several times as much where bodies move.
    picture = np.asarray(Image.open(export("png", START, END)).convert("RGB")).astype(float)
    loop.seek(slow - 1)
    if loop.info["duration"] != 1000 // FPS + HOLD:
        wrong.append(f"the loop holds its end for {loop.info['duration']} ms")
    off = {
        name: float(np.abs(frame - picture).mean())
        for name, frame in [("video", video[-1]), ("loop", np.asarray(loop.convert("RGB")))]
    }
    wrong += [f"the last frame of the {name} is off by {value:.2f} of 255" for name, value in off.items() if value > 4.0]
    print(f"{frames} frames, {sound.size / 48000:.3f} s of sound; mean difference to pictures:", off, flush=True)
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
