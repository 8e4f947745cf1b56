"""validate_config.py SCHEMA CONFIG...: checks configs against a JSON Schema, a line for each that is wrong; exit code 1 then.

YAML is read by the core rules of version 1.2, as editors do: `5 km` is a string, 5 an integer, 1e3 a float, `yes` a string.
"""

import json
import re
import sys

import jsonschema
import yaml


class CoreLoader(yaml.SafeLoader):
    """PyYAML's own resolvers follow YAML 1.1."""


CoreLoader.yaml_implicit_resolvers = {"<": [("tag:yaml.org,2002:merge", re.compile("^<<$"))]}
for tag, pattern, first in [
    ("bool", "^(true|True|TRUE|false|False|FALSE)$", "tTfF"),
    ("null", "^(~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    ("int", "^[-+]?[0-9]+$", "-+0123456789"),
    ("float", r"^[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$", "-+0123456789."),
]:
    CoreLoader.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile(pattern), list(first))
CoreLoader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))


def main(schema_file, *configs):
    with open(schema_file, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    wrong = 0
    for config in configs:
        with open(config, encoding="utf-8") as file:
            content = yaml.load(file, CoreLoader)
        for error in validator.iter_errors(content):
            wrong += 1
            place = ".".join(str(step) for step in error.absolute_path)
            print(f"{config}: {place}: {error.message[:300]}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
