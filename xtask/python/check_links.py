#!/usr/bin/env python3
"""Dead links of a site in a folder: check_links.py FOLDER. Every page, picture, script and anchor that a page names must be
there; pages must be named as files, because a folder that is opened from disk has no index."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Rustdoc tests its own anchors (`cargo doc` with -D warnings), and makes many of them by script.
OWN_ANCHORS = "api/"


class Page(HTMLParser):
    """What a page names, and what can be named in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list) -> None:
        found = dict(attributes)
        self.anchors.update(found[key] for key in ("id", "name") if found.get(key))
        self.links += [found[key] for key in ("href", "src", "srcset") if found.get(key)]


def dead(folder: Path) -> tuple[list[str], int]:
    """Every dead link, as `PAGE: LINK`, and how many links were looked at."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
    wrong, count = [], 0
    for path, page in pages.items():
        own = path.relative_to(folder).as_posix()
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme in ("http", "https", "data", "mailto", "blob"):
                continue
            if link == "javascript:void(0)" and own.startswith(OWN_ANCHORS):
                continue  # rustdoc's settings, which are a script
            if "/trait.impl/" in link and own.startswith(OWN_ANCHORS):
                continue  # rustdoc's lists of what other crates implement a trait for, if there are any
            count += 1
            to = Path(path.parent, unquote(parts.path)).resolve() if parts.path else path
            if parts.scheme or link.startswith("/") or not to.is_relative_to(folder):
                wrong.append(f"{own}: {link} leaves the site")
            elif not to.is_file():
                wrong.append(f"{own}: {link} is not a file")
            elif parts.fragment and to in pages and not own.startswith(OWN_ANCHORS):
                if unquote(parts.fragment) not in pages[to].anchors:
                    wrong.append(f"{own}: {link} names no anchor")
    return wrong, count


if __name__ == "__main__":
    wrong, count = dead(Path(sys.argv[1]).resolve())
    print("\n".join(wrong[:40]) or "no dead link", f"({count} links, {len(wrong)} dead)")
    sys.exit(1 if wrong or not count else 0)
