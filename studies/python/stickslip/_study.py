"""Studies: many runs, their errors and costs, as a table."""

import json
import warnings
from os import PathLike, fsdecode
from typing import Any, Dict, List, Union

from stickslip import _arguments, _stickslip

Path = Union[str, "PathLike[str]"]
Row = Dict[str, Any]
Table = Any
"""pandas.DataFrame, or a list of Row if there is no pandas."""
MOST_JOBS = 1024
"""As --jobs of the command."""


def study(study: Path, folder: Union[Path, None] = None, resume: bool = False, restart: bool = False, jobs: int = 1,
          shard: str = "1/1") -> Table:
    """Runs a study file and returns what it recorded, as `load_study` does.

    Parameters
    ----------
    study
        Path of the study file.
    folder
        For results.jsonl, report.html and figures; None: results/NAME, the name of the file without .json.
    resume, restart
        Of cells that the folder has already: keep those of this study and run what is missing, or delete them. With
        neither they are an InputError.
    jobs
        Processes that run cells at once; seconds are measured apart, by one.
    shard
        "i/N": every N-th cell alone, from the i-th on.

    Raises InputError with all faults of study, scene and folder, TypeError if an argument is of another type.
    Progress goes to sys.stderr. Ctrl-C ends it after the run at hand; finished cells are kept, and resume=True goes on.
    """
    file, target = _arguments.path(study, "study"), b"" if folder is None else _arguments.path(folder, "folder")
    resume, restart = _arguments.flag(resume, "resume"), _arguments.flag(restart, "restart")
    processes = _arguments.whole(jobs, "jobs")
    if not 1 <= processes <= MOST_JOBS:
        _arguments.refuse(f"jobs is {processes}; must be 1 to {MOST_JOBS}")
    part = _arguments.text(shard, "shard", 'str, as "1/4"')
    directory, lost, refuted = _stickslip.study(file, target, resume, restart, part, processes)
    if lost:
        warnings.warn(f"{lost} cells have no row: their processes were ended from outside; resume=True runs them again",
                      RuntimeWarning, stacklevel=2)
    for line in refuted:
        warnings.warn(line, RuntimeWarning, stacklevel=2)
    return load_study(directory)


def load_study(folder: Path) -> Table:
    """The rows of a study: a pandas.DataFrame, or, without pandas, a list of dicts with the same keys.

    One row a cell, one column for each of these; what a cell has not is missing (NaN, or no key).

    id, label, method, status, converged, message
        `label` names the method with the options that tell its runs apart.
    the name of an option, as "stiffness" or "newton.tolerance"
        Of the options that are swept: its value.
    a JSON pointer, as "/contacts/sole/friction"
        Of what is varied in the scene: its value.
    refine
        Mesh level.
    response:NAME, sensitivity:NAME/PARAMETER, objective:NAME
        At the last step, in units of the scene.
    enforcement:response:NAME, enforcement:sensitivity:NAME/PARAMETER, ..., discretization:..., kkt:NAME
        Relative errors: against the reference on the same mesh, against the other references, and of equilibrium and
        Coulomb's law.
    factorizations, backsolves, newton, augmentations, ...
        Counts, equal on every machine.
    r, work, sensitivity_work
        `work` is factorizations - sensitivity_factorizations + r * backsolves, of the solution alone; `sensitivity_work`
        is factorizations + r * (backsolves + sensitivity_backsolves). `r` is the time of a back-solve over that of a
        factorisation, measured in this study.
    seconds, sensitivity_seconds, peak_memory_mb
        Of this machine; `sensitivity_seconds` are those of the solution and its derivatives together.
    curve, along
        The curve of a work-precision diagram that the row is on, and the value of the option that runs along it.

    Raises InputError if the folder has no study. Rows that are damaged or missing are a RuntimeWarning.
    """
    encoded = _arguments.path(folder, "folder")
    name = fsdecode(encoded)
    recorded = json.loads(_stickslip.study_cells(encoded))
    if recorded["faults"]:
        warnings.warn(f"{name}/results.jsonl: {recorded['faults']}", RuntimeWarning, stacklevel=2)
    if recorded["unrecorded"]:
        warnings.warn(f"{name}: {recorded['unrecorded']} cells of the study have no row", RuntimeWarning, stacklevel=2)
    rows = [_flat(cell) for cell in recorded["cells"]]
    try:
        import pandas
    except ImportError:
        return rows
    table = pandas.DataFrame(rows)
    options = [name for cell in recorded["cells"] for name in (*cell["knobs"], *cell["row"].get("vary", {}))]
    first = list(dict.fromkeys(["id", "label", "method", "status", "converged", "message", *options]))
    return table[first + [name for name in table.columns if name not in first]]


def _flat(cell: Dict[str, Any]) -> Row:
    row = cell["row"]
    out: Row = {"id": row["id"], "label": cell["label"], "method": cell["method"], "status": row["status"],
                "converged": cell["converged"], "message": row.get("message", "")}
    out.update(cell["knobs"])
    out.update(row.get("vary", {}))
    out["refine"] = row.get("refine", 0)
    for name, value in row.get("responses", {}).items():
        out[f"response:{name}"] = _number(value)
    for name, of in row.get("sensitivities", {}).items():
        for parameter, value in of.items():
            out[f"sensitivity:{name}/{parameter}"] = _number(value)
    for name, of in row.get("objectives", {}).items():
        out[f"objective:{name}"] = _number(of["value"])
    for kind in ("enforcement", "discretization", "kkt"):
        for name, value in row.get("errors", {}).get(kind, {}).items():
            out[f"{kind}:{name}"] = _number(value)
    cost = row.get("cost", {})
    out.update(cost.get("counts", {}))
    for name in ("r", "work", "sensitivity_work", "seconds", "sensitivity_seconds"):
        out[name] = cell[name] if cost else float("nan")
    out["peak_memory_mb"] = cost.get("peak_memory_mb", float("nan"))
    out["curve"] = cell["curve"]
    out["along"] = _number(cell["along"])
    return out


def _number(value: Any) -> float:
    """What is not finite stands as null in JSON."""
    return float("nan") if value is None else value


def rows_of(table: Table) -> List[Row]:
    """The rows of what load_study() gives, or of a part of it, as dicts; of a path those of its study."""
    if isinstance(table, (str, bytes, PathLike)):
        return rows_of(load_study(table))
    if hasattr(table, "to_dict") and hasattr(table, "columns"):
        return table.to_dict("records")
    if not isinstance(table, (list, tuple)) or not all(isinstance(row, dict) for row in table):
        raise _arguments.wrong_type("study", table, "what load_study() gives, or some of its rows")
    return list(table)
