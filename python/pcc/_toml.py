"""A study as the text of a study file: so that it is checked as every study is."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import StudyError

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def study_text(tables: Mapping[str, Any]) -> str:
    """The file with these keys; values that are mappings are tables."""
    lines = [f"{name} = {_value(value, name)}" for name, value in tables.items() if not isinstance(value, Mapping)]
    for name, table in tables.items():
        if isinstance(table, Mapping):
            lines.append(f"\n[{name}]")
            lines += [f"{_key(key)} = {_value(value, f'{name}.{key}')}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise StudyError(f"the name {key!r} is no text; names of inputs and keys are")
    return key if _BARE.fullmatch(key) else _text(key)


def _text(text: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise StudyError(f"the text {text!r} has half of a surrogate pair, which is no character") from None
    # What JSON escapes, TOML reads; DEL it must escape besides, and pairs of surrogates it refuses.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any, where: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, np.integer)):
        # Numbers beyond the whole numbers of the file are measured, not counted.
        return str(int(value)) if abs(int(value)) < 2**63 else repr(float(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value)).replace("e+", "e") if np.isfinite(value) else repr(float(value))
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item, f'{where}.{key}')}" for key, item in value.items()) + " }"
    if isinstance(value, np.ndarray):
        return _value(value.tolist(), where)
    if isinstance(value, (list, tuple, range)):
        return "[" + ", ".join(_value(item, where) for item in value) + "]"
    raise StudyError(
        f"{where}: a {type(value).__name__} is none of the values that a study has; give a number, a text, a list or a dict"
    )
