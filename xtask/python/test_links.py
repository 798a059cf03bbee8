"""The check of links finds dead ones, and nothing else."""

import tempfile
import unittest
from pathlib import Path

from build_site import slug
from check_links import dead


class Links(unittest.TestCase):
    def found(self, link: str) -> list[str]:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder).resolve()
            (root / "docs").mkdir()
            (root / "docs" / "a.html").write_text(f'<h2 id="here">a</h2><a href="{link}">b</a>')
            (root / "index.html").write_text('<h1 id="top">a</h1>')
            wrong, count = dead(root)
            self.assertLessEqual(len(wrong), count)
            return wrong

    def test_live_ones(self) -> None:
        for link in ("../index.html", "../index.html#top", "#here", "a.html#here", "https://example.org/x"):
            self.assertEqual(self.found(link), [], link)

    def test_dead_ones(self) -> None:
        # A missing page, a missing anchor, a folder, a path that only a host has, another site's file, a script.
        for link in ("b.html", "../index.html#gone", "#gone", "../docs/", "/index.html", "../../x.html", "javascript:x()"):
            self.assertEqual(len(self.found(link)), 1, link)

    def test_anchors_are_those_of_hosts(self) -> None:
        self.assertEqual(slug("`faces_up`, and what counts: 6 of 8"), "faces_up-and-what-counts-6-of-8")


if __name__ == "__main__":
    unittest.main()
