"""The schema of scenes: see test_schema.sh. Use: test_schema.py WETCURL PROJECT"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import jsonschema

wetcurl, project = sys.argv[1], pathlib.Path(sys.argv[2])
failures = 0


def expect(right, what):
    global failures
    if not right:
        failures += 1
        print("FAILED:", what)


def program(*arguments):
    return subprocess.run([wetcurl, *arguments], capture_output=True, text=True)


schema = json.loads((project / "scenes/scene.schema.json").read_text())
expect(schema == json.loads(program("inspect", "schema").stdout),
       "scenes/scene.schema.json is not what `inspect schema` prints; scripts/pages renders it")
jsonschema.Draft4Validator.check_schema(schema)
validator = jsonschema.Draft4Validator(schema)


def errors_of(scene):
    return [f"{'.'.join(map(str, e.absolute_path))}: {e.message}" for e in validator.iter_errors(scene)]


# Shipped scenes.
scenes = [f for f in sorted((project / "scenes").glob("*.toml")) if not f.stem.endswith("recipe")]
scenes.append(project / "scenes/dataset/base.toml")
for file in scenes:
    errors = errors_of(tomllib.loads(file.read_text()))
    expect(not errors, f"{file}: {errors}")
expect(len(scenes) > 40, f"only {len(scenes)} scenes")

# Refusals.
tables = json.loads(program("inspect", "keys", "--json", "-").stdout)["tables"]
repeats = {t["table"]: t["repeats"] for t in tables}


def headers(table):
    """TOML that opens the table, and what it needs above it."""
    parts = table.split(".") if table else []
    return [f"[[{name}]]" if repeats[name] else f"[{name}]"
            for name in (".".join(parts[:k + 1]) for k in range(len(parts)))]


def text_of(table, lines):
    opened = headers(table)
    if table.startswith("wetness.source"):
        opened.insert(1, "flow = {}")
    if table == "solid.mesh":
        opened.insert(1, 'shape = "mesh"')
        return "\n".join(opened + lines + ["[[solid.mesh]]"]) + "\n"
    return "\n".join(opened + lines) + "\n"


def wrong_values(key):
    kind = key["kind"]
    if kind in ("word", "text", "path"):
        return ["3", "true"] + (['"no such word"'] if kind == "word" else [])
    if kind == "boolean":
        return ["1", '"true"']
    if kind == "words":
        return ["3", '"up"', '["no such word"]', "[3]"]
    numbers = [str(key["minimum"] - 1), str(key["maximum"] * 2 + 1)]
    if kind in ("number", "integer"):
        return ['"much"', "true", "[1]"] + numbers + (["1.5"] if kind == "integer" else [])
    size = key["size"]  # 0: any number of them
    return ["3", '["a", "b", "c"]'] + (["[1]"] if size else []) + [f"[{', '.join([n] * max(size, 1))}]" for n in numbers]


refused = 0
with tempfile.TemporaryDirectory() as folder:
    file = pathlib.Path(folder) / "scene.toml"
    for table in tables:
        for key in table["keys"]:
            lines = []
            if read := key.get("read"):
                value = read["words"][0] if read["words"] else "none.data"
                lines.append(f'{read["keys"][0]} = "{value}"')
            where = f'[{table["table"]}] {key["key"]}'
            if "default" in key:
                good = text_of(table["table"], lines + [f'{key["key"]} = {json.dumps(key["default"])}'])
                expect(not errors_of(tomllib.loads(good)), f"{where}: the schema refuses the default: {good}")
            for value in wrong_values(key):
                text = text_of(table["table"], lines + [f'{key["key"]} = {value}'])
                expect(errors_of(tomllib.loads(text)), f"{where}: the schema takes {value}")
            # One of them by the program too: all are the walk of tests/solver/test_scene_rows.cpp.
            file.write_text(text)
            result = program("inspect", "scene", str(file))
            expect(result.returncode == 2 and key["key"] in result.stderr,
                   f"{where}: the program says of {value}: {result.returncode} {result.stderr}")
            refused += 1
        unknown = text_of(table["table"], ["no_such_key = 1"])
        expect(errors_of(tomllib.loads(unknown)), f"[{table['table']}]: the schema takes an unknown key")
expect(refused > 120, f"only {refused} keys")

# A schema that takes everything is seen: without its ranges it takes one above them.
loose = copy.deepcopy(schema)
del loose["properties"]["fps"]["maximum"]
too_fast = {"fps": 1e9}
expect(errors_of(too_fast) and not list(jsonschema.Draft4Validator(loose).iter_errors(too_fast)),
       "a range that is missing is not seen")
print(f"{len(scenes)} scenes, {refused} keys, {failures} wrong")
sys.exit(failures > 0)
