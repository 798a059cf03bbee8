"""Opens pages in Firefox: python3 xtask/python/check_firefox.py TARGET SCRIPT.mjs PAGE.html ...

Downloads Firefox, a screen without a monitor and the libraries that this machine lacks from Debian's packages, below
TARGET/firefox, once; nothing on the system is changed. Exit codes: 0 sound, 1 not, 77 Firefox cannot be had.
"""

import os
import pathlib
import shutil
import subprocess
import sys

WANTED = ["firefox-esr", "xvfb", "x11-xkb-utils", "libgl1", "libegl1", "libgl1-mesa-dri"]
LIBRARIES = "usr/lib/x86_64-linux-gnu"


def unpacked(folder):
    """The root of the packages that are not installed here."""
    root = folder / "root"
    if (root / "complete").exists():
        return root
    debs = folder / "debs"
    debs.mkdir(parents=True, exist_ok=True)
    if os.geteuid() == 0:
        subprocess.run(["apt-get", "update", "-qq"], check=True)
    listed = ["apt-get", "install", "--yes", "--print-uris", "--no-install-recommends", *WANTED]
    lines = subprocess.run(listed, check=True, capture_output=True, text=True).stdout.splitlines()
    # 'ADDRESS' NAME_VERSION_MACHINE.deb SIZE HASH
    names = [line.split()[1].split("_")[0] for line in lines if line.startswith("'")]
    # As root, apt would hand its work to a user who may not write here.
    subprocess.run(["apt-get", "download", "-qq", "-o", "APT::Sandbox::User=root", *names], check=True, cwd=debs)
    for package in debs.glob("*.deb"):
        subprocess.run(["dpkg", "-x", package, root], check=True)
    screen = root / "usr/bin/Xvfb"
    if screen.exists():
        # It looks for the compiler of keyboards by a fixed path: from here on, in this root.
        screen.write_bytes(screen.read_bytes().replace(b"/usr/bin\0", b"usr/bin/\0"))
    (root / "complete").write_text("\n".join(names) + "\n")
    return root


def found(root, name):
    """A program, of the system or of the root."""
    return shutil.which(name) or str(root / "usr/bin" / name)


def main(target, script, pages):
    try:
        root = unpacked(target / "firefox").resolve()
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"Firefox cannot be had here: {error}")
        return 77
    env = os.environ | {"LD_LIBRARY_PATH": f"{root / LIBRARIES}:{os.environ.get('LD_LIBRARY_PATH', '')}"}
    if (root / LIBRARIES / "dri").exists():
        env["LIBGL_DRIVERS_PATH"] = str(root / LIBRARIES / "dri")
    read, write = os.pipe()
    # The screen says its number once it is there.
    words = [found(root, "Xvfb"), "-displayfd", str(write), "-screen", "0", "1600x1300x24", "-nolisten", "tcp"]
    screen = subprocess.Popen(words, cwd=root, env=env, pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        number = os.read(read, 16).decode().strip()
        if not number:
            print("Firefox cannot be had here: its screen does not start")
            return 77
        installed = shutil.which("firefox-esr") or shutil.which("firefox")
        firefox = installed or str(root / "usr/lib/firefox-esr/firefox-esr")
        env |= {"DISPLAY": f":{number}", "FIREFOX": firefox}
        return subprocess.run(["node", script, *pages], env=env).returncode
    finally:
        screen.terminate()
        screen.wait()


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]))
