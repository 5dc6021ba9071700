"""Scenes: what is run, explained and checked, and what comes out."""

import json
from difflib import get_close_matches
from os import PathLike, fsdecode
from os.path import exists, join
from typing import Any, Dict, List, Mapping, NoReturn, Optional, Union

import numpy as np

from stickslip import _arguments, _stickslip

Scene = Union[Mapping[str, Any], str, "PathLike[str]"]
Arrays = Dict[str, np.ndarray]


class _ByName(Dict[str, Any]):
    """A dict by name. A name that it lacks is a KeyError that lists its names, the nearest first."""

    def __init__(self, kind: str, known: Mapping[str, Any]):
        super().__init__(known)
        self._kind = kind

    def __missing__(self, name: Any) -> NoReturn:
        raise _no_name(self._kind, name, self)

    def __reduce__(self) -> tuple:
        return _ByName, (self._kind, dict(self))


class NotConverged(RuntimeError):
    """A run that ended without a solution: `run` raises it unless `check=False`. str() is its status and message."""

    result: "Result"
    """What there is of it: the steps before."""

    def __init__(self, result: "Result"):
        super().__init__(result)
        self.result = result

    def __str__(self) -> str:
        return f"{self.result.status}: {self.result.message}"


class Result:
    """What a run left, all of it: the steps that the scene asked for, with their derivatives.

    Arrays of a run are read-only views into the memory of the solver and keep it alive; none is a copy. Those of a
    result that was pickled are its own. Units are those of the scene.

    Attributes
    ----------
    status : str
        "converged", "converged_at_roundoff", or why not: "inaccurate", "cap", "cycle", "stagnated", "infeasible",
        "no_equilibrium", "singular", "inverted_element", "not_finite" (docs/results.md).
    converged : bool
        Whether it is one of the first two.
    message : str
        What went wrong, where, and what to try; "" if nothing did.
    notes : list of str
        What the reader had to say of a valid scene.
    title, method : str
        Title of the scene; "penalty", "uzawa_al" or "monolithic_al".
    times : ndarray, (steps,)
        End of each step; a step that failed is the last.
    failed_at : float or None
        Time of the step that has no solution. Its responses and derivatives are NaN, for the last iterate of Newton's
        method is no answer; `displacement` and `contact` give it with `iterate=True` alone.
    parameters : dict of float
        Value of each parameter, by name, in the order in which the scene names them; of a shape with "each": "node" its
        nodes NAME/0, NAME/1, ... along the side. All derivatives by parameters have this order.
    responses : dict of ndarray, (steps,)
        By name. A reaction is the force of the support on the body, a contact force that on the slave.
    sensitivities : dict of dict of ndarray, (steps,)
        By response and parameter: derivative of the response, as its method computed it, by the parameter; NaN if it
        is not known, as in adjoint mode, which has those of `objectives` alone. `jacobian` gives them as one array.
    coordinates : ndarray, (nodes, dimension)
        Initial.
    elements : dict of ndarray of int, (elements, nodes of one)
        By body: the nodes of each element, corners first.
    """

    status: str
    converged: bool
    message: str
    notes: List[str]
    title: str
    method: str
    times: np.ndarray
    parameters: Dict[str, float]
    failed_at: Optional[float]
    responses: Arrays
    sensitivities: Dict[str, Arrays]
    coordinates: np.ndarray
    elements: Arrays

    def __init__(self, state: Dict[str, Any]):
        document = json.loads(state["document"])
        self.status = document["status"]
        self.converged = self.status in ("converged", "converged_at_roundoff")
        self.message = document["message"]
        self.title = document["scene"]["title"]
        (self.method,) = document["method"]
        self.notes = state["notes"]
        self.times = state["times"]
        self.failed_at = state["failed_at"]
        self.parameters = _ByName("parameter", state["parameters"])
        self.responses = _ByName("response", state["responses"])
        self.sensitivities = _ByName("response", {response: _ByName("parameter", of)
                                                  for response, of in state["sensitivities"].items()})
        self.coordinates = state["coordinates"]
        self.elements = state["elements"]
        self._displacements = state["displacements"]
        self._displacement_derivatives = state["displacement_derivatives"]
        self._contacts = state["contacts"]
        self._document = state["document"]
        self._left_out = state.get("left_out", {})

    @property
    def document(self) -> Dict[str, Any]:
        """The content of result.json (docs/results.md), made anew by each access."""
        return json.loads(self._document)

    @property
    def warnings(self) -> List[Dict[str, Any]]:
        """What is no failure and should be known: dicts of `code`, `where`, `value`, `remedy` and `text`."""
        return self.document["warnings"]

    @property
    def objectives(self) -> Dict[str, Dict[str, Any]]:
        """By name: `value`, a float or None if the run failed, and `gradient`, a dict of float by parameter, in the order
        of `parameters`; where a step makes its sides differ also `one_sided`, a dict of [from below, from above]. Empty
        if the scene has none."""
        objectives = self.document.get("objectives", {})
        for objective in objectives.values():
            for key in ("gradient", "one_sided"):
                if key in objective:
                    objective[key] = {name: objective[key][name] for name in self.parameters if name in objective[key]}
        return objectives

    def gradient(self, objective: str) -> np.ndarray:
        """Derivative of an objective by the parameters, (parameters,), in the order of `parameters`; NaN if it is not
        known. KeyError if there is no such objective."""
        _arguments.text(objective, "objective", "the name of an objective")
        objectives = self.objectives
        if objective not in objectives:
            raise _no_name("objective", objective, objectives)
        by = objectives[objective].get("gradient", {})
        return np.array([by.get(name) for name in self.parameters], dtype=float)

    def jacobian(self, response: str) -> np.ndarray:
        """Derivatives of a response by the parameters, (steps, parameters), in the order of `parameters`; NaN where they
        are not known. KeyError if there is no such response."""
        _arguments.text(response, "response", "the name of a response")
        if response not in self.responses:
            raise _no_name("response", response, self.responses)
        by = [self.sensitivities[response][name] for name in self.parameters]
        return np.column_stack(by) if by else np.empty((len(self.times), 0))

    @property
    def contacts(self) -> List[str]:
        """Names of the contacts, as `contact` takes them."""
        return list(self._contacts)

    @property
    def differentiable(self) -> np.ndarray:
        """Per step, (steps,): whether each of its derivatives has one value. False of a step without a solution."""
        return np.array([step.get("differentiable", False) for step in self.document["steps"]], dtype=bool)

    def one_sided(self, response: str, parameter: str) -> np.ndarray:
        """A derivative from below and from above at each step, (steps, 2).

        If the two are one value, both columns have it. NaN where a side has no derivative, or it is not known, as in
        adjoint mode where nothing ties. KeyError if there is no such
        response or parameter.
        """
        _arguments.text(response, "response", "the name of a response")
        _arguments.text(parameter, "parameter", "the name of a parameter")
        if response not in self.sensitivities:
            raise _no_name("response", response, self.sensitivities)
        if parameter not in self.sensitivities[response]:
            raise _no_name("parameter", parameter, self.sensitivities[response])
        sides = np.repeat(self.sensitivities[response][parameter][:, np.newaxis], 2, axis=1)
        for number, step in enumerate(self.document["steps"]):
            if step.get("differentiable", True):
                continue
            given = step["one_sided"].get(response, {}).get(parameter, (None, None))
            sides[number] = [np.nan if side is None else side for side in given]
        return sides

    def displacement(self, step: int = -1, iterate: bool = False) -> np.ndarray:
        """Displacement of the nodes at the end of a step, (nodes, dimension).

        `iterate`: of a step without a solution the last iterate of Newton's method, which is no answer but may show why
        it failed. IndexError if there is no such step, ValueError if it has no solution or its state was let go
        (`sensitivity/memory`).
        """
        return self._kept(self._displacements[self._solved(step, iterate)])

    def displacement_derivative(self, parameter: str) -> np.ndarray:
        """Derivative of the displacement of the last step by a parameter, (nodes, dimension).

        KeyError if the scene has no such parameter, ValueError if the derivatives were not found.
        """
        _arguments.text(parameter, "parameter", "the name of a parameter")
        if parameter in self._displacement_derivatives:
            return self._displacement_derivatives[parameter]
        if any(parameter in of for of in self.sensitivities.values()):
            reason = self._left_out.get("derivatives") or self.message or 'adjoint mode has no derivatives of fields; use "mode": "direct"'
            raise ValueError(f"the derivatives were not found: {reason}")
        raise _no_name("parameter", parameter, self._displacement_derivatives)

    def contact(self, name: str, step: int = -1, iterate: bool = False) -> Arrays:
        """The points of a contact at the end of a step, by key. `iterate`: as of `displacement`.

        nodes : (points,), slave node of each, a row of `coordinates`
        state : (points,), 0 open, 1 stick, 2 slip
        pressure : (points,), force per area, positive in compression
        traction : (points, dimension), force per area on the slave, pressure and friction together
        tangent : (points, tangents, dimension), unit vectors along the contact; on a floor whose normal is +y that is -x
        shear : (points, tangents), the part of traction along the tangents; it opposes the slip
        gap : (points,), negative: penetration
        slip : (points, tangents), of the last increment, along the same tangents
        area : (points,), tributary area; a force is the sum of traction times area

        A result of `load_run` has `nodes` and `traction` alone.

        KeyError if there is no such contact, IndexError if there is no such step, ValueError if it has no
        solution.
        """
        _arguments.text(name, "name", "the name of a contact")
        if name not in self._contacts:
            raise _no_name("contact", name, self._contacts)
        return self._kept(self._contacts[name][self._solved(step, iterate)])

    def _kept(self, of_step: Any) -> Any:
        if of_step is None:
            raise ValueError(self._left_out.get("states", 'its state was let go: raise "memory" of "sensitivity", or ask '
                                                '"output" for its fields'))
        return of_step

    def _solved(self, step: Any, iterate: Any) -> int:
        number = _arguments.step(step, len(self.times))
        if self.failed_at is not None and number % len(self.times) == len(self.times) - 1 \
                and not _arguments.flag(iterate, "iterate"):
            before = f"step {len(self.times) - 2} is the last that has one" if len(self.times) > 1 else "no step has one"
            raise ValueError(f"there is no solution at t = {self.failed_at:g} ({self.status}): {before}; iterate=True "
                             f"gives the last iterate, which is none")
        return number

    def __repr__(self) -> str:
        end = f" to t = {self.times[-1]:g}" if len(self.times) else ""
        title = f" {self.title!r}" if self.title else ""
        return (f"<stickslip.Result{title} by {self.method}: {self.status}, {len(self.times)} steps{end}, "
                f"responses: {', '.join(self.responses) or 'none'}>")


class Gradcheck:
    """Every derivative of a scene, at every step, held against differences of the solver itself.

    Attributes
    ----------
    passed : bool
        Something was checked, and nothing differs or was left unchecked; bool() of the check too.
    status, message : str
        Of the run itself, as in Result.
    faults : str
        Why it did not pass; "" if it did.
    runs, rejected : int
        Runs for differences, and how many of them pass through other contact states somewhere, or fail: a run counts up
        to there.
    entries : list of dict
        One for each response and parameter, at the step where the error is largest: `response`, `parameter`, `time`,
        `computed` and `difference` (the derivative, by the method and by differences), `error` (the distance of the two
        over `scale`), `estimate` of the error of the difference itself and what is `allowed`, both over `scale` too,
        relative `step` of the parameter, `side` of the derivative ("both"; where they differ, "below" or "above"),
        how many `steps` there are, how many of them `unchecked`, as no difference gives three digits, the first
        `unchecked_at`, `verdict` ("agrees", "differs", "not checked": a step or more were not).
        pandas.DataFrame(check.entries) is a table of them.
    """

    def __init__(self, document: Dict[str, Any], table: str, faults: str):
        self.passed: bool = document["passed"]
        self.status: str = document["status"]
        self.message: str = document["message"]
        self.runs: int = document["runs"]
        self.rejected: int = document["rejected"]
        self.entries: List[Dict[str, Any]] = document["entries"]
        self.faults = faults
        self._table = table

    def __bool__(self) -> bool:
        return self.passed

    def __str__(self) -> str:
        """The table that the command prints."""
        return self._table + self.faults

    def __repr__(self) -> str:
        agree = sum(entry["verdict"] == "agrees" for entry in self.entries)
        return f"<stickslip.Gradcheck: {agree} of {len(self.entries)} derivatives agree, {self.runs} difference runs>"


def run(scene: Scene, method: Optional[str] = None, set: Mapping[str, Any] = {},
        folder: Union[str, "PathLike[str]", None] = None, check: bool = True) -> Result:
    """Simulates a scene.

    Parameters
    ----------
    scene
        Path of a scene file, or a dict of the same content; numpy's arrays and numbers may stand in it. Mesh files of a
        dict are looked for in the current folder.
    method
        "penalty", "uzawa_al" or "monolithic_al" in place of the scene's.
    set
        {JSON pointer: value}: values of the scene to be changed, as --set of the command.
    folder
        Where result.json and the fields (.vtu) are written; None: nowhere.
    check
        Raise NotConverged if the run failed. If False, the status of the result says so, and the step without a
        solution has NaN for its responses and derivatives; the steps before it have theirs.

    With {"sensitivity": {"mode": "adjoint"}} in the scene, derivatives are those of the objectives alone
    (`Result.gradient`), at a cost that does not grow with the number of parameters.

    Raises InputError with all faults of the scene, TypeError if an argument is of another type, OSError if the
    disk refuses. Other threads of Python run while it solves; Ctrl-C ends it after the step at hand.
    """
    check = _arguments.flag(check, "check")
    arguments = _scene_arguments(scene, method, set)
    result = Result(_stickslip.run(*arguments, None if folder is None else _arguments.path(folder, "folder")))
    if check and not result.converged:
        raise NotConverged(result)
    return result


def load_run(folder: Union[str, "PathLike[str]"]) -> Result:
    """The result of a run that wrote result.json and solution.json into a folder: by `run` with `folder`, or on the
    command line.

    Times, responses, derivatives, objectives, warnings and displacements are those of the run, to the last digit. A
    contact has `nodes` and `traction` alone. Derivatives of displacements are in the fields (.vtu), not here, and notes
    are not kept. Without solution.json there are neither coordinates nor displacements. A run that failed is returned
    with its status. Raises InputError if the folder has no result.
    """
    name = fsdecode(_arguments.path(folder, "folder"))
    text = _read(name, "result.json")
    if text is None:
        has_study = exists(join(name, "study.json"))
        _arguments.refuse(f"{name}: " + ("holds a study; load_study reads it" if has_study else "there is no result.json"))
    try:
        document, solution = json.loads(text), json.loads(_read(name, "solution.json") or "null")
        return Result(_state_of(document, solution, text))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        _arguments.refuse(f"{name}: result.json or solution.json is not as stickslip writes it: {error!r}")


def _read(folder: str, file: str) -> Optional[str]:
    try:
        with open(join(folder, file), encoding="utf-8") as content:
            return content.read()
    except FileNotFoundError:
        return None


def _state_of(document: Dict[str, Any], solution: Optional[Dict[str, Any]], text: str) -> Dict[str, Any]:
    """What a Result is made of, from the files of a run."""
    steps = document["steps"]
    times = np.array([step["time"] for step in steps])
    slopes = next((by for step in steps for by in step.get("sensitivities", {}).values()), {})
    parameters = document.get("parameters", dict.fromkeys(slopes, np.nan))  # 0.1.0 did not write their values
    order = document.get("parameter_order", list(parameters))
    names = list((steps[0].get("responses") or steps[0]["iterate"]["responses"]) if steps else [])

    def series(kind: str, *path: str) -> np.ndarray:
        values = []
        for step in steps:
            value: Any = step.get(kind, {})
            for key in path:
                value = (value or {}).get(key)
            values.append(value)
        return np.array(values, dtype=float)  # None is NaN

    failed = bool(steps) and "responses" not in steps[-1]
    nodes = np.array(solution["mesh"]["nodes"], dtype=float) if solution else np.empty((0, 0))
    increments = {of["time"]: of for of in solution["increments"]} if solution else {}
    states = [increments.get(time) for time in times]
    reason = document.get("solution", {}).get("left_out", "it is not there")
    return {
        "document": text, "notes": [], "times": times, "failed_at": float(times[-1]) if failed else None,
        "parameters": {name: parameters[name] for name in order},
        "responses": {name: series("responses", name) for name in names},
        "sensitivities": {name: {by: series("sensitivities", name, by) for by in order} for name in names},
        "coordinates": nodes,
        "elements": {name: np.array(body["elements"]) for name, body in solution["mesh"]["bodies"].items()}
        if solution else {},
        "displacements": [of and np.array(of["displacement"], dtype=float).reshape(nodes.shape) for of in states],
        "displacement_derivatives": {},
        "contacts": {name: [of and _points(of["contacts"][name], nodes.shape[1]) for of in states]
                     for name in (solution["mesh"]["contacts"] if solution else {})},
        "left_out": {"derivatives": "the folder has them as fields (.vtu) alone",
                     "states": "solution.json has no such state" if solution else f"there is no solution.json: {reason}"},
    }


def _points(contact: Dict[str, Any], dimension: int) -> Arrays:
    return {"nodes": np.array(contact["nodes"]), "traction": np.reshape(contact["traction"], (-1, dimension))}


def explain(scene: Scene, method: Optional[str] = None, set: Mapping[str, Any] = {}) -> str:
    """What would be simulated, and what would not, in words; nothing is solved. Arguments and faults as of `run`."""
    return _stickslip.explain(*_scene_arguments(scene, method, set))


def gradcheck(scene: Scene, method: Optional[str] = None, set: Mapping[str, Any] = {}) -> Gradcheck:
    """Holds every derivative of a scene against differences; print(gradcheck(scene)) is the command's table.

    Arguments and faults as of `run`; a scene without parameters or responses is an InputError. Ctrl-C ends it after the
    run at hand.
    """
    document, table, faults = _stickslip.gradcheck(*_scene_arguments(scene, method, set))
    return Gradcheck(json.loads(document), table, faults)


def _scene_arguments(scene: Any, method: Any, set: Any) -> tuple:
    return _arguments.scene(scene), _arguments.method(method), _arguments.overrides(set)


def _no_name(kind: str, name: Any, known: Mapping[str, Any]) -> KeyError:
    near = get_close_matches(str(name), known, n=1)
    nearest = f" did you mean {near[0]!r}?" if near else ""
    return KeyError(f"there is no {kind} {name!r};{nearest} there are: {', '.join(known) or 'none'}")
