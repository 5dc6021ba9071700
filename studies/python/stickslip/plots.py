"""Tractions of a contact, derivatives over time and work-precision diagrams, drawn by matplotlib.

Each function draws into `ax`, or into axes of its own if that is None, and returns the axes.
"""

from typing import Any, Optional

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogFormatterSciNotation

from stickslip import _arguments
from stickslip._scene import Result
from stickslip._study import Table, rows_of

STATES = ("open", "stick", "slip")
COLOURS = {"penalty": "#D55E00", "uzawa_al": "#0072B2", "monolithic_al": "#009E73"}
"""Those of the report."""
MARKERS = "os^Dv"
DASHES = ("-", "--", ":", "-.")
EXACT = 1e-16
"""Where an error of exactly 0 is drawn: below every error that rounding leaves."""


def tractions(result: Result, contact: Optional[str] = None, step: int = -1, ax: Any = None,
              iterate: bool = False) -> Any:
    """Pressure, and shear if there is friction, along a contact at the end of a step; points that slip are marked.

    The abscissa is the initial coordinate along which the contact is longest. Shear in 2D has the sign of
    the force on the slave along this coordinate; in 3D, which has two tangents, it is its size. `contact` may be left
    out if the scene has one. A step without a solution is refused (ValueError); `iterate=True` draws its last iterate,
    dashed and named so.
    """
    if not isinstance(result, Result):
        raise _arguments.wrong_type("result", result, "what run() gives, a stickslip.Result")
    if contact is None:
        if len(result.contacts) != 1:
            raise ValueError(f"contact is to be one of {', '.join(result.contacts)}")
        (contact,) = result.contacts
    table = result.contact(contact, step, iterate)
    failed = result.failed_at is not None and result.times[step] == result.failed_at
    line = "--" if failed else "-"
    places = result.coordinates[table["nodes"]]
    axis = int(np.argmax(np.ptp(places, axis=0)))
    order = np.argsort(places[:, axis], kind="stable")
    x, pressure, state = places[order, axis], table["pressure"][order], table["state"][order]
    ax = plt.subplots()[1] if ax is None else _axes(ax)
    ax.plot(x, pressure, line, color="k", label="pressure")
    if tangents := table["shear"].shape[1]:
        if tangents == 1:
            shear = table["shear"][order, 0] * np.where(table["tangent"][order, 0, axis] < 0, -1, 1)
        else:
            shear = np.linalg.norm(table["shear"][order], axis=1)
        slips = state == STATES.index("slip")
        ax.plot(x, shear, line, color="tab:red", label="shear" if tangents == 1 else "|shear|")
        ax.plot(x[slips], shear[slips], "o", color="tab:red", markersize=4, label="slip")
    what = f"no solution ({result.status}), last iterate" if failed else contact
    ax.set(title=f"{what}, t = {result.times[step]:g}", xlabel="xyz"[axis], ylabel="force per area")
    ax.legend()
    return ax


def derivative(result: Result, response: str, parameter: str, ax: Any = None) -> Any:
    """A derivative over time. If it has two sides at a step, the curve has a gap there, with a triangle for
    each side that has a derivative.

    KeyError if there is no such response or parameter.
    """
    if not isinstance(result, Result):
        raise _arguments.wrong_type("result", result, "what run() gives, a stickslip.Result")
    below, above = result.one_sided(response, parameter).T
    unseen = 1e-6 * np.nanmax(np.abs([below, above]), initial=0)  # of the height of the curve
    one = np.abs(above - below) <= unseen
    curve = np.where(one, result.sensitivities[response][parameter], np.nan)
    ax = plt.subplots()[1] if ax is None else _axes(ax)
    (line,) = ax.plot(result.times, curve, ".-")
    if not one.all():
        for side, marker, label in ((below, "<", "from below"), (above, ">", "from above")):
            ax.plot(result.times[~one], side[~one], marker, color=line.get_color(), fillstyle="none", label=label)
        ax.legend()
    ax.set(xlabel="time", ylabel=f"d {response} / d {parameter}")
    return ax


def _axes(ax: Any) -> Any:
    if not hasattr(ax, "plot"):
        raise _arguments.wrong_type("ax", ax, "axes of matplotlib, or None for new ones")
    return ax


def _names_of_what_varies(rows: list) -> dict:
    """Words for each number that differs from row to row: the end of its pointer, or, where that is the number of a place
    in a list or another's end too, the pointer."""
    keys = [key for key in {key: None for row in rows for key in row} if key.startswith("/") or key == "refine"]
    varied = [key for key in keys if len({str(row.get(key)) for row in rows}) > 1]
    ends = [key.rsplit("/", 1)[-1] for key in varied]
    words = [end if ends.count(end) == 1 and not end.isdigit() else key for key, end in zip(varied, ends)]
    return dict(zip(varied, ("mesh level" if word == "refine" else word for word in words)))


def work_precision(study: Table, of: str = "response", against: str = "enforcement", work: str = "work",
                   ax: Any = None) -> Any:
    """Error against work of the runs of a study: lower left is better.

    A curve is one method along its option on one variant of the scene.

    Parameters
    ----------
    study
        What `load_study` gives, or some of its rows, or the folder of a study.
    of
        "response" or "sensitivity": the worst error of all responses, or of all derivatives; or one of them,
        "response:press", "sensitivity:press/mu".
    against
        "enforcement" (the reference on the same mesh: what the method adds) or "discretization" (the other references).
    work
        "work" in factorisations, "seconds", or a column of counts. Of sensitivities the first two are those of the
        solution and its derivatives together.

    Runs that did not converge are crosses and on no curve; those that have no error, as they found no solution, are at
    the upper edge. Errors of exactly 0 are drawn at 1e-16. ValueError if no row has such an error.
    """
    for name, value, allowed in (("of", of, '"response", "sensitivity", or one of them, as "response:press"'),
                                 ("against", against, '"enforcement" or "discretization"'),
                                 ("work", work, '"work", "seconds", or the name of a column of counts')):
        _arguments.text(value, name, allowed)
    prefix = f"{against}:{of}" + ("" if ":" in of else ":")
    column = f"sensitivity_{work}" if of.startswith("sensitivity") and work in ("work", "seconds") else work
    curves: dict = {}
    lost: list = []  # method and work of runs without an error
    rows = rows_of(study)
    varied = _names_of_what_varies(rows)
    for row in rows:
        variant = ", ".join(f"{words} = {row[name]}" for name, words in varied.items())
        names = [name for name in row if (name == prefix if ":" in of else name.startswith(prefix))]
        errors = [abs(row[name]) for name in names if np.isfinite(row[name])]
        if not row["converged"] and not errors and row.get(column, 0) > 0:
            lost.append((row["method"], row[column]))
        if errors and row.get(column, 0) > 0:
            curves.setdefault((row["method"], row["curve"], variant), []).append(
                (row["along"], row[column], max(max(errors), EXACT), row["converged"]))
    if not curves:
        raise ValueError(f"no row of the study has an error {prefix}... and {column}; of is response, sensitivity, or one "
                         f"of them, as response:press")
    ax = plt.subplots(layout="constrained")[1] if ax is None else _axes(ax)
    several = len({variant for _, _, variant in curves}) > 1
    drawn: dict = {}  # curves of each method, which share its colour
    for (method, name, variant), points in curves.items():
        place = drawn.setdefault(method, 0)
        drawn[method] += 1
        name += f", {variant}" if several else ""
        along, cost, error, converged = (np.array(column) for column in zip(*sorted(points, key=lambda p: p[0])))
        converged = converged.astype(bool)
        (line,) = ax.plot(cost[converged], error[converged], linestyle=DASHES[place % len(DASHES)],
                        marker=MARKERS[place % len(MARKERS)], color=COLOURS.get(method), label=name)
        ax.plot(cost[~converged], error[~converged], "x", color=line.get_color())
    for method, cost in lost:
        ax.plot([cost], [1], "x", color=COLOURS.get(method), transform=ax.get_xaxis_transform(), clip_on=False)
    units = {"work": "work (factorisations)", "seconds": "seconds"}
    ax.set(xscale="log", yscale="log", xlabel=units.get(work, work.replace("_", " ")),
           ylabel=f"relative error of the {of}", title=f"{against} error".capitalize())
    for which in (ax.xaxis.set_major_formatter, ax.xaxis.set_minor_formatter):
        which(LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(2, 1)))
    if any(error == EXACT for points in curves.values() for _, _, error, _ in points):
        ax.axhline(EXACT, color="k", linestyle=":", linewidth=1)
        ax.annotate("exactly 0", (0, EXACT), xycoords=("axes fraction", "data"), xytext=(4, 3),
                    textcoords="offset points", fontsize="small")
    most = 6  # curves beside whose names a chart has room for them
    ax.legend(fontsize="small", **({"loc": "upper left", "bbox_to_anchor": (1, 1)} if len(curves) > most else {}))
    return ax
