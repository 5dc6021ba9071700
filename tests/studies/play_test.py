#!/usr/bin/env python3
"""play_test.py STICKSLIP SOURCE FOLDER [--times]: the page in FOLDER (the preset wasm) as a learner uses it, in Chromium,
offline: sliders, a prediction, derivatives, a scene with a fault, a run that is stopped, a link, a phone, dark, paper.
The numbers on the page are those of the program. --times prints how fast the page answers; --picture FILE writes the
picture of docs/play.md. Exit code 77, which ctest counts as skipped, where there is no page or no Chromium."""
import base64
import contextlib
import json
import math
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

from page_test import BROWSERS, SKIPPED, Browser, check

METHODS = ("penalty", "uzawa_al", "monolithic_al")
WAIT = """
  const value = (method, name) => document.querySelector(`.column[data-method="${method}"] dd[data-value="${name}"]`)?.textContent;
  const methods = ['penalty', 'uzawa_al', 'monolithic_al'];
  const settled = () => until(() => methods.every((method) => value(method, 'error') && value(method, 'error') !== '…'));
  const columns = () => Object.fromEntries(methods.map((method) => [method, Object.fromEntries(all(
      `.column[data-method="${method}"] dd`).map((place) => [place.dataset.value, place.textContent]))]));
  const slide = (name, to) => {
    const input = document.getElementById('control-' + name);
    input.value = to;
    input.dispatchEvent(new Event('input', {bubbles: true}));
  };
  const commands = async () => { await pause(900); return document.getElementById('commands').textContent.split('\\n'); };
  const click = (selector) => document.querySelector(selector).click();
"""
SLIDE = WAIT + """
  await settled();
  const before = value('penalty', 'value');
  slide('friction', 0.45);
  slide('load', 12);
  slide('knob', 3);
  const changed = await until(() => value('penalty', 'value') !== before);
  await pause(700);
  await settled();
  return {changed, columns: columns(), commands: await commands(), live: document.getElementById('live').textContent};
"""
PREDICT = WAIT + """
  await until(() => methods.every((method) => value(method, 'error')));
  const hidden = getComputedStyle(document.querySelector('.column dl')).visibility;
  const waits = document.querySelector('#prediction .show').disabled, still = document.getElementById('controls').inert;
  all('#prediction input')[0].click();
  click('#prediction .show');
  await settled();
  await pause(900);
  return {hidden, waits, seen: getComputedStyle(document.querySelector('.column dl')).visibility, still,
          words: document.getElementById('see').textContent, focus: document.activeElement.id, hash: location.hash,
          moves: !document.getElementById('controls').inert};
"""
LESSON = WAIT + """
  await until(() => methods.every((method) => value(method, 'error')));
  document.querySelector('.skip-prediction')?.click();
  await settled();
  const values = Object.fromEntries(methods.map((method) => [method, all(
      `.column[data-method="${method}"] dd[data-value="value"]`).map((place) => place.textContent)]));
  return {columns: columns(), values, commands: await commands(), response: document.getElementById('response').value,
          parameter: document.querySelector('[name="shown"]:checked').value === 'derivative' ? document.getElementById('parameter').value : null,
          drawn: Boolean(document.querySelector('#picture svg')), charted: await until(() => document.querySelector('#chart svg'))};
"""
SWEEP = WAIT + """
  await settled();
  document.querySelector('.skip-prediction')?.click();
  click('#sweep');
  await until(() => document.getElementById('sweep').textContent.startsWith('Sweeping'));
  await until(() => document.getElementById('sweep').textContent === 'Sweep the stiffness');
  const asked = async (power) => {
    const input = document.getElementById('accuracy');
    input.value = power;
    input.dispatchEvent(new Event('input', {bubbles: true}));
    await pause(400);
    return document.getElementById('verdict').textContent;
  };
  return {coarse: await asked(-2), fine: await asked(-6), points: all('#chart g.mark-symbol path').length};
"""
KEPT = WAIT + """
  await settled();
  return document.getElementById('see').textContent;
"""
NEXT = WAIT + """
  const lesson = () => document.getElementById('lesson').value;
  await settled();
  await pause(900);  // a page that is still being loaded would take the next lesson's address for its own
  click('.next');
  await until(() => lesson() === 'cylinders');
  const next = lesson();
  await until(() => location.hash.includes('response='));  // once the page has written its address, nothing ends the way back
  history.back();
  await until(() => lesson() === 'loop');
  return {next, back: lesson(), words: !document.getElementById('see').hidden};
"""
AT_STEP = WAIT + """
  await settled();
  const input = document.getElementById('step');
  input.value = 36;  // t = 2: the anchor is at -0.1
  input.dispatchEvent(new Event('input', {bubbles: true}));
  await pause(300);
  const handle = document.querySelector('.handle[data-control="anchor"]'), at = seen(handle.querySelector('.grip'));
  const point = (type, x) => new PointerEvent(type, {clientX: x, clientY: at.top + 5, bubbles: true});
  handle.dispatchEvent(point('pointerdown', at.left + 5));
  dispatchEvent(point('pointermove', at.left + 45));
  dispatchEvent(point('pointerup', at.left + 45));
  return {dragged: document.getElementById('control-anchor').value};
"""
TICKS = WAIT + """
  await settled();
  await until(() => document.querySelector('#chart svg'));
  await pause(500);
  const ticks = all('#chart .role-axis').map((axis) => all('.role-axis-label text', axis).map((one) => one.textContent));
  return {ticks, legend: all('#chart .role-legend text').map((one) => one.textContent),
          keys: document.getElementById('legend').textContent, meaning: document.getElementById('meaning').textContent,
          bar: Boolean(document.querySelector('#picture .scale'))};
"""
TIP = WAIT + """
  await settled();
  await until(() => document.querySelector('#chart g.mark-symbol path'));
  const at = seen(all('#chart g.mark-symbol path').at(-1));
  return {x: at.left + at.width / 2, y: at.top + at.height / 2};
"""
PAPER = WAIT + """
  await settled();
  await until(() => document.querySelector('#chart svg'));
  await pause(500);
"""
DERIVATIVE = WAIT + """
  await settled();
  click('[name="shown"][value="derivative"]');
  await until(() => methods.every((method) => value(method, 'difference') && value(method, 'difference') !== '…'));
  await until(() => document.querySelector('#arrow .slope'));
  return {columns: columns(), arrow: document.getElementById('arrow').textContent, commands: await commands()};
"""
DRAG = WAIT + """
  await settled();
  const handle = () => document.querySelector('.handle[data-control="anchor"]'), at = seen(handle().querySelector('.grip'));
  const point = (type, x) => new PointerEvent(type, {clientX: x, clientY: at.top + 5, bubbles: true});
  const before = document.getElementById('control-anchor').value;
  handle().dispatchEvent(point('pointerdown', at.left + 5));
  dispatchEvent(point('pointermove', at.left + 45));
  dispatchEvent(point('pointerup', at.left + 45));
  const dragged = document.getElementById('control-anchor').value;
  handle().focus();
  handle().dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true}));
  await pause(300);
  return {before, dragged, keyed: document.getElementById('control-anchor').value, label: handle().getAttribute('aria-label'),
          focus: document.activeElement === handle()};
"""
EDIT = WAIT + """
  await settled();
  click('#open-editor');
  await pause(100);
  const text = document.getElementById('text'), whole = text.value, faults = () => document.getElementById('faults').textContent;
  const type = (words) => { text.value = words; text.dispatchEvent(new Event('input', {bubbles: true})); };
  type(whole.replace('"friction": 0.3', '"fricton": 0.3'));
  await until(() => faults().includes('fricton'));
  const told = faults(), off = document.getElementById('run').disabled;
  document.querySelector('button.fault').click();
  const at = text.value.slice(text.selectionStart, text.selectionStart + 9);
  type(whole.replace('"friction": 0.3', '"friction": 0.2'));
  await until(() => !document.getElementById('run').disabled);
  const former = document.querySelector('#chart svg');
  click('#run');
  await until(() => document.getElementById('lesson').value === '');
  const cleared = !former.isConnected;
  await settled();
  await pause(900);
  return {told, off, at, cleared, focus: document.activeElement.id, columns: columns(), hash: location.hash.length, commands: await commands()};
"""
TOO_LARGE = WAIT + """
  await settled();
  const text = document.getElementById('text');
  click('#open-editor');
  text.value = text.value.replace('"cells": [32, 32]', '"cells": [300, 300]');
  text.dispatchEvent(new Event('input', {bubbles: true}));
  await until(() => document.getElementById('faults').textContent.includes('more than a browser'));
  return {words: document.getElementById('faults').textContent, off: document.getElementById('run').disabled};
"""
CANCEL = WAIT + """
  await until(() => document.querySelector('.column .stop:not([hidden])'));
  const words = all('.column .progress').map((place) => place.textContent).join('');
  let ticks = 0;
  const timer = setInterval(() => ++ticks, 20);
  await pause(1200);
  clearInterval(timer);
  for (const button of all('.column .stop:not([hidden])')) button.click();
  const stopped = await until(() => all('.column .status').some((place) => place.textContent === 'stopped'));
  return {words, ticks, stopped, later: document.getElementById('messages').textContent};
"""
FORM = WAIT + """
  await settled();
  const drawing = await until(() => document.querySelector('#chart svg'));
  await pause(300);
  return {gap: seen(document.getElementById('chart')).top - seen(document.getElementById('controls')).bottom, chart: drawing, beyond: document.documentElement.scrollWidth - innerWidth, high: document.documentElement.scrollHeight,
          first: document.querySelector('#terminal').getBoundingClientRect().top, ink: getComputedStyle(document.body).color,
          marks: all('#chart g.mark-symbol path').length};
"""
SETTLED = WAIT + """
  await settled();
  return {lesson: document.getElementById('lesson').value, commands: await commands(), columns: columns(),
          told: document.getElementById('faults').textContent, elements: all('#picture .elements').length,
          arrows: all('#picture .traction').length};
"""
SKIP = WAIT + """
  await settled();
  slide('friction', 0.45);
  click('.skip');
  await pause(300);
  return {commands: await commands(), focus: document.activeElement.id};
"""
QUICK = WAIT + """
  await settled();
  await pause(500);
  const times = [];
  const [from, to] = [Number(document.getElementById('control-load').min), Number(document.getElementById('control-load').max)];
  for (let i = 0; i < 12; ++i) {
    const before = document.querySelector('#picture svg');
    const start = performance.now();
    slide('load', from + (to - from) * (0.4 + 0.02 * i));
    await new Promise((done) => {
      const look = () => document.querySelector('#picture svg') !== before ? done() : requestAnimationFrame(look);
      look();
    });
    times.push(performance.now() - start);
    await pause(250);
  }
  return times.sort((a, b) => a - b);
"""
PICTURE = WAIT + """
  await until(() => methods.every((method) => value(method, 'error')));
  click('.skip-prediction');
  slide('load', 0.04);
  await pause(2000);
  await settled();
"""
FIRST = WAIT + "await until(() => methods.some((method) => value(method, 'value'))); return performance.now();"


def number(text):
    """A number as the page writes it: 2.8·10⁻¹⁵ of 2.8e-15."""
    plain = text.replace("−", "-").translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-"))
    if "10" in plain and ("·10" in plain or any(c in text for c in "⁰¹²³⁴⁵⁶⁷⁸⁹")):
        factor, power = plain.rsplit("10", 1)
        factor = factor.rstrip("·")
        return float({"": "1", "-": "-1"}.get(factor, factor)) * 10 ** int(power)
    return float(plain)


def by_program(program, source, command):
    """What a command of the page gives in a terminal."""
    done = subprocess.run([program, *shlex.split(command)[1:], "--json"], capture_output=True, text=True, cwd=source)
    return json.loads(done.stdout)


def check_values(name, program, source, found, response, parameter=None, same_counts=False):
    """The columns hold what the commands below them compute. Counts are the same on lumped scenes; on others rounding of
    another linear solver takes or saves some where a tolerance is just met."""
    for method, command in zip(METHODS, found["commands"]):
        result = by_program(program, source, command)
        step, column = result["steps"][-1], found["columns"][method]
        right = step["sensitivities"][response][parameter] if parameter else step["responses"][response]
        check(f"{name}: {method}", math.isclose(number(column["value"]), right, rel_tol=2e-6, abs_tol=1e-12), [column, right, command])
        counts = result["cost"]["counts"]
        if same_counts:
            check(f"{name}: {method}, counts", [number(column["newton"]), number(column["factorizations"])] ==
                  [counts["newton"], counts["factorizations"]], [column, counts])


def visit(browser, address, width=1280, height=720, scheme="light"):
    browser.ask("Page.navigate", url="about:blank")
    home, browser.page = browser.page, browser.page + address
    browser.open(width, scheme)
    browser.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
    browser.page = home


def check_page(browser, program, source):
    visit(browser, "")
    found = browser.run(SLIDE)
    check("sliders", found["changed"] and "Monolithic: pull 5.4" in found["live"], found)
    check("sliders: commands", all("--set /contacts/sole/friction=0.45" in line for line in found["commands"]), found)
    check_values("sliders", program, source, found, "pull", same_counts=True)
    found = browser.run(DERIVATIVE)
    check_values("derivative", program, source, found, "pull", "mu")
    for column in found["columns"].values():
        check("two runs", math.isclose(number(column["value"]), number(column["difference"]), rel_tol=1e-4), column)
    check("arrow", "A little more mu" in found["arrow"], found["arrow"])
    visit(browser, "")
    found = browser.run(DRAG)
    check("drag", float(found["dragged"]) > float(found["before"]) > 0 and found["focus"] and
          math.isclose(float(found["keyed"]), float(found["dragged"]) - 0.005), found)
    visit(browser, "#lesson=loop")
    found = browser.run(PREDICT)
    check("prediction", found["hidden"] == "hidden" and found["waits"] and found["seen"] == "visible" and
          found["words"].startswith("You said: at 0.1, where the anchor is. The answer: at 0.07."), found)
    check("controls wait for the prediction", found["still"] and found["moves"] and found["focus"] == "see", found)
    visit(browser, found["hash"])
    check("a link keeps the prediction", browser.run(KEPT).startswith("You said: at 0.1"), found["hash"])
    found = browser.run(NEXT)
    check("the next lesson, and back", found["next"] == "cylinders" and found["back"] == "loop" and found["words"], found)
    visit(browser, "#lesson=loop&predicted=1")
    found = browser.run(AT_STEP)
    check("a knob follows the pointer at a step that goes back", float(found["dragged"]) < 0.1, found)
    visit(browser, "")
    found = browser.run(EDIT)
    check("a fault", "scene.json:20:67: /contacts/sole/fricton: unknown key" in found["told"] and found["off"] and
          found["at"].startswith("\""), found)
    check("a run of the editor", found["cleared"] and found["focus"] == "scene-title", found)
    check("a scene of one's own", found["hash"] > 300 and all("scene.json" in line for line in found["commands"]), found)
    found["commands"] = [f"stickslip run studies/scenes/slider.json -m {method} --set /contacts/sole/friction=0.2"
                         for method in METHODS]
    check_values("a scene of one's own", program, source, found, "friction")
    visit(browser, "#file=studies/scenes/greco_plate.json")
    found = browser.run(TOO_LARGE)
    check("too large", found["off"] and "stickslip run scene.json" in found["words"], found)
    visit(browser, "#file=studies/scenes/pinched_tube.json")
    found = browser.run(CANCEL)
    check("stop", found["stopped"] and found["ticks"] > 20 and ("Step" in found["words"] or "Solving" in found["words"]), found)
    visit(browser, "#lesson=play&c.friction=0.5&knob=2&shown=derivative&by=mu&drawn=penalty")
    found = browser.run(DERIVATIVE)
    check("link", all("friction=0.5" in line for line in found["commands"]) and "stiffness=100" in found["commands"][0], found)


def check_lessons(browser, program, source):
    """Each lesson has three answers, a picture and a chart, and its commands give its numbers."""
    for lesson in json.loads((source / "studies/web/lessons.json").read_text()):
        visit(browser, "#lesson=" + lesson["id"])
        found = browser.run(LESSON)
        check(lesson["id"], found["drawn"] and found["charted"] and found["response"] == lesson["response"], found)
        if lesson["id"] == "kink":
            for method, sides in found["values"].items():  # nothing presses for less, and the wall takes all for more
                press = [number(side) for side in sides]
                yields = 1e-2 if method == "penalty" else 1e-9  # by default its springs are a hundred times as stiff
                check(f"kink: {method}", len(press) == 2 and press[0] == 0 and abs(press[1] - 1) <= yields, sides)
            continue
        check_values(lesson["id"], program, source, found, found["response"], found["parameter"])
    visit(browser, "#lesson=accuracy")
    found = browser.run(SWEEP)
    check("verdict", "in the chart is Penalty, stiffness 1 (work 5.33)" in found["coarse"] and
          "10⁻⁶ the cheapest run in the chart is Uzawa, scale 100 (work 6.7)" in found["fine"] and found["points"] > 15, found)


def check_charts(browser):
    """Ticks differ, keys are there, and a point says what it is."""
    for address, legend in (("#lesson=belt&predicted=1&view=steps", "Monolithic"), ("#lesson=mesh&predicted=2", "closed form"),
                            ("#lesson=stiff&predicted=2&view=steps", "Penalty"), ("#lesson=corners&predicted=1", "for comparison: smooth (Monolithic)")):
        visit(browser, address)
        found = browser.run(TICKS)
        check(f"ticks of {address}", all(len(set(axis)) == len(axis) for axis in found["ticks"]), found)
        check(f"key of {address}", legend in found["legend"] and found["bar"], found)
    check("key of the mesh's colours", "stress (von Mises)" in found["keys"], found)
    check("what a response is", found["meaning"].startswith("x: force of the support at die.top, x."), found)
    visit(browser, "")
    browser.ask("Input.dispatchMouseEvent", type="mouseMoved", **browser.run(TIP))
    words = browser.run("await until(() => document.querySelector('#tip:not([hidden])')); return document.getElementById('tip')?.textContent;")
    check("hover", words and "work" in words and "error" in words, words)


def check_editor(browser):
    visit(browser, "#lesson=kink&predicted=3")
    text = browser.run(WAIT + "await settled(); click('#open-editor'); await pause(200); return document.getElementById('text').value;")
    check("the editor has what the controls say", '"force": [10, 0]' in text and text.startswith("// One degree"), text)
    lines = "// a comment\n" + re.sub(r"^//.*\n", "", text, flags=re.M)
    visit(browser, "#json=" + urllib.parse.quote(lines))
    found = browser.run(SETTLED)
    check("a link whose scene has comments", found["lesson"] == "" and not found["told"], found)


def check_addresses(browser, program, source):
    """An address that cannot be followed opens the page anyway; one with a scene in space shows it."""
    visit(browser, "#scene=damaged")
    found = browser.run(SETTLED)
    check("a damaged link", found["lesson"] == "play" and "damaged" in found["told"], found)
    visit(browser, "#lesson=corners&c.surface=5&c.friction=-3")
    found = browser.run(SETTLED)
    check("values out of range", "surface=\"faceted\"" in found["commands"][0].replace("'", "") and
          "friction=0" in found["commands"][0], found)
    visit(browser, "")
    found = browser.run(SKIP)
    check("skip", found["focus"] == "scene-title" and "friction=0.45" in found["commands"][0], found)
    lines = (source / "studies/hard/plate-in-space.json").read_text().splitlines()
    scene = json.loads("".join(line for line in lines if not line.startswith("//")))
    visit(browser, "#json=" + urllib.parse.quote(json.dumps(scene)))
    found = browser.run(SETTLED)
    check("solid bodies", found["elements"] > 1 and found["arrows"] > 0, found)


def check_forms(browser):
    visit(browser, "")
    wide = browser.run(FORM)
    check("first screen", wide["chart"] and wide["beyond"] <= 0 and wide["first"] <= 720 and wide["marks"] >= 3, wide)
    visit(browser, "", 390, 844)
    phone = browser.run(FORM)
    check("a phone", phone["chart"] and phone["beyond"] <= 0 and phone["gap"] < 400, phone)
    visit(browser, "", scheme="dark")
    dark = browser.run(FORM)
    check("dark", dark["ink"] != wide["ink"], dark)
    visit(browser, "#lesson=cylinders&predicted=0")
    browser.run(PAPER)
    browser.ask("Emulation.setEmulatedMedia", media="print")
    paper = browser.run("return {name: seen(document.getElementById('meaning')).height, licences: seen(document.querySelector('footer details')).height};")
    check("paper", paper["name"] > 0 and paper["licences"] == 0, paper)
    pages = base64.b64decode(browser.ask("Page.printToPDF")["data"]).count(b"/Type /Page\n")
    check("paper: one page", pages == 1, pages)
    browser.ask("Emulation.setEmulatedMedia", media="")


def show_times(browser, page):
    import gzip
    print(f"page: {page.stat().st_size / 1e6:.2f} MB, compressed {len(gzip.compress(page.read_bytes())) / 1e6:.2f} MB")
    visit(browser, "")
    print(f"first answer after {browser.run(FIRST):.0f} ms")
    for lesson in ("play", "stiff", "newton", "cylinders", "corners", "klarbring", "held", "accuracy"):
        visit(browser, "#lesson=" + lesson)
        times = browser.run("await until(() => document.querySelector('.column dd')); document.querySelector('.skip-prediction')?.click();" + QUICK)
        print(f"{lesson}: slider to picture {times[len(times) // 2]:.0f} ms (median), {times[-1]:.0f} ms (slowest)")


def write_picture(browser, file):
    visit(browser, "#lesson=cylinders", height=700)
    browser.run(PICTURE)
    picture = browser.ask("Page.captureScreenshot", format="webp", quality=55)["data"]
    pathlib.Path(file).write_bytes(base64.b64decode(picture))


@contextlib.contextmanager
def opened(folder):
    """A browser with the page of a folder open, and that page; without one of the two the test is skipped."""
    page, chromium = folder / "stickslip.html", next(filter(None, map(shutil.which, BROWSERS)), None)
    if not page.exists() or not chromium:
        print("skipped: there is no page here (./play.sh), or no Chromium (Debian: apt install chromium)")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(chromium, pathlib.Path(profile), page.as_uri())
        browser.ask("Network.enable")
        yield browser, page
        browser.close()


def main():
    program, source, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    with opened(folder) as (browser, page):
        browser.ask("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)
        if "--times" in sys.argv:
            show_times(browser, page)
        elif "--picture" in sys.argv:
            write_picture(browser, sys.argv[-1])
        else:
            check_page(browser, program, source)
            check_lessons(browser, program, source)
            check_addresses(browser, program, source)
            check_charts(browser)
            check_editor(browser)
            check_forms(browser)
    print("the page works")


if __name__ == "__main__":
    main()
