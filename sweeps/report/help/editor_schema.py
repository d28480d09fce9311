"""JSON Schemas of scenes and studies, for editors that complete and check TOML while the user types.

They check single keys like `sweeps check`, but no rules on several keys. TOML editors read draft 7.
"""

import json
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from engine import Element, Scene, described_dimension, element_kinds, text_pattern
from sweeps.report.help.key_help import Key, key_line, paragraph, tables_in
from sweeps.study.study_text import AXIS_KEYS, MISTAKEN_KEYS, TOLERANCE_KEYS, Optimise, StudyText
from sweeps.text.scene_text import TABLES_OF_ROWS

Schema = dict[str, Any]

_FILES: dict[str, type[BaseModel]] = {"scene.schema.json": Scene, "study.schema.json": StudyText}
# Tables by the paths of numbers, which may be dotted, and the keys of an entry, which no step of a path has.
_BY_PATH = {
    (StudyText, "vary"): AXIS_KEYS | MISTAKEN_KEYS,
    (StudyText, "derive"): (),
    (StudyText, "tolerances"): TOLERANCE_KEYS,
    (Optimise, "start"): (),
}
# Models whose lists may be columns of a CSV file.
_OF_ROWS = {model for table in TABLES_OF_ROWS for model, _ in tables_in(Scene.model_fields[table].annotation, (table,))}

# How pydantic gives limits of types that it doesn't know, and draft 7.
_LIMITS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}


def schema_texts() -> dict[str, str]:
    """Texts of the schemas, by the names of their files."""
    return {name: json.dumps(_schema_of(model), ensure_ascii=False) for name, model in _FILES.items()}


def _schema_of(model: type[BaseModel]) -> Schema:
    shared: Schema = {}
    made = _finished(model.model_json_schema(schema_generator=_Generator), shared)
    made["$defs"] |= shared
    return {"$schema": "http://json-schema.org/draft-07/schema#", **made}


class _Generator(GenerateJsonSchema):
    """Adds what the models say in words or in code: meaning of keys, kinds of elements, tables from files."""

    def field_title_should_be_set(self, _: object) -> bool:
        return False

    def model_schema(self, schema: core_schema.ModelSchema) -> Schema:
        model = schema["cls"]
        if model is Element:
            kinds = {name: self.generate_inner(kind.__pydantic_core_schema__) for name, kind in element_kinds().items()}
            return {"oneOf": [*kinds.values()], "discriminator": {name: kind["$ref"] for name, kind in kinds.items()}}
        made = super().model_schema(schema)
        made["description"] = paragraph(model)
        given = made.get("properties", {})
        for name, field in model.model_fields.items():
            key = field.alias or name
            given[key]["description"] = key_line(Key((key,), "", model, field, ((key,),)))
            if (model, name) in _BY_PATH:
                given[key]["steps"] = [name, sorted(_BY_PATH[model, name])]
        if model is Scene:
            made |= _either(made, "elements", ["input"])
        if model is StudyText:
            given["scene"] = {"anyOf": [{"type": "string"}, self.generate_inner(Scene.__pydantic_core_schema__)]}
        arms = ((key, arm) for key, value in given.items() for arm in (value, *value.get("anyOf", ())))
        rows = [key for key, arm in arms if arm.get("type") == "array"]
        if rows and model in _OF_ROWS:
            given["file"] = {"type": "string", "description": f"CSV file with columns for any of {', '.join(rows)}"}
            made |= _either(made, "file", rows)
        return made


def _either(made: Schema, other: str, keys: list[str]) -> Schema:
    """Rules of a table in which another key can replace some required keys."""
    required = made.get("required", [])
    return {
        "required": [key for key in required if key not in keys],
        "anyOf": [{"required": [other]}, {"required": [key for key in keys if key in required]}],
    }


def _finished(part: Any, shared: Schema) -> Any:
    """A schema in words of draft 7, without TOML's missing null; definitions are added to `shared`."""
    if isinstance(part, list):
        return [_finished(inner, shared) for inner in part if inner != {"type": "null"}]
    if not isinstance(part, dict):
        return part
    made = {_LIMITS.get(key, key): _finished(inner, shared) for key, inner in part.items()}
    if made.get("default") in (None, {}, []):
        made.pop("default", None)
    if isinstance(dimension := made.get("dimension"), str):
        del made["dimension"], made["type"]
        shared.setdefault(dimension, _number(dimension))
        made["$ref"] = f"#/$defs/{dimension}"
    if isinstance(made.get("steps"), list):
        name, leaves = made.pop("steps")
        made["additionalProperties"] = {"anyOf": [made["additionalProperties"], {"$ref": f"#/$defs/{name}"}]}
        shared[name] = {"propertyNames": {"not": {"enum": leaves}}, **made}
    if "discriminator" in made:
        made |= _by_type(made.pop("oneOf"), made.pop("discriminator"))
    if "patternProperties" in made:
        made["additionalProperties"] = False
    if "prefixItems" in made:
        made["items"] = made.pop("prefixItems")
    if len(made.get("anyOf", ())) == 1:
        made |= made.pop("anyOf")[0] | {key: made[key] for key in ("description",) if key in made}
    if "$ref" in made and len(made) > 1:
        # Draft 7 ignores what stands next to a reference.
        made["allOf"] = [{"$ref": made.pop("$ref")}]
    return made


def _by_type(arms: list[Schema], kinds: Schema) -> Schema:
    """Schema of a table whose `type` determines its keys.

    Editors mark the key that is wrong, not the whole table, by the conditions; they complete keys by `anyOf`, whose
    last arm accepts everything.
    """
    kinds = kinds.get("mapping", kinds)
    return {
        "type": "object",
        "required": ["type"],
        "properties": {"type": {"enum": [*kinds]}},
        "allOf": [
            {"if": {"properties": {"type": {"const": kind}}}, "then": {"$ref": ref}} for kind, ref in kinds.items()
        ],
        "anyOf": [*arms, {}],
    }


def _number(dimension: str) -> Schema:
    """Schema of the numbers of a dimension."""
    example = described_dimension(dimension).example
    texts = {"type": "string", "pattern": text_pattern(dimension), "examples": [example]}
    if dimension == "number":
        return {"anyOf": [{"type": "number"}, texts]}
    return {"anyOf": [texts, {"const": 0}], "description": f"{dimension.replace('_', ' ')}, such as '{example}'"}
