#!/usr/bin/env python3
"""lessons_test.py SOURCE FOLDER: what the lessons of the page in FOLDER (the preset wasm) say is what the page shows, in
Chromium. Each marked answer and each number of a lesson's words is in a claim below; a claim has the words, the controls
to set, and a test of what the page has then. Exit code 77, which ctest counts as skipped, where there is no page or no
Chromium."""
import json
import math
import pathlib
import re
import sys

from page_test import check
from play_test import METHODS, WAIT, number, opened, visit

FOUND = WAIT + """
  const waiting = async (holds) => { while (!holds()) await pause(50); };
  const {given, derivative, sweep} = GIVEN;
  for (const [name, to] of Object.entries(given)) {
    const choice = document.querySelector(`[name="choice-${name}"][value="${to}"]`);
    choice ? choice.click() : slide(name, to);
  }
  if (derivative) document.querySelector('[name="shown"][value="derivative"]').click();
  await waiting(() => methods.every((method) => State.results[method]?.version === State.version));
  await waiting(() => State.reference.answer);
  if (derivative) await waiting(() => methods.every((method) => State.results[method].of === State.shown.parameter));
  if (sweep) {
    if (!State.scene.lesson.sweep && !State.sweep.length) click('#sweep');
    await waiting(() => !State.sweeping);
  }
  if (State.scene.lesson.beside) await waiting(() => State.beside);
  await pause(200);
  const of = (method, found) => [method, found(State.results[method].answer)];
  const each = (found) => Object.fromEntries(methods.map((method) => of(method, found)));
  return {
    document: State.results.monolithic_al.answer.document,
    columns: columns(),
    sides: Object.fromEntries(methods.map((method) => [method, all(
        `.column[data-method="${method}"] dd[data-value="value"]`).map((place) => place.textContent)])),
    status: Object.fromEntries(methods.map((method) => [method, document.querySelector(
        `.column[data-method="${method}"] .status`).textContent])),
    messages: document.getElementById('messages').textContent,
    arrows: all('#arrow .slope').length,
    steps: each((answer) => answer.result.steps.map(({time, responses, sensitivities, contacts}) => (
        {time, responses, sensitivities, contacts: contacts && Object.values(contacts)[0]}))),
    states: each((answer) => (answer.picture.frames?.at(-1) ?? answer.picture).contact.map((point) => point.state)),
    pressures: each((answer) => answer.picture.contact.map((point) => -point.normal)),
    sweep: State.sweep.map(({method, power, answer}) => ({method, power, ...Answers.point_of(method, answer)})),
    power: State.scene.knob,
    lame: State.scene.lesson.exact === 'lame' ? Answers.lame(State.results.monolithic_al.answer.document) : null,
    beside: State.beside?.answer.result.steps.map((step) => step.responses?.x),
  };
"""


class Page:
    """What the page has with some controls set."""

    def __init__(self, found):
        self.__dict__.update(found)

    def shows(self, method, name="value"):
        return number(self.columns[method][name])

    def end(self, method="monolithic_al"):
        return self.steps[method][-1]

    def series(self, name, method="monolithic_al"):
        return [step["responses"][name] for step in self.steps[method] if step["responses"]]

    def ran(self, method):
        return self.status[method].startswith("converged")

    def work(self, method, power):
        return next(run["x"] for run in self.sweep if run["method"] == method and run["power"] == power)

    def cheapest(self, method, error):
        return min(run["x"] for run in self.sweep if run["method"] == method and run["error"] <= error)


def near(value, right, digits=None):
    """Whether a value is that of the words, rounded as they are."""
    if digits is not None:
        return round(value, digits) == right
    return math.isclose(value, right, rel_tol=1e-6, abs_tol=1e-12)


def of_all(holds):
    return all(holds(method) for method in METHODS)


def changes(series):
    return [b - a for a, b in zip(series, series[1:])]


def slopes(page):
    press, place = page.series("press"), page.series("pushed")
    return [dp / dx for dp, dx in zip(changes(press), changes(place))]


# By lesson: (words, controls, more, what holds then). Controls are those of the page by name; of choices, their number.
CLAIMS = {
    "stiff": [
        ("force of 15", {}, lambda p: p.document["loads"][0]["force"][0] == 15),
        ("the wall takes 5", {}, lambda p: near(p.shows("monolithic_al"), 5)),
        ("from 1 to 10¹⁸", {"knob": 18}, lambda p: "inaccurate" in p.status["penalty"] and p.shows("monolithic_al") == 5),
        ("The mass enters the wall", {"knob": 0}, lambda p: p.series("u", "penalty")[-1] > 0.011),
        ("the error falls as 1 / stiffness", {"knob": 4}, lambda p: 0.9e-4 < p.shows("penalty", "error") < 1.1e-4),
        ("the error falls as 1 / stiffness", {"knob": 5}, lambda p: 0.9e-5 < p.shows("penalty", "error") < 1.1e-5),
        ("It is least near 10⁸, about 2·10⁻⁸", {"knob": 8},
         lambda p: near(p.shows("penalty", "error") * 1e8, 2, 0) and p.shows("penalty", "error") <=
         1.05 * min(run["error"] for run in p.sweep if run["method"] == "penalty")),
        ("It falls, stops, and then grows", {"knob": 12}, lambda p: p.ran("penalty") and p.shows("penalty", "error") > 1e-5),
        ("From 10¹³ on the method reports that it is inaccurate", {"knob": 13},
         lambda p: p.status["penalty"] == p.status["uzawa_al"] == "inaccurate" and not [
             run for run in p.sweep if run["method"] == "penalty" and run["power"] > 12]),
        ("stays exact", {"knob": 13}, lambda p: p.shows("monolithic_al", "error") < 1e-12),
    ],
    "updates": [
        ("At scale 10", {}, lambda p: p.power == 1),
        ("10 times as stiff", {}, lambda p: near(p.shows("penalty", "error"), 0.091, 3)),
        ("k / (k + 10 k) = 1/11", {}, lambda p: near(p.end("penalty")["responses"]["press"], 5 * (1 - 1 / 11))),
        ("0.091, is 1/11", {}, lambda p: near(p.shows("penalty", "error"), 0.091, 3)),
        ("eleven updates would make 11⁻¹¹ = 3.5·10⁻¹²", {}, lambda p: near(11.0 ** -11, 3.5e-12, 13)),
        ("by 11", {}, lambda p: near(1 - p.end("penalty")["responses"]["press"] / 5, 1 / 11)),
        ("raises a scale below 100 by itself", {}, lambda p: p.shows("uzawa_al", "factorizations") > 2),
        ("The method takes eight", {}, lambda p: p.shows("uzawa_al", "augmentations") == 8),
        ("100 needs six updates", {"knob": 2}, lambda p: p.shows("uzawa_al", "augmentations") == 6),
        ("1 needs nine", {"knob": 0}, lambda p: p.shows("uzawa_al", "augmentations") == 9),
        ("a new factorisation if the scale has changed", {"knob": 0},
         lambda p: p.shows("uzawa_al", "factorizations") > 2),
        ("An update costs a back-solve", {"knob": 2}, lambda p: p.shows("uzawa_al", "factorizations") == 2),
    ],
    "newton": [
        ("eleven contact points", {}, lambda p: len(p.states["penalty"]) == 11),
        ("At scale 1", {}, lambda p: p.power == 0),
        ("Uzawa", {}, lambda p: p.shows("uzawa_al", "newton") > 2 * max(p.shows(m, "newton") for m in ("penalty", "monolithic_al"))),
        ("38 iterations here", {}, lambda p: p.shows("uzawa_al", "newton") == 38),
        ("needs 11, about as many as the penalty with 10", {},
         lambda p: p.shows("monolithic_al", "newton") == 11 and p.shows("penalty", "newton") == 10),
        ("exact up to rounding at every scale", {"knob": -2}, lambda p: p.shows("monolithic_al", "error") < 1e-11),
        ("exact up to rounding at every scale", {"knob": 6}, lambda p: p.shows("monolithic_al", "error") < 1e-11),
        ("The penalty's error is 0.025", {}, lambda p: near(p.shows("penalty", "error"), 0.025, 3)),
    ],
    "loop": [
        ("goes to 0.1, to −0.1, and to 0.1 again", {},
         lambda p: [row[1] for row in p.document["supports"][0]["move"]["x"]] == [0, 0.1, -0.1, 0.1]),
        ("The floor holds 3, and the spring pulls with 3 if it is stretched by 0.03", {},
         lambda p: near(-p.end()["responses"]["friction"], 3) and near(0.1 - p.end()["responses"]["u"], 0.03)),
        ("by 0.03 behind, in both directions", {}, lambda p: near(min(p.series("u")), -0.07)),
        ("at 0.07", {}, lambda p: near(p.shows("monolithic_al"), 0.07)),
        ("Its area, 0.84", {}, lambda p: near(p.series("heat")[-1] - p.series("heat")[11], 0.84)),
        ("heat is 1.05, since the first way out takes another 0.21", {},
         lambda p: near(p.series("heat")[-1], 1.05) and near(p.series("heat")[11], 0.21)),
        ("with a way below 0.03 the block never moves", {"anchor": 0.025}, lambda p: max(map(abs, p.series("u"))) < 1e-12),
        ("−0.1 on the way out, +0.1 on the way back, and −0.1 at the end", {}, lambda p: all(
            near(p.steps["monolithic_al"][i]["sensitivities"]["u"]["mu"], right)
            for i, right in ((11, -0.1), (35, 0.1), (59, -0.1)))),
    ],
    "cylinders": [
        ("half of what friction can hold", {},
         lambda p: near(p.end()["responses"]["pull"] / p.end()["responses"]["press"] / p.document["contacts"]["touch"]["friction"], 0.5, 2)),
        ("those at the rim", {}, lambda p: re.fullmatch("o+s+t+s+o+", "".join(
            {"open": "o", "slip": "s", "stick": "t"}[state] for state in p.states["monolithic_al"]))),
        ("from a way of 0.012 on", {"load": 0.012}, lambda p: "slip" in p.states["monolithic_al"]),
        ("from a way of 0.012 on", {"load": 0.011}, lambda p: "slip" not in p.states["monolithic_al"]),
        ("from 0.07 on all slides", {"load": 0.07}, lambda p: "stick" not in p.states["monolithic_al"]),
        ("from 0.07 on all slides", {"load": 0.068}, lambda p: "stick" in p.states["monolithic_al"]),
        ("at step 2 there is no shear yet", {}, lambda p: abs(p.series("pull")[1]) < 1e-3 * p.series("press")[1]),
    ],
    "kink": [
        ("exactly 10", {}, lambda p: p.document["loads"][0]["force"][0] == 10),
        ("With less than 10 the mass is free and the wall takes nothing: the derivative is 0", {},
         lambda p: of_all(lambda m: number(p.sides[m][0]) == 0)),
        ("With more than 10 the wall takes all that is added: it is 1", {}, lambda p: near(number(p.sides["monolithic_al"][1]), 1)),
        ("It depends on the sign of the change.", {}, lambda p: of_all(lambda m: len(p.sides[m]) == 2)),
        ("0.999", {}, lambda p: near(number(p.sides["penalty"][1]), 0.999, 3)),
        ("The two arrows", {}, lambda p: p.arrows == 2),
        ("The difference of these two runs says 1/2", {}, lambda p: near(p.shows("monolithic_al", "difference"), 0.5)),
        ("Move the force off 10, and one arrow remains", {"load": 10.5}, lambda p: p.arrows == 1),
    ],
    "corners": [
        ("from 0.0031 to 0.0066 in one step", {}, lambda p: any(
            near(a, 0.0031, 4) and near(b, 0.0066, 4) for a, b in zip(p.series("x"), p.series("x")[1:]))),
        ("The force jumps where a point passes a corner.", {"steps": 24}, lambda p: max(map(abs, changes(p.series("x")[2:]))) > 0.003),
        ("Take 24 steps: its steps get shorter, and the jump stays", {"steps": 24}, lambda p: max(map(abs, changes(p.beside[2:]))) < 0.001),
        ("The iterations are nearly the same", {"surface": 0, "steps": 12}, lambda p: 70 < p.shows("monolithic_al", "newton") < 86),
        ("The iterations are nearly the same", {"surface": 1, "steps": 12}, lambda p: 70 < p.shows("monolithic_al", "newton") < 86),
        ("friction to 0.3 with 24 steps: all three methods give up", {"friction": 0.3, "steps": 24, "surface": 1},
         lambda p: of_all(lambda m: not p.ran(m))),
        ("On the smooth surface all three go on", {"friction": 0.3, "steps": 24, "surface": 0}, lambda p: of_all(p.ran)),
    ],
    "klarbring": [
        ("very high friction, 3", {}, lambda p: p.document["contacts"]["c"]["friction"] == 3),
        ("force of 2.5", {}, lambda p: p.document["loads"][0]["force"][0] == 2.5),
        ("stick at 0, slip to 1, or leave the wall and rest at 2.67", {},
         lambda p: "Monolithic: This is one of several solutions: 0 (sticks). Others: 2.667 (open); 1 (slips)." in p.messages),
        ("three", {}, lambda p: p.messages.count("several solutions") == 3),
        ("Set the scale to 1: the penalty's soft wall lets the point go, to 2.67, and the other two stick", {"knob": 0},
         lambda p: near(p.shows("penalty"), 2.67, 2) and "Uzawa" in p.messages and abs(p.shows("uzawa_al")) < 1e-9 and
         p.shows("monolithic_al") == 0),
        ("With a friction below 2.5 the point cannot stick at this force, and one solution is left", {"knob": -4, "friction": 2.4},
         lambda p: of_all(lambda m: near(p.shows(m), 2.67, 2)) and not p.messages),
    ],
    "held": [
        ("pressed down by 4, so friction can hold 1.2", {},
         lambda p: near(p.end()["responses"]["press"], 4) and p.document["contacts"]["sole"]["friction"] == 0.3),
        ("pushed by 0.8", {}, lambda p: near(p.shows("monolithic_al"), -0.8)),
        ("At 0.8 five of nine points slip already", {}, lambda p: of_all(
            lambda m: p.states[m].count("slip") == 5 and p.states[m].count("stick") == 4)),
        ("Up to a push of 1.2", {"load": 1.2}, lambda p: of_all(lambda m: near(p.shows(m), -1.2))),
        ("if you push by 1.4", {"load": 1.4}, lambda p: of_all(lambda m: p.status[m] == "no equilibrium")),
        ("There is no answer: nothing balances the push.", {"load": 1.22}, lambda p: of_all(lambda m: p.status[m] == "no equilibrium")),
        ("Set it to 1.4", {"load": 1.4}, lambda p: p.messages.count("Penalty, Uzawa, Monolithic:") == 1),
    ],
    "accuracy": [
        ("10⁻² first, and then 10⁻⁶", {}, lambda p: p.cheapest("penalty", 1e-2) < p.cheapest("monolithic_al", 1e-2) and
         p.cheapest("penalty", 1e-6) > p.cheapest("monolithic_al", 1e-6)),
        ("It depends on the accuracy asked.", {}, lambda p: p.cheapest("penalty", 1e-2) < p.cheapest("uzawa_al", 1e-2) and
         p.cheapest("penalty", 1e-6) > p.cheapest("uzawa_al", 1e-6)),
        ("a stiffness of 1 does, with work 5.3", {},
         lambda p: near(p.work("penalty", 0), 5.3, 1) and near(p.cheapest("penalty", 1e-2), 5.3, 1)),
        ("needs 10⁵, and work 7.5", {}, lambda p: near(p.work("penalty", 5), 7.5, 1) and near(p.cheapest("penalty", 1e-6), 7.5, 1)),
        ("take 6.7 for both", {}, lambda p: near(p.cheapest("uzawa_al", 1e-6), 6.7, 1) and near(p.cheapest("monolithic_al", 1e-6), 6.7, 1)),
        ("one back-solve apart", {}, lambda p: near(p.cheapest("monolithic_al", 1e-6) - p.cheapest("uzawa_al", 1e-6), 1 / 30)),
        ("100, and takes 11.1 at scale 1", {}, lambda p: near(p.work("uzawa_al", 2), 6.7, 1) and near(p.work("uzawa_al", 0), 11.1, 1)),
        ("takes 6.7 to 6.8 at every scale from 0.01 to 10⁴", {},
         lambda p: all(6.65 <= p.work("monolithic_al", power) <= 6.85 for power in range(-2, 5))),
    ],
    "belt": [
        ("Friction is 0.3. Its slack end is pulled by 1, and it holds 2.6", {}, lambda p: near(-p.shows("monolithic_al"), 2.6, 1)),
        ("Set the friction to 0.6: it holds 6.81", {"friction": 0.6}, lambda p: of_all(lambda m: near(-p.shows(m), 6.81, 2))),
        ("about 6.8", {"friction": 0.6}, lambda p: near(-p.shows("monolithic_al"), 6.8, 1)),
        ("exp(0.3 π) = 2.566 at 0.3", {}, lambda p: near(math.exp(0.3 * math.pi), 2.566, 3)),
        ("eight corners", {}, lambda p: len(p.states["penalty"]) == 8),
        ("the result is 2.601", {"friction": 0.3}, lambda p: of_all(lambda m: near(p.shows(m), -2.601, 3))),
        ("from −8.3 to −22", {}, lambda p: near(p.end()["sensitivities"]["tight"]["mu"], -8.3, 1)),
        ("from −8.3 to −22", {"friction": 0.6}, lambda p: near(p.end()["sensitivities"]["tight"]["mu"], -22, 0)),
    ],
    "mesh": [
        ("too large by 0.01", {}, lambda p: p.document["contacts"]["fit"]["offset"] == -0.01),
        ("a pressure of 1.648", {}, lambda p: near(p.lame, 1.648, 3)),
        ("agree on 1.540", {}, lambda p: of_all(lambda m: near(p.shows(m), 1.54, 3))),
        ("the formula: the mesh is not the ring", {}, lambda p: p.shows("monolithic_al", "error") < 1e-12),
        ("25 straight facets", {}, lambda p: p.document["bodies"]["inner"]["mesh"]["ring"]["cells"][1] == 25),
        ("33 nodes", {}, lambda p: len(p.states["penalty"]) == 33),
        ("6.6 % too small", {}, lambda p: of_all(lambda m: p.columns[m]["exact"] == "−6.6\u00a0%")),
        ("up to 4.3", {}, lambda p: near(max(p.pressures["monolithic_al"]), 4.3, 1)),
        ("Choose 32 facets: the nodes meet, and the pressure is 1.650", {"facets": 1}, lambda p: of_all(lambda m: near(p.shows(m), 1.65, 3))),
    ],
    "metal": [
        ("a fifth of the way", {}, lambda p: near(1 - p.series("pushed")[-1] / max(p.series("pushed")), 0.2)),
        ("It rises with slope 1000, then with slope 91", {}, lambda p: near(slopes(p)[1], 1000) and near(slopes(p)[6], 91, 0)),
        ("falls with slope 1000", {}, lambda p: near(slopes(p)[-1], 1000)),
        ("on a line parallel to the first, elastic part", {}, lambda p: near(slopes(p)[-1], slopes(p)[1])),
        ("It touched the wall at 0.005", {}, lambda p: p.document["obstacles"]["wall"]["plane"]["point"][0] == 1.005),
        ("to 0.02: it leaves the wall at 0.023 already", {"back": 0.02}, lambda p: p.series("press")[-1] == 0 and near(
            p.series("pushed")[-2] - p.series("press")[-2] / 1000, 0.023, 3)),
        ("it is 0 while the bar is elastic, 0.909 once it flows, and 0.909 still on the way back", {"back": 0.028}, lambda p: [round(
            p.steps["monolithic_al"][i]["sensitivities"]["press"]["yield"], 3) for i in (2, 9, 13)] == [0, 0.909, 0.909]),
    ],
}
SWEPT = ("stiff", "accuracy")


def uncovered(text, fragments):
    """Numbers of a text that no claim has."""
    covered = set()
    for fragment in fragments:
        for at in re.finditer(re.escape(fragment), text):
            covered.update(range(*at.span()))
    return [(at.group(), text[max(0, at.start() - 30):at.end() + 10]) for at in re.finditer(r"\d[\d.]*\d|\d", text)
            if at.start() not in covered]


def check_lesson(browser, lesson, words):
    name = lesson["id"]
    parts = [words[f"{name}.question"], words[f"{name}.see"], words[f"{name}.{lesson['right']}"]]
    claims = CLAIMS[name]
    for fragment, _, _ in claims:
        check(f"{name}: the words of a claim", any(fragment in part for part in parts), fragment)
    check(f"{name}: numbers without a claim", not (bare := uncovered(" ".join(parts), [claim[0] for claim in claims])), bare)
    check(f"{name}: the marked answer has no claim", any(claim[0].rstrip(".") in parts[2] for claim in claims), parts[2])
    visit(browser, f"#lesson={name}&predicted={lesson['right']}")
    before, page = None, None
    for fragment, given, holds in claims:
        if given != before:
            if given == {} and before is not None:
                visit(browser, f"#lesson={name}&predicted={lesson['right']}")
            asked = {"given": given, "derivative": lesson.get("shown") == "derivative", "sweep": name in SWEPT}
            page, before = Page(browser.run(FOUND.replace("GIVEN", json.dumps(asked)))), given
        check(f"{name}: {fragment}", holds(page), {key: getattr(page, key) for key in ("columns", "status", "messages", "sides")})
    print(f"{name}: {len(claims)} claims hold", flush=True)


def main():
    source, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    words = json.loads((source / "studies/web/words.en.json").read_text())
    with opened(folder) as (browser, _):
        for lesson in json.loads((source / "studies/web/lessons.json").read_text()):
            if f"{lesson['id']}.question" in words and (len(sys.argv) < 4 or lesson["id"] in sys.argv[3:]):
                check_lesson(browser, lesson, words)


if __name__ == "__main__":
    main()
