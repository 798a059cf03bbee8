#!/usr/bin/env python3
"""Packs the command as it is offered for download: archive.py pack|check --plaus PROGRAM --target TRIPLE --venv V OUT.

`pack` writes OUT/plaus-VERSION-TRIPLE.tar.gz (.zip for Windows), its SHA-256, and what it is built of (CycloneDX). `check`
packs it again, unpacks it elsewhere, and uses it. Exit codes: 0 all is well, 1 it is not, 77 packages are missing.
"""

import argparse
import gzip
import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import tomllib
import uuid
import zipfile
from datetime import datetime, timezone
from pathlib import Path

import third_party
from environment import environment

ROOT = third_party.ROOT
REQUIREMENTS = ["cyclonedx-python-lib[json-validation]==11.12.0"]
BESIDE = ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"]
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]


def moment() -> int:
    """Seconds that stand for the time of everything inside: those of the commit, so that bytes do not depend on the day."""
    said = os.environ.get("SOURCE_DATE_EPOCH")
    if not said:
        said = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True).stdout
    return int(said or 315532800)  # the first moment that a zip file can say


def bill(triple: str) -> str:
    """What the command is built of, as CycloneDX says it, checked against that format's schema."""
    from cyclonedx.model import HashAlgorithm, HashType
    from cyclonedx.model.bom import Bom
    from cyclonedx.model.component import Component, ComponentType
    from cyclonedx.model.license import LicenseExpression
    from cyclonedx.output.json import JsonV1Dot6
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator
    from packageurl import PackageURL

    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]
    sums = {(each["name"], each["version"]): each.get("checksum") for each in lock}

    def component(name: str, version: str, licence: str | None, kind: ComponentType) -> Component:
        # Some crates still write `/` where the rule for licences says `OR`.
        expression = [LicenseExpression(licence.replace("/", " OR "))] if licence else []
        known = sums.get((name, version))
        hashes = [HashType(alg=HashAlgorithm.SHA_256, content=known)] if known else []
        purl = PackageURL("cargo", None, name, version)
        described = {"name": name, "version": version, "type": kind, "purl": purl, "bom_ref": str(purl)}
        return Component(**described, licenses=expression, hashes=hashes)

    own = component("plaus-cli", VERSION, "MIT OR Apache-2.0", ComponentType.APPLICATION)
    crates = third_party.crates("plaus-cli", triple)
    parts = [component(each["name"], each["version"], each["license"], ComponentType.LIBRARY) for each in crates]
    bom = Bom(components=parts, serial_number=uuid.uuid5(uuid.NAMESPACE_URL, f"plaus-{VERSION}-{triple}"))
    bom.metadata.component = own
    bom.metadata.timestamp = datetime.fromtimestamp(moment(), timezone.utc)
    bom.register_dependency(own, parts)
    text = JsonV1Dot6(bom).output_as_string(indent=1)
    wrong = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if wrong is not None:
        sys.exit(f"the list of what it is built of breaks its schema: {wrong}")
    return text + "\n"


def contents(plaus: Path, triple: str) -> dict[str, tuple[bytes, int]]:
    """Every file of the archive with its mode, by its path."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / plaus.name
        shutil.copyfile(plaus, program)
        if "windows" not in triple:  # there, what only debuggers read is in another file
            subprocess.run(["strip", os.fspath(program)], check=True)
        files = {plaus.name: (program.read_bytes(), 0o755)}
    files |= {name: ((ROOT / name).read_bytes(), 0o644) for name in BESIDE}
    files["THIRD-PARTY.txt"] = third_party.listing("plaus-cli", triple).encode(), 0o644
    files["plaus.cdx.json"] = bill(triple).encode(), 0o644
    listed = subprocess.run(["git", "ls-files", "scenarios"], cwd=ROOT, check=True, capture_output=True, text=True)
    files |= {path: ((ROOT / path).read_bytes(), 0o644) for path in listed.stdout.split()}
    return {f"plaus-{VERSION}-{triple}/{path}": each for path, each in sorted(files.items())}


def pack(plaus: Path, triple: str, out: Path) -> Path:
    files, when = contents(plaus, triple), moment()
    out.mkdir(parents=True, exist_ok=True)
    archive = out / f"plaus-{VERSION}-{triple}{'.zip' if 'windows' in triple else '.tar.gz'}"
    if archive.suffix == ".zip":
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
            for path, (data, mode) in files.items():
                entry = zipfile.ZipInfo(path, time.gmtime(when)[:6])
                entry.external_attr, entry.compress_type = mode << 16, zipfile.ZIP_DEFLATED
                packed.writestr(entry, data)
    else:
        plain = io.BytesIO()
        with tarfile.open(fileobj=plain, mode="w", format=tarfile.USTAR_FORMAT) as packed:
            for path, (data, mode) in files.items():
                entry = tarfile.TarInfo(path)
                entry.size, entry.mode, entry.mtime = len(data), mode, when
                packed.addfile(entry, io.BytesIO(data))
        archive.write_bytes(gzip.compress(plain.getvalue(), mtime=0))
    [bill_of] = [data for path, (data, _) in files.items() if path.endswith("plaus.cdx.json")]
    (out / f"plaus-{VERSION}-{triple}.cdx.json").write_bytes(bill_of)
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    archive.with_name(archive.name + ".sha256").write_text(f"{digest}  {archive.name}\n")
    print(f"{archive}: {archive.stat().st_size / 1e6:.1f} MB, sha256 {digest}")
    return archive


def check(plaus: Path, triple: str, out: Path) -> int:
    """That two archives are the same, and that one works where nothing else of the project is."""
    first = pack(plaus, triple, out)
    digest = first.with_name(first.name + ".sha256").read_text().split()[0]
    with tempfile.TemporaryDirectory() as folder:
        second = pack(plaus, triple, Path(folder) / "again")
        if hashlib.sha256(second.read_bytes()).hexdigest() != digest:
            print("packed twice, it is not the same")
            return 1
        shutil.unpack_archive(first, folder)
        inside = Path(folder) / f"plaus-{VERSION}-{triple}"
        names = {each.name for each in inside.iterdir()}
        missing = {*BESIDE, plaus.name, "THIRD-PARTY.txt", "plaus.cdx.json", "scenarios"} - names
        if missing:
            print(f"missing: {missing}")
            return 1
        around = {"PATH": os.defpath, "HOME": folder}
        for words in (["--version"], "sample scenarios/ball2d.toml --iterations 500 --quiet --out run".split()):
            print("$ plaus", *words, flush=True)
            done = subprocess.run([inside / plaus.name, *words], cwd=inside, env=around, capture_output=True, text=True)
            # 1: no solution in so few iterations.
            if done.returncode not in ([0] if words == ["--version"] else [0, 1]):
                print(done.stderr)
                return 1
            if words == ["--version"] and done.stdout.split() != ["plaus", VERSION]:
                print(f"it says that it is {done.stdout}")
                return 1
        if not (inside / "run").is_dir():
            print("it left no run")
            return 1
    return 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["pack", "check"])
    parser.add_argument("--plaus", type=Path, required=True)
    parser.add_argument("--target", default=third_party.host())
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    if given.venv:
        python = environment(given.venv, REQUIREMENTS)
        words = [python, __file__, given.what, "--plaus", given.plaus, "--target", given.target, given.out]
        sys.exit(subprocess.run([os.fspath(word) for word in words]).returncode)
    if given.what == "check":
        sys.exit(check(given.plaus, given.target, given.out))
    pack(given.plaus, given.target, given.out)
