"""The pages of reference, made from the command itself: keys of scenarios from its schema, commands from their help.

    reference.py PLAUS FOLDER            writes the pages
    reference.py PLAUS FOLDER --check    fails if they differ from what it would write
"""

import json
import pathlib
import re
import subprocess
import sys
import textwrap

NOTE = "<!-- `cargo xtask reference` writes this page -->\n"

def run(*command):
    # No terminal, whose width would decide where lines are broken.
    alone = {"stdin": subprocess.DEVNULL, "env": {"COLUMNS": "100", "NO_COLOR": "1"}}
    return subprocess.run(command, capture_output=True, text=True, check=True, **alone).stdout


class Keys:
    """Tables of keys: each of the schema's types once, where it is met first."""

    def __init__(self, schema):
        self.types = schema["$defs"]
        self.text = ["# Keys of scenarios\n", NOTE, "`plaus explain KEY` says the same of one key.\n"]
        self.waiting = [("Sampler", "sampler"), ("Require", "require")]
        worlds = self.types["World"]["properties"]
        self.waiting += [(one["$ref"].split("/")[-1], f"world.{name}") for name, one in worlds.items()]
        # The heading under which each type with keys is.
        self.places = dict(self.waiting)
        while self.waiting:
            name, heading = self.waiting.pop(0)
            found, self.waiting = self.waiting, []
            self.section(name, heading)
            # What a table names comes right after it.
            self.waiting += found

    def page(self):
        return "\n".join(self.text)

    def section(self, name, heading):
        kind = self.types[name]
        self.text.append(f"## {heading}\n")
        if kind.get("description"):
            self.text.append(textwrap.fill(self.words(kind["description"]), 120, break_on_hyphens=False) + "\n")
        if kind.get("minProperties") == 1 and kind.get("maxProperties") == 1:
            self.text.append("Exactly one of:\n")
        rows = ["| key | value | default | meaning |", "| --- | --- | --- | --- |"]
        for key, one in kind["properties"].items():
            meaning = one.get("description") or self.target(one).get("description", "")
            must = key in kind.get("required", [])
            default = "required" if must else self.default(one)
            rows.append(f"| `{key}` | {self.value(one, heading, key)} | {default} | {self.words(meaning)} |")
        self.text.append("\n".join(rows) + "\n")

    def target(self, one):
        while "$ref" in one:
            one = self.types[one["$ref"].split("/")[-1]]
        return one

    def default(self, one):
        if "default" not in one or one["default"] is None:
            return ""
        text = json.dumps(one["default"], ensure_ascii=False)
        return f"`{text}`" if len(text) <= 24 else ""

    def value(self, one, heading, key):
        if "$ref" in one:
            name = one["$ref"].split("/")[-1]
            kind = self.types[name]
            if "properties" in kind:
                if name not in self.places:
                    self.places[name] = f"{heading}.{key}" if "." in heading or heading == "sampler" else key
                    if name == "LawOf":
                        self.places[name] = "laws"
                    self.waiting.append((name, self.places[name]))
                return f"[{self.places[name]}](#{anchor(self.places[name])})"
            return self.value(kind, heading, key)
        if "anyOf" in one:
            parts = [part for part in one["anyOf"] if part.get("type") != "null"]
            values = [self.value(part, heading, key) for part in parts]
            return " or ".join(dict.fromkeys(values))
        if "oneOf" in one:
            return ", ".join(f"`{part['const']}`" for part in one["oneOf"] if "const" in part) or "a table"
        if "enum" in one:
            return ", ".join(f"`{part}`" for part in one["enum"] if part is not None)
        if "const" in one:
            return f"`{one['const']}`"
        kinds = one.get("type", "table")
        kinds = [kinds] if isinstance(kinds, str) else [kind for kind in kinds if kind != "null"]
        return " or ".join(self.plain(kind, one, heading, key) for kind in kinds)

    def plain(self, kind, one, heading, key):
        if kind in ("number", "integer"):
            low, high = one.get("minimum"), one.get("maximum")
            limits = f" {number(low)} to {number(high)}" if low is not None and high is not None else ""
            return ("number" if kind == "number" else "integer") + limits
        if kind == "array":
            items, count = one.get("items", {}), one.get("minItems")
            of = self.value(items, heading, key) if items else "values"
            exact = f"{count} of " if count is not None and count == one.get("maxItems") else "list of "
            unit = unit_of(items.get("description", ""))
            return exact + of + (f", {unit}" if unit else "")
        return {"string": "text", "boolean": "true or false", "object": "table"}.get(kind, kind)

    def words(self, text):
        return re.sub(r"\s+", " ", text).strip().replace("|", "\\|")


def unit_of(text):
    found = re.search(r"Unit: (.*?)\.$", text)
    return found.group(1) if found else ""


def number(value):
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e6:
        value = int(value)
    return f"{value:g}".replace("e+0", "e").replace("e-0", "e-") if isinstance(value, float) else str(value)


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def commands(plaus):
    """The help of each command, as the command prints it."""
    whole = run(plaus, "--help")
    names = re.findall(r"^  ([a-z]+)\s{2,}", whole.split("Options:")[0], re.M)
    parts = ["# Commands\n", NOTE, "```text\n" + trimmed(whole) + "\n```\n"]
    for name in names:
        if name != "help":
            parts.append(f"## plaus {name}\n\n```text\n{trimmed(run(plaus, name, '--help'))}\n```\n")
    return "\n".join(parts)


def trimmed(text):
    return "\n".join(line.rstrip() for line in text.strip().split("\n"))


def main():
    plaus, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    pages = {"keys.md": Keys(json.loads(run(plaus, "schema"))).page(), "commands.md": commands(plaus)}
    if "--check" in sys.argv:
        old = [name for name, text in pages.items() if (folder / name).read_text(encoding="utf-8") != text]
        if old:
            sys.exit(f"{folder}: {', '.join(old)} are not what the command says now: cargo xtask reference")
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")


main()
