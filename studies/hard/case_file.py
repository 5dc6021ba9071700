"""What a scene of the suite says of itself: the comments at the top of its file.

A line `// KEY ...: VALUE` begins an entry, an indented line `//   more` goes on with it, and an empty comment is
skipped. docs/hard.md describes the keys. All faults of a file are found, each with its line.
"""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

METHODS = ("penalty", "uzawa_al", "monolithic_al")
STATUSES = ("converged", "converged_at_roundoff", "cap", "cycle", "stagnated", "infeasible", "no_equilibrium",
            "inaccurate", "singular", "inverted_element", "not_finite", "refused")
COUNTS = ("newton", "augmentations", "cutbacks", "steps", "condition")
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


class CaseError(Exception):
    """All faults of a case file, `FILE:LINE: what is wrong`, one a line."""


@dataclass
class Expectation:
    """Statuses that are right for a method, and a text that the message must contain."""
    statuses: tuple
    text: str = ""


@dataclass
class Answer:
    """What a response, or its derivative `RESPONSE/PARAMETER`, must be at a time (None: at the last step).

    kind `value`: `values` has one number, or two for one-sided derivatives (from below, from above; None: no derivative
    there); `at least` and `at most` are bounds. tolerance is relative to scale, or to the value where scale is None.
    """
    name: str
    values: tuple
    tolerance: float = 0.0
    scale: float = None
    kind: str = "value"
    one_sided: bool = False
    time: float = None
    methods: tuple = METHODS


@dataclass
class Solution:
    """One of several solutions, by the values of some responses together; the result must be one of them."""
    name: str
    values: dict
    tolerance: float


@dataclass
class Relation:
    """A response that must be FACTOR times that of another case by the same method; response "" for the iterations."""
    case: str
    response: str
    factor: float = 1.0
    other: str = ""
    tolerance: float = 0.0


@dataclass
class Agreement:
    """A response that all methods must give alike, those aside that warn by a code of `unless`."""
    name: str
    tolerance: float
    unless: tuple


@dataclass
class Case:
    path: Path
    name: str
    hard: str = ""
    must: str = ""
    group: str = ""
    case: str = ""
    source: str = ""
    notes: list = field(default_factory=list)
    expect: dict = field(default_factory=dict)
    warns: dict = field(default_factory=dict)
    answers: list = field(default_factory=list)
    counts: list = field(default_factory=list)
    solutions: list = field(default_factory=list)
    relations: list = field(default_factory=list)
    agreements: list = field(default_factory=list)


def entries(text):
    """(line, key with its words, value) of the comments at the top; (line, None, text) for what is no entry."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip():
            continue
        if not line.startswith("//"):
            break
        body = line[2:]
        if not body.strip():
            continue
        if re.match(r"\s{3,}", body) and found:
            found[-1][2] = f"{found[-1][2]} {body.strip()}".strip()
            continue
        key, colon, value = body.strip().partition(":")
        found.append([number, key.strip(), value.strip()] if colon else [number, None, body.strip()])
    return found


def _methods(words):
    for word in words:
        if word not in METHODS:
            raise ValueError(f'unknown method "{word}"; allowed: {", ".join(METHODS)}')
    return tuple(words) or METHODS


def _expectation(value):
    match = re.fullmatch(r'([^"]*?)(?:\s*"([^"]*)")?', value)
    if not match:
        raise ValueError('expected statuses, with | between them, and "a text of the message"')
    statuses = tuple(word.strip() for word in match.group(1).split("|"))
    for status in statuses:
        if status not in STATUSES:
            raise ValueError(f'unknown status "{status}"; allowed: {", ".join(STATUSES)}')
    return Expectation(statuses, match.group(2) or "")


def _number(word):
    if not re.fullmatch(NUMBER, word):
        raise ValueError(f'"{word}" is no number')
    return float(word)


def _tolerance(text):
    match = re.fullmatch(rf"within ({NUMBER})(?: of ({NUMBER}))?", text)
    if not match:
        raise ValueError('expected "within TOLERANCE" or "within TOLERANCE of SCALE"')
    return float(match.group(1)), float(match.group(2)) if match.group(2) else None


def _answer(key, value):
    """`answer [one_sided] NAME [at TIME] [METHOD...]: VALUE[, VALUE] within TOLERANCE [of SCALE]`, or a bound,
    `at least VALUE` or `at most VALUE`."""
    words = key.split()[1:]
    one_sided = bool(words) and words[0] == "one_sided"
    words = words[one_sided:]
    if not words:
        raise ValueError("expected the name of a response")
    answer = Answer(words.pop(0), (), one_sided=one_sided)
    if words[:1] == ["at"]:
        answer.time = _number(" ".join(words[1:2]))
        words = words[2:]
    answer.methods = _methods(words)
    bound = re.fullmatch(rf"(at least|at most) ({NUMBER})", value)
    if bound:
        answer.kind, answer.values = bound.group(1), (float(bound.group(2)),)
        return answer
    values, _, rest = value.partition(" within")
    answer.values = tuple(None if word.strip() == "none" else _number(word.strip()) for word in values.split(","))
    if len(answer.values) != 1 + one_sided:
        raise ValueError("expected one value, or two of one_sided")
    answer.tolerance, answer.scale = _tolerance("within" + rest)
    return answer


def _count(key, value):
    words = key.split()[1:]
    if not words or words[0] not in COUNTS:
        raise ValueError(f"expected one of: {', '.join(COUNTS)}")
    bound = re.fullmatch(rf"(at least|at most) ({NUMBER})", value)
    if not bound:
        raise ValueError('expected "at most NUMBER" or "at least NUMBER"')
    return Answer(words[0], (float(bound.group(2)),), kind=bound.group(1), methods=_methods(words[1:]))


def _solution(key, value):
    """`solution NAME: ux = 0, p = 1 within TOLERANCE`"""
    name = key.partition(" ")[2].strip()
    if not name:
        raise ValueError("expected a name")
    values, _, rest = value.partition(" within")
    numbers = {}
    for part in values.split(","):
        match = re.fullmatch(rf"\s*(\S+) = ({NUMBER})\s*", part)
        if not match:
            raise ValueError('expected "RESPONSE = VALUE, ... within TOLERANCE"')
        numbers[match.group(1)] = float(match.group(2))
    return Solution(name, numbers, _tolerance("within" + rest)[0])


def _relation(key, value):
    """`like CASE: RESPONSE = FACTOR * RESPONSE within TOLERANCE`, or `like CASE: iterations`"""
    name = key.partition(" ")[2].strip()
    if value == "iterations":
        return Relation(name, "")
    match = re.fullmatch(rf"(\S+) = (?:({NUMBER}) \* )?(\S+) within ({NUMBER})", value)
    if not name or not match:
        raise ValueError('expected "RESPONSE = FACTOR * RESPONSE within TOLERANCE" or "iterations"')
    response, factor, other, tolerance = match.groups()
    return Relation(name, response, float(factor or 1), other, float(tolerance))


def _agreements(key, value):
    """`agree RESPONSE...: within TOLERANCE`, and perhaps ` unless WARNING | WARNING`"""
    names = key.split()[1:]
    if not names:
        raise ValueError("expected names of responses")
    within, _, unless = value.partition(" unless ")
    tolerance = _tolerance(within)[0]
    return [Agreement(name, tolerance, _warns(unless) if unless else ()) for name in names]


def _warns(value):
    codes = tuple(word.strip() for word in value.split("|"))
    if not all(re.fullmatch(r"[a-z_]+", code) for code in codes):
        raise ValueError("expected codes of warnings, with | between them")
    return codes


def _set_text(case, name, value):
    if getattr(case, name):
        raise ValueError("is given twice")
    if not value:
        raise ValueError("is empty")
    setattr(case, name, value)


def _take(case, key, value):
    word = key.split()[0]
    if key in ("Hard", "Must", "group", "case"):
        _set_text(case, key.lower(), value)
    elif key == "from":
        _set_text(case, "source", value)
    elif key == "Note":
        case.notes.append(value)
    elif word == "expect":
        for method in _methods(key.split()[1:]):
            if method in case.expect:
                raise ValueError(f"{method} is given twice")
            case.expect[method] = _expectation(value)
    elif word == "warns":
        for method in _methods(key.split()[1:]):
            case.warns.setdefault(method, []).append(_warns(value))
    elif word == "answer":
        case.answers.append(_answer(key, value))
    elif word == "count":
        case.counts.append(_count(key, value))
    elif word == "solution":
        case.solutions.append(_solution(key, value))
    elif word == "agree":
        case.agreements += _agreements(key, value)
    elif word == "like":
        case.relations.append(_relation(key, value))
    else:
        raise ValueError("unknown key; allowed: Hard, Must, Note, group, case, from, expect, warns, answer, count, "
                         "solution, agree, like; go on with a line by three blanks or more")


def without_comments(text):
    """The text with // comments blanked, strings kept."""
    return re.sub(r'("(?:\\.|[^"\\])*")|//[^\n]*', lambda match: match.group(1) or "", text)


def _check_responses(case, text, fault):
    """Names of responses and parameters that the scene has; only of scenes that are JSON at all."""
    try:
        scene = json.loads(without_comments(text))
        responses, parameters = scene.get("responses", {}) | scene.get("objectives", {}), scene.get("parameters", {})
    except (ValueError, AttributeError):
        return
    names = [(answer.name, "answer") for answer in case.answers]
    names += [(name, "solution") for solution in case.solutions for name in solution.values]
    names += [(relation.response, "like") for relation in case.relations if relation.response]
    names += [(agreement.name, "agree") for agreement in case.agreements]
    names = [(part, kind) for name, kind in names
             for part in ([name] if name in responses or "/" in name else re.split(r"[+-]", name))]
    for name, kind in names:
        response, slash, parameter = name.partition("/") if name not in responses else (name, "", "")
        if response not in responses:
            fault(0, f'{kind}: the scene has no response "{response}"')
        elif slash and parameter not in parameters:
            fault(0, f'{kind}: the scene has no parameter "{parameter}"')


def read_case(path):
    """The case of a scene file; CaseError with all faults."""
    path = Path(path)
    case, faults = Case(path, path.stem), []

    def fault(line, text):
        faults.append(f"{path}:{line or 1}: {text}")

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CaseError(f"{path}:1: cannot be read: {error}") from None
    for line, key, value in entries(text):
        if not key:
            fault(line, f'expected "// KEY: VALUE" or an indented line that goes on, not "{value}"')
            continue
        try:
            _take(case, key, value)
        except ValueError as error:
            fault(line, f"{key}: {error}")
    for name in ("hard", "must", "group"):
        if not getattr(case, name):
            fault(0, f'has no "// {name.capitalize() if name != "group" else name}: ..."')
    for method in METHODS:
        if method not in case.expect:
            fault(0, f'has no "// expect {method}: ..."')
    if (case.answers or case.solutions) and not case.source:
        fault(0, 'has answers, and no "// from: ..." that says where they come from')
    _check_responses(case, text, fault)
    if faults:
        raise CaseError("\n".join(faults))
    return case


def read_cases(folder):
    """All cases of a folder, by name, and the faults of all files together."""
    cases, faults = [], []
    for path in sorted(Path(folder).glob("*.json")):
        try:
            cases.append(read_case(path))
        except CaseError as error:
            faults.append(str(error))
    names = {case.name for case in cases}
    faults += [f'{case.path}:1: like: there is no case "{relation.case}"' for case in cases
               for relation in case.relations if relation.case not in names and not faults]
    if faults:
        raise CaseError("\n".join(faults))
    return cases
