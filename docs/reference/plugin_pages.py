"""Writes a Markdown page for every plugin that `pelorus list` knows, from what `pelorus inspect --json` says of it.

plugin_pages.py PELORUS FOLDER: FOLDER/README.md lists the plugins by kind, FOLDER/ID.md is the page of one. Pages of plugins
that are not there any more are removed. Only the standard library is used.
"""

import json
import pathlib
import subprocess
import sys

BOUNDS = (("min", "at least"), ("above", "above"), ("max", "at most"), ("below", "below"))


def ask(*words):
    """What a command prints, read as JSON; its errors go to the terminal and end the program."""
    return json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE).stdout)


def cell(text):
    return str(text).replace("|", "\\|").replace("\n", " ")


def table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cell(value) for value in line) + " |" for line in lines)


def count(limits):
    """`1`, `1 to 3`, `1 or more`"""
    least, most = limits["min"], limits.get("max")
    if most is None:
        return f"{least} or more" if least else "any number"
    return str(least) if least == most else f"{least} to {most}"


def number(value):
    return str(int(value)) if value == int(value) and abs(value) < 1e15 else f"{value:g}"


def type_text(parameter):
    text = parameter["type"]
    if "cols" in parameter:
        text += f" of {count(parameter['rows'])} by {count(parameter['cols'])}"
    elif "rows" in parameter:
        text += f" of {count(parameter['rows'])}" + (" rows" if text == "table" else "")
    bounds = [f"{words} {number(parameter[key])}" for key, words in BOUNDS if key in parameter]
    return ", ".join([text, *bounds])


def default_text(parameter):
    if parameter["default"] is not None:
        return f"`{parameter['default']}`"
    return "required" if parameter["required"] else "none"


def meaning(parameter):
    choices = [f"`{choice['name']}`" + (f" ({choice['doc']})" if choice["doc"] else "")
               for choice in parameter.get("choices", [])]
    return parameter["doc"] + (": " + ", ".join(choices) if choices else "")


def parameter_table(parameters):
    rows = []
    for parameter in parameters:
        rows.append((f"`{parameter['name']}`", parameter["unit"], type_text(parameter), default_text(parameter), meaning(parameter)))
        for column in parameter.get("columns", []):
            rows.append((f"`{parameter['name']}[].{column['name']}`", column["unit"], type_text(column),
                         default_text(column), meaning(column)))
    return table(("parameter", "unit", "type", "default", "meaning"), rows)


def equation_lines(text):
    """A line for each statement: breaks after `; ` and `. ` that are not within brackets."""
    lines, depth = [""], 0
    for before, letter in zip(" " + text, text):
        depth += (letter in "([") - (letter in ")]")
        if letter == " " and before in ";." and depth == 0:
            lines.append("")
        else:
            lines[-1] += letter
    return "\n".join(lines)


def prior_text(component):
    prior = component.get("prior")
    return f"{prior['mean']:g} +- {prior['deviation']:g}" if prior else ""


def instance_sections(instance):
    """Spaces and sizes of a model with default parameters."""
    if "unavailable" in instance:
        return ["It has no spaces of its own: they are those of its parts."]
    sections = []
    for name, components in instance.get("spaces", {}).items():
        rows = [(f"`{component['name']}`", component["unit"], prior_text(component)) for component in components]
        sections += [f"### {name[0].upper()}{name[1:]} space", table(("component", "unit", "prior"), rows)]
    facts = [f"Its record has {instance['record']} doubles."] if instance.get("record") else []
    if instance.get("extensions"):
        facts.append("Extensions: " + ", ".join(f"`{extension}`" for extension in instance["extensions"]) + ".")
    return sections + ([" ".join(facts)] if facts else [])


def slot_sections(slots):
    rows = [(f"`{slot['name']}`", slot["kind"], count(slot["parts"]), slot["doc"]) for slot in slots]
    sections = [table(("slot", "kind", "parts", "meaning"), rows)]
    for slot in slots:
        if slot["parameters"]:
            sections += [f"Each part in `{slot['name']}` is asked, in its own `with`:", parameter_table(slot["parameters"])]
    return sections


def port_rows(ports, way):
    for port in ports:
        remarks = [words for key, words in (("optional", "optional"), ("many", "several edges")) if port[key]]
        yield f"`{port['name']}`", way, port["message"], ", ".join(remarks), port["doc"]


def page(plugin):
    """The page of one plugin; parts that it does not have are left out."""
    sections = [f"# {plugin['id']}", f"{plugin['title']}. A {plugin['tier']} of kind `{plugin['kind']}`, version "
                f"{plugin['version']}, {plugin['license']}.", plugin["purpose"]]
    if plugin["equation"]:
        sections += ["## Equation", "```text\n" + equation_lines(plugin["equation"]) + "\n```"]
    if plugin["source"]:
        sections += ["## Source", plugin["source"]]
    if plugin["parameters"]:
        sections += ["## Parameters", parameter_table(plugin["parameters"])]
    if plugin["slots"]:
        sections += ["## Slots", *slot_sections(plugin["slots"])]
    ports = [*port_rows(plugin["in_ports"], "in"), *port_rows(plugin["out_ports"], "out")]
    if ports:
        sections += ["## Ports", table(("port", "way", "message", "", "meaning"), ports)]
    if plugin["inputs"]:
        rows = [(f"`{one['name']}`", one["unit"], ", ".join(f"{value:g}" for value in one["default"]), one["doc"])
                for one in plugin["inputs"]]
        sections += ["## Inputs", table(("input", "unit", "default", "meaning"), rows)]
    if "instance" in plugin:
        sections += ["## Spaces", "With default parameters:", *instance_sections(plugin["instance"])]
    return "\n\n".join(sections) + "\n"


def index(plugins):
    """All plugins by kind, in the order in which they are listed."""
    sections = ["# Plugins", "Made from the descriptions that the plugins give of themselves; `pelorus inspect ID` says the same."]
    for kind in dict.fromkeys(plugin["kind"] for plugin in plugins):
        rows = [(f"[{one['id']}]({one['id']}.md)", one["title"]) for one in plugins if one["kind"] == kind]
        sections += [f"## {kind}", table(("plugin", ""), rows)]
    return "\n\n".join(sections) + "\n"


def main(pelorus, folder):
    plugins = ask(pelorus, "list", "--json")
    pages = {plugin["id"] + ".md": page(ask(pelorus, "inspect", plugin["id"], "--json")) for plugin in plugins}
    pages["README.md"] = index(plugins)
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.md"):
        if old.name not in pages:
            old.unlink()
    for name, text in pages.items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: plugin_pages.py PELORUS FOLDER")
    main(*sys.argv[1:])
