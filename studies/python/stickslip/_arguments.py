"""Arguments as the compiled half takes them. What is not allowed is refused here, with what was given and what may be.

A wrong type is a TypeError, a value that no scene or file can have an InputError.
"""

import os
from collections.abc import Mapping
from math import isfinite
from operator import index
from os import PathLike
from typing import Any, Dict, NoReturn, Optional

from stickslip._stickslip import InputError

JSON_TYPES = "dict, list, tuple, str, int, float, bool, None, and arrays and numbers of numpy"


def refuse(text: str) -> NoReturn:
    """Raises InputError with one fault."""
    error = InputError(text)
    error.faults = [text]
    raise error


def shown(value: Any) -> str:
    """A value and its type in a message; of a long one its beginning."""
    try:
        text = ascii(value)
    except Exception:  # a __repr__ of somebody else's
        text = "a value"
    return f"{text if len(text) <= 60 else text[:57] + '...'} ({type(value).__name__})"


def wrong_type(name: str, value: Any, allowed: str) -> TypeError:
    return TypeError(f"{name} is {shown(value)}; allowed: {allowed}")


def path(value: Any, name: str, allowed: str = "a path, as str, bytes or os.PathLike") -> bytes:
    """The name of a file or a folder, as the operating system takes it."""
    try:
        text = os.fspath(value)
    except TypeError:
        raise wrong_type(name, value, allowed) from None
    try:
        encoded = os.fsencode(text)
    except UnicodeEncodeError:
        refuse(f"{name} is {shown(value)}: a lone surrogate, which no name of a file can have")
    if not encoded:
        refuse(f"{name} is empty; allowed: {allowed}")
    if b"\0" in encoded:
        refuse(f"{name} is {shown(value)}: a null character, which no name of a file can have")
    return encoded


def text(value: Any, name: str, allowed: str) -> str:
    if not isinstance(value, str):
        raise wrong_type(name, value, allowed)
    return encodable(value, name)


def encodable(value: str, name: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        refuse(f"{name} is {shown(value)}: a lone surrogate, which is no character")
    return value


def method(value: Any) -> Optional[str]:
    allowed = "penalty, uzawa_al, monolithic_al, or None for the scene's own"
    return None if value is None else text(value, "method", allowed)


def flag(value: Any, name: str) -> bool:
    """numpy's flags too."""
    if not isinstance(value, bool) and type(value).__name__ not in ("bool_", "bool"):
        raise wrong_type(name, value, "True or False")
    return bool(value)


def whole(value: Any, name: str) -> int:
    try:
        return index(value)
    except TypeError:
        raise wrong_type(name, value, "a whole number") from None


def step(value: Any, count: int) -> int:
    """Index of one of `count` steps, counted from the end if negative."""
    number = whole(value, "step")
    if not -count <= number < count:
        raise IndexError(f"there is no step {number}: the result has {count}, 0 to {count - 1}, or -1 for the last"
                         if count else f"there is no step {number}: the result has none")
    return number


def scene(value: Any) -> Any:
    """The path of a scene, or what JSON makes of its content."""
    if isinstance(value, Mapping):
        return plain(value, "scene")
    if isinstance(value, str) and value.lstrip().startswith("{") and not os.path.exists(value):
        refuse("scene is a JSON text; pass json.loads(text), or the path of a scene file")
    return path(value, "scene", "the path of a scene file, or a dict of the same content")


def overrides(values: Any) -> Dict[str, Any]:
    allowed = 'a dict of JSON pointers and values, such as {"/time/steps": 20}'
    if not isinstance(values, Mapping):
        raise wrong_type("set", values, allowed)
    return {text(key, "a key of set", "a JSON pointer, such as \"/time/steps\""): plain(value, f"set[{key!a}]")
            for key, value in values.items()}


def plain(value: Any, name: str) -> Any:
    """A value as dicts, lists, texts and numbers."""
    try:
        return _plain(value, name)
    except RecursionError:
        refuse(f"{name} is nested too deep, or holds itself")


def _plain(value: Any, name: str) -> Any:
    if isinstance(value, float) and not isfinite(value):
        refuse(f"{name} is {value}; must be a finite number")
    if value is None or isinstance(value, (bool, int, float)):
        return value
    if isinstance(value, (str, PathLike)):
        return encodable(os.fsdecode(value), name)
    if isinstance(value, Mapping):
        return {text(key, f"a key of {name}", "str"): _plain(of, f"{name}/{key}") for key, of in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(of, f"{name}/{i}") for i, of in enumerate(value)]
    if hasattr(value, "tolist") and not isinstance(value, memoryview):  # numpy's arrays and numbers
        listed = value.tolist()
        if type(listed) is not type(value):
            return _plain(listed, name)
    raise wrong_type(name, value, JSON_TYPES)
