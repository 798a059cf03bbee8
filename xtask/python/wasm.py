"""Builds the sampler of live galleries and packs it: python3 xtask/python/wasm.py TARGET OUT

Installs what it needs below TARGET/wasm-tools, once: the compiler with the source of its library from Debian's packages
(`rustc-web` and others), wasm-opt from npm. Nothing on the system is changed. Needs Debian's apt-get and dpkg, npm,
cargo. OUT is the packed module.
"""

import gzip
import os
import pathlib
import subprocess
import sys

import order_wasm

PACKAGES = [
    "rustc-web", "libstd-rust-web-1.96", "libstd-rust-web-dev", "rust-web-src", "libllvm22", "lld-22", "libzopfli1",
    "zopfli",
]
BINARYEN = "binaryen@132.0.0"
TRIPLE = "wasm32-unknown-unknown"
# The most that a page may carry, packed.
MOST = 1_100_000
FLAGS = [
    "-Zunstable-options", "-Cpanic=immediate-abort", "-Zlocation-detail=none", "-Zfmt-debug=none",
    "-Clinker=rust-lld", "-Clink-arg=--max-memory=1073741824",
]


def run(*command, **options):
    print("$", " ".join(str(word) for word in command), flush=True)
    subprocess.run([str(word) for word in command], check=True, **options)


def tools(folder):
    """The tools' root, and wasm-opt."""
    root, packages = folder / "root", folder / "debs"
    if not (root / "complete").exists():
        packages.mkdir(parents=True, exist_ok=True)
        if os.geteuid() == 0:
            run("apt-get", "update", "-qq")
        # As root, apt would hand its work to a user who may not write here.
        run("apt-get", "download", "-o", "APT::Sandbox::User=root", *PACKAGES, cwd=packages)
        for package in sorted(packages.glob("*.deb")):
            run("dpkg", "-x", package, root)
        (root / "complete").write_text("\n".join(PACKAGES) + "\n")
    optimizer = folder / "node_modules/binaryen/bin/wasm-opt"
    if not optimizer.exists():
        run("npm", "install", "--prefix", folder, "--no-audit", "--no-fund", BINARYEN)
    return root, optimizer


def main(target, out):
    folder = target / "wasm-tools"
    root, optimizer = tools(folder)
    libraries = [root / "usr/lib/x86_64-linux-gnu", root / "usr/lib/llvm-22/lib"]
    env = dict(os.environ)
    env["LD_LIBRARY_PATH"] = ":".join(str(one) for one in libraries)
    env["PATH"] = f"{root / 'usr/lib/llvm-22/bin'}:{env['PATH']}"
    env["RUSTC"] = str(root / "usr/bin/rustc")
    # Its library is built from source, with the profile's own settings.
    env["RUSTC_BOOTSTRAP"] = "1"
    linker = root / "usr/lib/llvm-22/bin/wasm-ld"
    env["RUSTFLAGS"] = " ".join(FLAGS).replace("rust-lld", str(linker))
    env.pop("CARGO_ENCODED_RUSTFLAGS", None)
    env["CARGO_TARGET_DIR"] = str(folder / "target")
    run(
        env.get("CARGO", "cargo"), "rustc", "--locked", "--package", "plaus-wasm", "--lib", "--crate-type", "cdylib",
        "--profile", "wasm", "--target", TRIPLE, "-Zbuild-std=std,panic_abort",
        "-Zbuild-std-features=optimize_for_size", env=env,
    )
    made = folder / "target" / TRIPLE / "wasm/plaus_wasm.wasm"
    small = folder / "plaus.wasm"
    features = ["--enable-bulk-memory", "--enable-nontrapping-float-to-int", "--enable-sign-ext", "--enable-mutable-globals",
                "--enable-multivalue", "--enable-reference-types", "--enable-bulk-memory-opt", "--enable-extended-const"]
    # The stack comes first, so that its very end, where nothing may be any more, is all that is below 1024.
    run("node", optimizer, made, "-O3", "-Oz", "--gufa-optimizing", "-Oz", "--low-memory-unused", "--strip-debug", "--strip-producers",
        "--strip-target-features", *features, "-o", small)
    # A twentieth of the packed size.
    ordered = folder / "ordered.wasm"
    ordered.write_bytes(order_wasm.named(small.read_bytes()))
    run("node", optimizer, ordered, "--reorder-functions-by-name", "--strip-debug", "--strip-target-features", *features, "-o", small)
    packer = env | {"LD_LIBRARY_PATH": str(root / "usr/lib/x86_64-linux-gnu")}
    packed = subprocess.run([root / "usr/bin/zopfli", "--i15", "-c", small], check=True, capture_output=True, env=packer)
    assert gzip.decompress(packed.stdout) == small.read_bytes()
    print(f"{made.stat().st_size:,} bytes, {small.stat().st_size:,} optimised, {len(packed.stdout):,} packed")
    if len(packed.stdout) > MOST:
        sys.exit(f"the module is too large: at most {MOST:,} bytes")
    out.write_bytes(packed.stdout)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())
