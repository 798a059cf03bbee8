#!/usr/bin/env python3
"""The site's own pages: the front page, the documents, and what they name, with an index for searching.

Beside these, `cargo xtask site` has put what is tried into OUT/try, and interfaces into OUT/api.
"""

import argparse
import html
import json
import os
import posixpath
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

from environment import environment

ROOT = Path(__file__).resolve().parents[2]
REQUIREMENTS = ["markdown-it-py==4.3.0", "mdit-py-plugins==0.7.0", "pygments==2.21.0"]
OWN = ROOT / "xtask" / "site"
# Nothing comes from elsewhere, and nothing is sent. `file:` is for pages that are opened from a folder.
POLICY = (
    "default-src 'none'; img-src 'self' file: data:; style-src 'self' file:; script-src 'self' file:; "
    "base-uri 'none'; form-action 'none'"
)
# Documents that the README does not list.
OTHERS = {"Validation": ["docs/validation/*.md"], "About": ["README.md"]}
# What cards are called, where it is not the name of the file.
CARDS = {
    "ball2d": "A ball on a bumpy table",
    "bowling-strike": "A strike",
    "dice-one": "One die",
    "spelling-hi": "Marbles spell HI",
}
PICTURES = {".png", ".gif", ".svg", ".jpg", ".webp"}
# Files that are copied, not shown.
BINARY = {".glb", ".obj", ".pdf", ".zip"}


def name_of(path: str) -> str:
    """The page of a document, or of a file that is shown, as a path within the site."""
    return path.removesuffix(".md") + ".html" if path.endswith(".md") else path + ".html"


def slug(heading: str) -> str:
    """The anchor of a heading, as on GitHub."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def page(at: str, title: str, body: str, here: str = "") -> str:
    """A whole page at this path of the site."""
    top = "../" * at.count("/")
    links = [
        ("try", "Try it", "try/index.html"),
        ("playground", "Playground", "playground.html"),
        ("docs", "Documentation", "docs/index.html"),
    ]
    if (OUT / "api").exists():
        links.append(("api", "Interfaces", "api/index.html"))
    current = lambda key: ' aria-current="true"' if key == here else ""
    nav = "".join(f'<a href="{top}{to}"{current(key)}>{words}</a>' for key, words, to in links)
    bar = f"""<header id="top"><div><a class="name" href="{top}index.html">Plaus</a><nav aria-label="Site">{nav}</nav>
<div id="search" role="search"><input id="query" type="search" placeholder="Search (/)" aria-label="Search the documents"
 autocomplete="off"><ul id="found" hidden aria-label="Found"></ul><span id="count" class="skip" role="status"></span></div>
<button id="theme" aria-label="Dark or light">◐</button></div></header>"""
    body = body.replace("<!-- bar -->", bar) if "<!-- bar -->" in body else bar + body
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="description" content="{html.escape(SENTENCE)}">
<title>{html.escape(title)}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="{top}style.css">
<script src="{top}site.js" data-root="{top}"></script>
</head>
<body>
<a class="skip" href="#main">Skip to the content</a>
{body}
<footer>Plaus {VERSION} · <a href="{top}LICENSE-MIT.html">MIT</a> or <a href="{top}LICENSE-APACHE.html">Apache-2.0</a> ·
<a href="{top}CHANGELOG.html">changes</a></footer>
</body>
</html>
"""


def written(at: str, text: str) -> None:
    to = OUT / at
    to.parent.mkdir(parents=True, exist_ok=True)
    to.write_text(text, encoding="utf-8")


class Documents:
    """Turns documents into pages, and follows what they link to."""

    def __init__(self) -> None:
        from markdown_it import MarkdownIt
        from mdit_py_plugins.anchors import anchors_plugin
        from pygments import highlight
        from pygments.formatters import HtmlFormatter
        from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
        from pygments.util import ClassNotFound

        def coloured(code: str, language: str, _attributes: str = "") -> str:
            try:
                lexer = get_lexer_by_name(language)
            except ClassNotFound:
                return ""
            return highlight(code, lexer, HtmlFormatter(nowrap=True))

        def coloured_file(path: Path, code: str) -> str:
            try:
                return highlight(code, get_lexer_for_filename(path.name), HtmlFormatter(nowrap=True))
            except ClassNotFound:
                return html.escape(code)

        self.coloured_file = coloured_file
        self.markdown = MarkdownIt("gfm-like", {"highlight": coloured, "linkify": False, "html": True})
        self.markdown.use(anchors_plugin, max_level=4, slug_func=slug)
        # What wide things scroll in can be reached by keyboard.
        scroll = '<div class="scroll" tabindex="0" role="region" aria-label="Table"><table>\n'
        self.markdown.add_render_rule("table_open", lambda *_: scroll)
        self.markdown.add_render_rule("table_close", lambda *_: "</table></div>\n")
        self.sections: list[dict] = []
        self.done: set[str] = set()
        self.ahead: list[str] = []
        self.titles: dict[str, str] = {}

    def groups(self) -> dict[str, list[str]]:
        """Documents by kind, in the order of the README's table."""
        readme = (ROOT / "README.md").read_text(encoding="utf-8")
        table = readme.split("## Documentation")[1].split("\n## ")[0]
        rows = [line.strip("|").split("|", 1) for line in table.splitlines() if line.startswith("| ") and "](" in line]
        found = {}
        for kind, links in rows:
            kind = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", kind).strip()
            paths = re.findall(r"\]\(([^)#]+\.md)\)", links)
            found[kind] = paths
        for kind, patterns in OTHERS.items():
            paths = [path.relative_to(ROOT).as_posix() for each in patterns for path in sorted(ROOT.glob(each))]
            found[kind] = found.get(kind, []) + [path for path in paths if path not in found.get(kind, [])]
        scenes = sorted(path for path in ROOT.glob("docs/*.md"))
        listed = {path for paths in found.values() for path in paths}
        found["Scenes"] = [path for each in scenes if (path := each.relative_to(ROOT).as_posix()) not in listed]
        return {kind: paths for kind, paths in found.items() if paths}

    def title(self, path: str) -> str:
        if path not in self.titles:
            heading = re.search(r"^# (.+)$", (ROOT / path).read_text(encoding="utf-8"), re.M)
            self.titles[path] = heading.group(1).replace("`", "") if heading else path
        return self.titles[path]

    def target(self, base: str, link: str) -> str:
        """Where a link of a document leads on the site; what it names is made too."""
        if re.match(r"[a-z]+:|#", link):
            return link
        path, _, anchor = link.partition("#")
        found = posixpath.normpath(posixpath.join(posixpath.dirname(base), path))
        if not (ROOT / found).exists():
            raise SystemExit(f"{base} links to {link}, which is not there")
        self.ahead.append(found)
        kind = posixpath.splitext(found)[1]
        if (ROOT / found).is_dir():
            to = found + "/index.html"
        else:
            to = found if kind in PICTURES | BINARY else name_of(found)
        to = posixpath.relpath(to, posixpath.dirname(name_of(base)) or ".")
        return to + ("#" + anchor if anchor else "")

    def body(self, base: str, text: str) -> str:
        """A document as HTML, and its sections for searching."""
        tokens = self.markdown.parse(text)
        headings, section = [], None
        for number, token in enumerate(tokens):
            for child in token.children or []:
                for key in ("href", "src"):
                    if child.attrGet(key):
                        child.attrSet(key, self.target(base, str(child.attrGet(key))))
            if token.type == "heading_open":
                inline = tokens[number + 1]
                words = "".join(child.content for child in inline.children or [])
                anchor = str(token.attrGet("id") or "")
                section = {"page": self.titles.get(base, base), "heading": words, "text": ""}
                section["url"] = name_of(base) + ("#" + anchor if token.tag != "h1" else "")
                self.sections.append(section)
                if token.tag == "h2":
                    headings.append((anchor, words))
            elif section and token.content and (token.type in ("inline", "fence", "code_block")):
                if tokens[number - 1].type != "heading_open":
                    plain = "".join(child.content or " " for child in token.children) if token.children else token.content
                    section["text"] += " ".join(plain.split()) + " "
        made = self.markdown.renderer.render(tokens, self.markdown.options, {})
        made = made.replace("<pre>", '<pre tabindex="0">')
        here = "".join(f'<a href="#{anchor}">{html.escape(words)}</a>' for anchor, words in headings)
        aside = f'<nav class="here" aria-label="On this page"><b>On this page</b>{here}</nav>' if here else ""
        return f'<article id="main">\n{made}</article>{aside}'

    def sidebar(self, at: str) -> str:
        """All documents, beside one of them."""
        rows = []
        for kind, paths in self.groups().items():
            rows.append(f"<b>{kind}</b>")
            for path in paths:
                to = posixpath.relpath(name_of(path), posixpath.dirname(at) or ".")
                current = ' aria-current="page"' if name_of(path) == at else ""
                rows.append(f'<a href="{to}"{current}>{html.escape(self.title(path))}</a>')
        inside = "".join(rows)
        return f'<nav aria-label="Documents"><details open><summary>All documents</summary>{inside}</details></nav>'

    def make(self, path: str) -> None:
        """The page of a document, of a file of text, of a folder; or a copy."""
        if path in self.done:
            return
        self.done.add(path)
        source, kind = ROOT / path, posixpath.splitext(path)[1]
        if source.is_dir():
            files = [each for each in sorted(source.iterdir()) if each.is_file()]
            shown = lambda each: name_of(each.name) if each.suffix not in PICTURES | BINARY else each.name
            rows = "".join(f'<li><a href="{shown(each)}">{each.name}</a></li>' for each in files)
            self.ahead += [each.relative_to(ROOT).as_posix() for each in files]
            text = f'<article id="main"><h1>{path}</h1><ul>{rows}</ul></article>'
            at = path + "/index.html"
        elif kind in PICTURES | BINARY:
            (OUT / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, OUT / path)
            return
        else:
            at, text = name_of(path), source.read_text(encoding="utf-8")
            if kind == ".md":
                text = self.body(path, text)
            elif kind == ".ipynb":
                text = self.body(path, notebook(text))
            else:
                (OUT / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, OUT / path)
                raw = f'<p class="raw"><a href="{source.name}" download>Download {source.name}</a></p>'
                code = f'<pre tabindex="0"><code>{self.coloured_file(source, text)}</code></pre>'
                text = f'<article id="main"><h1>{path}</h1>{raw}{code}</article>'
        title = self.title(path) if kind == ".md" else path
        written(at, page(at, f"{title} · Plaus", f'<div class="doc">{self.sidebar(at)}{text}</div>', "docs"))

    def all(self) -> None:
        groups = self.groups()
        for path in [path for paths in groups.values() for path in paths]:
            self.title(path)
            self.make(path)
        for path in ("CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"):
            self.make(path)
        while self.ahead:
            self.make(self.ahead.pop())
        at, parts = "docs/index.html", []
        for kind, paths in groups.items():
            link = lambda path: posixpath.relpath(name_of(path), "docs")
            rows = "".join(f'<li><a href="{link(path)}">{html.escape(self.title(path))}</a></li>' for path in paths)
            parts.append(f"<h2>{kind}</h2><ul>{rows}</ul>")
        body = f'<article id="main"><h1>Documentation</h1>{"".join(parts)}</article>'
        written(at, page(at, "Documentation · Plaus", f'<div class="doc">{self.sidebar(at)}{body}</div>', "docs"))
        sections = json.dumps(self.sections, ensure_ascii=False, separators=(",", ":"))
        written("search-index.js", f"window.sections = {sections};\n")


def notebook(text: str) -> str:
    """A notebook as a document, without what its cells print."""
    cells = [(cell["cell_type"], "".join(cell["source"])) for cell in json.loads(text)["cells"]]
    return "\n\n".join(source if kind == "markdown" else f"```python\n{source}\n```" for kind, source in cells)


def scenario_of(name: str) -> Path:
    return next(path for path in (ROOT / f"scenarios/{name}.toml", ROOT / f"scenarios/worlds/{name}.toml") if path.exists())


def cards() -> str:
    """A card for each page that samples: its picture, its name, and what must happen."""
    rows = []
    for name in json.loads((OUT / "try" / "pages.json").read_text(encoding="utf-8")):
        lines = scenario_of(name).read_text(encoding="utf-8").splitlines()
        comment = []
        for line in lines:
            if not line.startswith("# "):
                break
            comment.append(line.removeprefix("# "))
        # The first sentences, up to where the comment says how to run it.
        what = re.split(r"(?<=[.?!]) (?=[A-Z])", " ".join(comment))
        what = " ".join(what[: 2 if len(what[0]) < 60 else 1])
        what = re.sub(r" \(Chenney[^)]*\)", "", what)
        words = CARDS.get(name, name.replace("-", " ").capitalize())
        rows.append(
            f'<li><a href="try/{name}.html"><img src="try/{name}.png" alt="" width="640" height="360" loading="lazy">'
            f"<div><b>{words}</b>{html.escape(what.replace('`', ''))}</div></a></li>"
        )
    return f'<ul class="cards">{"".join(rows)}</ul>'


def front() -> None:
    loop = f"""<div id="loop"><picture><source media="(prefers-reduced-motion: reduce)" srcset="strikes.png">
<img src="strikes.gif" data-loop="strikes.gif" data-still="strikes.png" width="900" height="900" fetchpriority="high"
 alt="Nine strikes that differ, side by side"></picture><button id="pause">Pause</button></div>"""
    body = f"""{loop}
<!-- bar -->
<main id="main" class="front">
<section class="lead"><h1>{html.escape(SENTENCE)}</h1>
<p>Each of the nine above is a simulation in which every pin falls. Nothing was animated, and no motion was bent to fit:
Plaus samples whatever is uncertain in a world until what you ask for happens.</p>
<a class="act" href="try/index.html">Try it here</a><a class="act second" href="docs/getting-started.html">Get started</a></section>
<h2>Try it here</h2>
<p>Each page has the sampler in it, and goes on finding solutions while you watch. Nothing is installed, nothing is sent.</p>
{cards()}
<h2>Use it</h2>
<p>From a clone of the repository, with Rust:</p>
<pre tabindex="0"><code>cargo run --release -p plaus-cli -- try scenarios/bowling-strike.toml</code></pre>
<p><a href="docs/worlds.html">Describe a world of your own</a>, <a href="docs/import.html">bring your models</a>, export to
<a href="docs/blender.html">Blender</a> and <a href="docs/engines.html">game engines</a>, or call it
<a href="crates/plaus-python/README.html">from Python</a>. <a href="docs/sampling.html">How it works</a>.</p>
</main>"""
    written("index.html", page("index.html", "Plaus", body))
    tried = f"""<main id="main" class="front"><h1>Try it here</h1>
<p>A page samples in your browser, on up to four of its cores. <i>More like this</i> looks for neighbours of a solution;
<a href="../docs/gallery.html#a-page-that-goes-on-sampling">what else it can do</a>.</p>
{cards().replace('="try/', '="')}</main>"""
    written("try/index.html", page("try/index.html", "Try it · Plaus", tried, "try"))


def interfaces() -> None:
    """A list of what programs can call."""
    if not (OUT / "api").exists():
        return
    rows = []
    for folder in sorted((OUT / "api" / "rust").glob("plaus_*/index.html")):
        name = folder.parent.name.replace("_", "-")
        about = tomllib.loads((ROOT / "crates" / name / "Cargo.toml").read_text())["package"]["description"]
        rows.append(f'<li><a href="rust/{folder.parent.name}/index.html">{name}</a>: {html.escape(about)}</li>')
    body = f"""<main id="main" class="front"><h1>Interfaces</h1><h2>Python</h2>
<p><a href="python/plaus.html">plaus</a>, and <a href="../crates/plaus-python/README.html">how to use it</a></p>
<h2>Rust</h2><ul>{"".join(rows)}</ul></main>"""
    written("api/index.html", page("api/index.html", "Interfaces · Plaus", body, "api"))
    # Rustdoc's pages lead to a list of packages, which it does not make.
    packages = f'<main id="main" class="front"><h1>Rust</h1><ul>{"".join(rows)}</ul></main>'.replace('="rust/', '="')
    written("api/rust/index.html", page("api/rust/index.html", "Rust · Plaus", packages, "api"))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--venv", type=Path, help="folder of the virtual environment, made where it is missing")
    parser.add_argument("out", type=Path)
    given = parser.parse_args()
    if given.venv:
        python = environment(given.venv, REQUIREMENTS)
        sys.exit(subprocess.run([python, __file__, os.fspath(given.out)]).returncode)
    OUT = given.out.resolve()
    VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    SENTENCE = re.search(r"\*\*(.+?)\*\*", (ROOT / "README.md").read_text(encoding="utf-8")).group(1)
    for name in ("style.css", "site.js"):
        shutil.copyfile(OWN / name, OUT / name)
    documents = Documents()
    documents.all()
    interfaces()
    front()
    print(f"{sum(1 for _ in OUT.rglob('*.html'))} pages, {len(documents.sections)} sections to search")
