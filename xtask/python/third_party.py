"""The software that the wheel is built from, with its licences: crates/plaus-python/THIRD-PARTY.txt."""

import json
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "crates" / "plaus-python"
LIST = PACKAGE / "THIRD-PARTY.txt"
# Software that is not a crate, and is part of the pages that the wheel makes.
DIST = ROOT / "crates/plaus-gallery/web/dist"
OTHERS = [("three.js", "MIT", DIST / "LICENSE-three"), ("gifenc", "MIT", DIST / "LICENSE-gifenc")]
RULE = "-" * 78


def host() -> str:
    """The triple of this platform."""
    said = subprocess.run(["rustc", "-vV"], check=True, capture_output=True, text=True).stdout
    return re.search(r"host: (\S+)", said).group(1)


def crates(of: str = "plaus-python", platform: str | None = None) -> list[dict]:
    """All third-party crates that are linked into a package, the extension by default, on a platform, by default this."""
    cargo = os.environ.get("CARGO", "cargo")
    words = [cargo, "metadata", "--format-version", "1", "--locked", "--filter-platform", platform or host()]
    metadata = json.loads(subprocess.run(words, check=True, capture_output=True, cwd=ROOT, text=True).stdout)
    packages = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    first = next(id for id, package in packages.items() if package["name"] == of)
    seen, ahead = set(), [first]
    while ahead:
        id = ahead.pop()
        if id in seen:
            continue
        seen.add(id)
        for dependency in nodes[id]["deps"]:
            kinds = {kind["kind"] for kind in dependency["dep_kinds"]}
            is_macro = any("proc-macro" in target["kind"] for target in packages[dependency["pkg"]]["targets"])
            if None in kinds and not is_macro:
                ahead.append(dependency["pkg"])
    return sorted(
        (packages[id] for id in seen if packages[id]["source"]),
        key=lambda package: (package["name"], package["version"]),
    )


def texts(folder: Path) -> list[str]:
    """The licences in a crate's folder."""
    names = sorted(
        path for path in folder.iterdir() if re.match(r"(?i)(licen[cs]e|copying|unlicense|notice)", path.name)
    )
    return [path.read_text(encoding="utf-8", errors="replace").strip() for path in names if path.is_file()]


def listing(of: str = "plaus-python", platform: str | None = None) -> str:
    """The whole list: every crate with its licence, then every text once, with the crates that use it."""
    lines = ["plaus is built from these, under the licences that they name; the texts are below.", ""]
    users: dict[str, list[str]] = {}
    for package in crates(of, platform):
        name = f"{package['name']} {package['version']}"
        lines.append(f"{name}: {package['license'] or 'see below'}")
        for text in texts(Path(package["manifest_path"]).parent):
            users.setdefault(text, []).append(name)
    for name, licence, path in OTHERS:
        lines.append(f"{name}: {licence}")
        users.setdefault(path.read_text(encoding="utf-8").strip(), []).append(name)
    for text, names in sorted(users.items(), key=lambda pair: pair[1]):
        lines += ["", RULE, *wrapped(names), RULE, "", text]
    return "\n".join(lines) + "\n"


def wrapped(names: list[str]) -> list[str]:
    """Names, in lines that are not too long."""
    lines = [""]
    for name in names:
        if lines[-1] and len(lines[-1]) + len(name) > 116:
            lines.append("")
        lines[-1] += (", " if lines[-1] else "") + name
    return lines


def problems() -> list[str]:
    """What is wrong with the licences in the package."""
    wrong = []
    for name in ("LICENSE-MIT", "LICENSE-APACHE"):
        if (PACKAGE / name).read_bytes() != (ROOT / name).read_bytes():
            wrong.append(f"crates/plaus-python/{name} is not the one at the top")
    if not LIST.exists() or LIST.read_text(encoding="utf-8") != listing():
        wrong.append(
            "crates/plaus-python/THIRD-PARTY.txt is not what follows from Cargo.lock: `cargo xtask wheel --licences` writes it"
        )
    return wrong
