"""Writes the list of the conformance checks, with their laws, as one Markdown page.

conformance_page.py PELORUS FILE: made from `pelorus conform --list`. Only the standard library is used.
"""

import pathlib
import sys

from plugin_pages import ask, table

GROUPS = {"library": "Every library", "every": "Every plugin", "model": "Every model", "stage": "Every stage"}


def page(checks):
    sections = ["# Conformance checks",
                f"The {len(checks)} checks of `pelorus conform`, by whom they concern. Each is a law, tried in a process of its "
                "own; what rests on a check that failed is skipped. Levels 1 to 3 are tried unless `--level` says otherwise."]
    for group in dict.fromkeys(check["group"] for check in checks):
        rows = [(f"`{check['name']}`", check["level"], check["law"],
                 ", ".join(f"`{name}`" for name in check["prerequisites"])) for check in checks if check["group"] == group]
        sections += [f"## {GROUPS.get(group, 'Kind ' + group)}", table(("check", "level", "law", "rests on"), rows)]
    return "\n\n".join(sections) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: conformance_page.py PELORUS FILE")
    file = pathlib.Path(sys.argv[2])
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(page(ask(sys.argv[1], "conform", "--list", "--json=-")), encoding="utf-8")
