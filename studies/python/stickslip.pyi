"""Frictional contact, three ways to enforce it, and their derivatives."""

from os import PathLike
from typing import Any, Mapping, Optional, Union

from numpy import float64, int32, uint8
from numpy.typing import NDArray

__version__: str

class InputError(ValueError):
    """A scene with faults. str() has all of them, one a line."""

    faults: list[str]
    """FILE:LINE:COL: POINTER: what is wrong; of a dict: "scene: POINTER: what is wrong"."""

class Result:
    """What a run left. Its arrays are read-only views into it and keep it alive; none of them is a copy."""

    @property
    def status(self) -> str:
        """"converged", "converged_at_roundoff", or why not: "inaccurate", "cap", "cycle", "stagnated", "infeasible",
        "no_equilibrium", "singular", "inverted_element", "not_finite" (a failed solve raises nothing)."""
    @property
    def converged(self) -> bool: ...
    @property
    def message(self) -> str: ...
    @property
    def notes(self) -> list[str]:
        """What the reader had to say of a valid scene."""
    @property
    def warnings(self) -> list[dict[str, Any]]:
        """What is no failure and should be known: dicts of `code` (README, "What a run leaves"), `where`, `value`,
        `remedy` and `text`."""
    @property
    def document(self) -> dict[str, Any]:
        """The content of result.json, made anew by each access."""
    @property
    def times(self) -> NDArray[float64]:
        """End of each step that the scene asked for, (steps,); a failed step is the last."""
    @property
    def responses(self) -> dict[str, NDArray[float64]]:
        """By name, (steps,)."""
    @property
    def sensitivities(self) -> dict[str, dict[str, NDArray[float64]]]:
        """By response and parameter, (steps,); NaN where the derivative is not known."""
    @property
    def coordinates(self) -> NDArray[float64]:
        """Initial, (nodes, dimension)."""
    @property
    def elements(self) -> dict[str, NDArray[int32]]:
        """By body: the nodes of each element, corners first, (elements, nodes of one)."""
    def displacement(self, step: int = -1) -> NDArray[float64]:
        """(nodes, dimension), at the end of a step. IndexError where there is no such step."""
    def displacement_derivative(self, parameter: str) -> NDArray[float64]:
        """(nodes, dimension), of the last step. KeyError where there is no such parameter."""
    def contact(self, name: str, step: int = -1) -> dict[str, NDArray[Any]]:
        """The points of a contact at the end of a step: `nodes` (points,), `state` (0 open, 1 stick, 2 slip), `pressure`
        (positive in compression), `traction` (force per area on the slave, (points, dimension)), `gap` (negative:
        penetration), `slip` (of this increment, (points, tangents)), `area` (tributary). KeyError, IndexError."""

def run(
    scene: Union[Mapping[str, Any], str, PathLike[str]],
    method: Optional[str] = None,
    set: Mapping[str, Any] = {},
    folder: Union[str, PathLike[str], None] = None,
) -> Result:
    """Runs a scene: a dict (mesh files are then looked for in the current folder), or the path of a file.

    method: "penalty", "uzawa_al", "monolithic_al" in place of the scene's. set: {JSON pointer: value}, as --set.
    folder: where result.json and the fields are written; None: nowhere. The GIL is released while it solves; Ctrl-C
    ends it after the step at hand. Raises InputError with all faults of the scene, OSError where the disk refuses."""
