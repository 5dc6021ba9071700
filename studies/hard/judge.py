"""Holds a row against what its case expects: green, or red with the reasons."""

import math
import re

from run_case import SOLVED


def _step(row, time):
    if time is None:
        return row["path"][-1] if row["path"] else {}
    near = [step for step in row["path"] if abs(step["time"] - time) <= 1e-9 * (1 + abs(time))]
    return near[-1] if near else {}


def value_of(row, name, time=None, one_sided=False):
    """A response, a sum or difference of some (a+b-c), an objective, a derivative NAME/PARAMETER, or its two sides;
    None where the row has none."""
    step = _step(row, time)
    responses = step.get("responses") or {}
    if name in responses:
        return responses[name]
    if re.search(r"[+-]", name):
        parts = [(sign, responses.get(part)) for sign, part in re.findall(r"([+-]?)([^+-]+)", name)]
        return None if any(value is None for _, value in parts) else sum(
            -value if sign == "-" else value for sign, value in parts)
    objective = (row.get("objectives") or {}).get(name.partition("/")[0])
    if objective:
        return (objective.get("gradient") or {}).get(name.partition("/")[2]) if "/" in name else objective.get("value")
    response, _, parameter = name.partition("/")
    table = step.get("one_sided" if one_sided else "sensitivities") or {}
    return (table.get(response) or {}).get(parameter)


def _error(got, answer, expected):
    """The error over its scale; None is right where None is expected."""
    if got is None or expected is None:
        return 0.0 if got is None and expected is None else math.inf
    scale = answer.scale if answer.scale is not None else abs(expected) or 1.0
    return abs(got - expected) / scale


def _what(answer):
    time = "" if answer.time is None else f" at {answer.time:g}"
    return ("one-sided " if answer.one_sided else "") + answer.name + time


def check_answer(row, answer):
    """One line of the row's table of answers."""
    got = value_of(row, answer.name, answer.time, answer.one_sided)
    check = {"what": _what(answer), "got": got, "tolerance": answer.tolerance, "error": None}
    if answer.kind != "value":
        limit = answer.values[0]
        holds = got is not None and (got >= limit if answer.kind == "at least" else got <= limit)
        return {**check, "expected": f"{answer.kind} {limit:.10g}", "holds": holds}
    gots = got if answer.one_sided and isinstance(got, list) else [got]
    if len(gots) != len(answer.values):
        gots = [math.inf] * len(answer.values)
    error = max(_error(one, answer, expected) for one, expected in zip(gots, answer.values))
    expected = ", ".join("none" if value is None else f"{value:.10g}" for value in answer.values)
    return {**check, "expected": expected, "error": error, "holds": error <= answer.tolerance}


def check_count(row, count):
    got = row.get(count.name)
    got = max(got, default=0) if isinstance(got, list) else got
    limit = count.values[0]
    holds = got is not None and (got >= limit if count.kind == "at least" else got <= limit)
    name = {"newton": "iterations of a step", "augmentations": "augmentations of a step"}.get(count.name, count.name)
    return {"what": name, "got": got, "expected": f"{count.kind} {limit:g}", "tolerance": 0, "error": None,
            "holds": holds}


def check_solutions(row, solutions):
    """The nearest of the solutions; it holds where one is met."""
    best = None
    for solution in solutions:
        scale = max(abs(value) for value in solution.values.values()) or 1.0
        gots = [value_of(row, name) for name in solution.values]
        error = max(math.inf if got is None else abs(got - value) / scale
                    for got, value in zip(gots, solution.values.values()))
        if best is None or error < best["error"]:
            best = {"what": ", ".join(solution.values), "error": error, "tolerance": solution.tolerance,
                    "expected": f"{solution.name}: " + ", ".join(f"{v:.6g}" for v in solution.values.values()),
                    "got": ", ".join("none" if got is None else f"{got:.10g}" for got in gots),
                    "holds": error <= solution.tolerance}
    return best


def judge(case, row):
    """Adds `checks` and `faults` to the row, and `green`."""
    expectation = case.expect[row["method"]]
    row["expected"] = " | ".join(expectation.statuses) + (f' "{expectation.text}"' if expectation.text else "")
    row["checks"] = []
    faults = row["faults"]
    allowed = set(expectation.statuses) | ({"converged_at_roundoff"} if "converged" in expectation.statuses else set())
    if row["status"] not in allowed:
        faults.append(f"status {row['status']}, expected {row['expected']}")
    elif expectation.text and row["status"] not in SOLVED and expectation.text not in row["message"]:
        faults.append(f'the message does not name "{expectation.text}"')
    method = row["method"]
    if row["status"] in SOLVED or row["status"] in allowed:  # (a run that must fail has answers before)
        row["checks"] += [check_answer(row, answer) for answer in case.answers
                          if method in answer.methods and (row["status"] in SOLVED or answer.time is not None)]
    if row["status"] in SOLVED:
        row["checks"] += [check_count(row, count) for count in case.counts if method in count.methods]
        if case.solutions:
            row["checks"].append(check_solutions(row, case.solutions))
        if row["certificate"] == "fails":
            faults.append("its certificate does not hold")
    if row["status"] in SOLVED or row["status"] in allowed and not allowed & set(SOLVED):
        codes = {warning["code"] for warning in row["warnings"]}
        for wanted in case.warns.get(row["method"], []):
            if not codes & set(wanted):
                faults.append(f"no warning {' or '.join(wanted)}")
    _close(row)


def _close(row):
    errors = [check["error"] for check in row["checks"] if check["error"] is not None]
    row["error"] = max(errors) if errors else None
    wrong = [check for check in row["checks"] if not check["holds"] and not check.get("said")]
    for check in wrong:
        check["said"] = True
        row["faults"].append(f"{check['what']} is {_shown(check['got'])}, expected {check['expected']}"
                             + (f" within {check['tolerance']:g}" if check["tolerance"] else ""))
    row["green"] = not row["faults"]


def _shown(value):
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def judge_relations(cases, rows):
    """Holds rows against those of other methods, and of other cases by the same method where both ran."""
    by_key = {(row["case"], row["method"]): row for row in rows}
    for case in cases:
        own = [row for row in rows if row["case"] == case.name and row["status"] in SOLVED]
        for agreement in case.agreements:
            _check_agreement(own, agreement)
        for relation in case.relations:
            for row in (row for row in rows if row["case"] == case.name):
                other = by_key.get((relation.case, row["method"]))
                if other and row["status"] in SOLVED and other["status"] in SOLVED:
                    row["checks"].append(_check_relation(row, other, relation))
                    _close(row)


def _check_relation(row, other, relation):
    if not relation.response:
        got, expected = row["newton"], other["newton"]
        return {"what": f"iterations, as {relation.case}", "got": sum(got), "expected": f"{sum(expected)}",
                "tolerance": 0, "error": None, "holds": got == expected}
    got, base = value_of(row, relation.response), value_of(other, relation.other)
    expected = None if base is None else relation.factor * base
    error = math.inf if got is None or expected is None else abs(got - expected) / (abs(expected) or 1.0)
    return {"what": f"{relation.response}, as {relation.case}", "got": got, "error": error,
            "expected": "none" if expected is None else f"{expected:.10g}", "tolerance": relation.tolerance,
            "holds": error <= relation.tolerance}


def _check_agreement(rows, agreement):
    """Rows that differ from the middle of three values, or from one another where there are two; unless they warn."""
    values = [value_of(row, agreement.name) for row in rows]
    if len(rows) < 2 or None in values:
        return
    middle = sorted(values)[len(values) // 2] if len(values) > 2 else sum(values) / 2
    scale = max(map(abs, values)) or 1.0
    for row, value in zip(rows, values):
        error = abs(value - middle) / scale
        warned = {warning["code"] for warning in row["warnings"]} & set(agreement.unless)
        row["checks"].append({
            "what": f"{agreement.name}, as by other methods", "got": value, "expected": f"{middle:.10g}",
            "error": error, "tolerance": agreement.tolerance, "holds": error <= agreement.tolerance or bool(warned)})
        _close(row)
