#!/usr/bin/env python3
"""page_test.py STICKSLIP SOURCE: a report as a browser shows it: charts, words, hover, legend, choices, paper, a phone,
dark. Chromium is driven by its DevTools protocol through a pipe. Exit code 77, which ctest counts as skipped, where
there is no Chromium."""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
HELPERS = """
  const pause = (time) => new Promise((done) => setTimeout(done, time));
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const seen = (element) => element.getBoundingClientRect();
  const until = async (holds) => { for (let i = 0; i < 200 && !holds(); ++i) await pause(50); return Boolean(holds()); };
  const drawn = (figure) => all('.panel:not([hidden]) .vega svg.marks', figure);
  const chart = document.getElementById('enforcement-responses');
  const points = () => drawn(chart).slice(0, 1).flatMap(
      (svg) => all('g.mark-symbol.role-mark path', svg).filter((path) => path.getAttribute('opacity') !== '0'));
"""
CHARTS = """
  const figures = all('figure[data-chart]').filter((figure) => !figure.closest('details'));
  const plain = (figure) => all('.panel:not([hidden]) .static', figure).some(
      (place) => !place.hidden && !place.closest('details:not([open])'));
  for (const figure of figures) { figure.scrollIntoView(); await until(() => drawn(figure).length && !plain(figure)); }
  const covered = [], words = [];
  for (const svg of all('.vega svg.marks')) {
    const visible = (mark) => all(`g.mark-${mark}.role-mark > *`, svg).filter((e) => e.getAttribute('opacity') !== '0');
    const texts = visible('text').filter((text) => text.textContent), boxes = texts.map(seen);
    const air = 3, pixel = 1;  // between lines of words; what Vega places words by
    const ink = [...visible('line'), ...visible('symbol')].flatMap((path) => Array.from(
        {length: path.getTotalLength()}, (_, i) => path.getPointAtLength(i).matrixTransform(path.getScreenCTM())));
    words.push(...texts.map((text) => text.textContent));
    boxes.forEach((a, i) => {
      const meets = (b) => a.left < b.right && b.left < a.right && a.top + air < b.bottom && b.top + air < a.bottom;
      const holds = ({x, y}) => a.left + pixel < x && x < a.right - pixel && a.top + air < y && y < a.bottom - air;
      const under = boxes.slice(0, i).flatMap((b, j) => meets(b) ? [texts[j].textContent] : []);
      if (ink.some(holds)) under.push('a curve or a marker');
      if (under.length > 0) covered.push([texts[i].textContent, ...under]);
    });
  }
  const labels = all('g.role-axis-label text');
  return {figures: figures.length, bare: figures.filter((figure) => !drawn(figure).length || plain(figure)).length, words,
          covered, numbers: labels.map((text) => text.textContent), paint: labels[0].getAttribute('fill'),
          ink: getComputedStyle(document.documentElement).getPropertyValue('--ink').trim(),
          beyond: document.documentElement.scrollWidth - innerWidth};
"""
PLACE_OF_A_POINT = """
  chart.scrollIntoView();
  await until(() => points().length > 0);
  const at = seen(points()[0]);
  return {x: at.left + at.width / 2, y: at.top + at.height / 2};
"""
TOOLTIP = """
  await until(() => document.querySelector('#vg-tooltip-element.visible'));
  const tip = document.getElementById('vg-tooltip-element'), {left, top, right, bottom} = seen(tip);
  return {words: tip.textContent, inside: left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight};
"""
LEGEND = """
  const button = () => chart.querySelector('.legend button'), before = points().length;
  button().click();
  const less = await until(() => points().length < before), pressed = button().getAttribute('aria-pressed');
  button().click();
  return {less, pressed, again: await until(() => points().length === before)};
"""
CHOICE = """
  const choice = chart.querySelector('.choices select'), places = () => points().map((path) => seen(path).top).join();
  const former = places();
  choice.value = [...choice.options].at(-1).value;
  choice.dispatchEvent(new Event('change', {bubbles: true}));
  const data = chart.querySelector('details.data'), more = chart.querySelector('details.panels-folded');
  data.open = more.open = true;
  return {changed: await until(() => places() !== former), rows: await until(() => all('tbody tr', data).length > 5),
          unfolded: await until(() => drawn(more).length > 0)};
"""
BEFORE_PAPER = """
  const open = all('details[open]').length, wide = () => Number(drawn(chart)[0].getAttribute('width')) > 600;
  dispatchEvent(new Event('beforeprint'));
  const short = await until(wide) && all('details[open]').length === open;
  dispatchEvent(new Event('afterprint'));
  let whole = false;
  window.print = () => { whole = document.body.matches('.whole') && all('details[open]').length > open; };
  document.getElementById('print-all').click();
  const printed = await until(() => whole) && wide();
  dispatchEvent(new Event('afterprint'));
  return {short, printed, closed: all('details[open]').length === open && !document.body.matches('.whole')};
"""
SECTIONS = "return all('main > section').filter((section) => seen(section).height > 0).length;"
CONTRASTS = """
  const luminance = (color) => {
    const [r, g, b] = color.match(/[\\d.]+/g).map((part) => part / 255).map(
        (s) => s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const paper = luminance(getComputedStyle(document.body).backgroundColor);
  const contrast = (color) => {
    const [low, high] = [luminance(color), paper].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  };
  const colors = (selector, what) => all(selector).map((element) => getComputedStyle(element)[what]);
  return [...new Set([...colors('.legend button svg', 'stroke'), ...colors('.plate svg path[style*="light-dark"]', 'stroke'),
                      ...colors('.vega g.mark-line.role-mark path', 'stroke'),
                      ...colors('g.mark-text.role-mark text[fill]', 'fill')])].map((color) => [color, contrast(color)]);
"""
FOR_A_PAPER = """
  const place = chart.querySelector('.paper'), width = place.querySelector('input'), saved = [];
  const code = place.querySelector('pre').textContent;
  width.value = '170';
  width.dispatchEvent(new Event('input'));
  URL.createObjectURL = (blob) => { saved.push(blob); return '#'; };
  place.querySelector('button').click();
  await until(() => saved.length > 1);
  return {code, wide: place.querySelector('pre').textContent, svg: await saved[0].text()};
"""
NUMERALS = "return %s.map(([x, digits]) => [x, digits, Numerals.powered(Numerals.numeral(x, digits))]);"
STEPS = """
  const slider = document.querySelector('.slider input'), steps = all('.step'),
      tractions = document.getElementById('step-tractions');
  const places = () => all('g.mark-symbol.role-mark path', tractions).map((path) => seen(path).top - seen(tractions).top).join();
  tractions.scrollIntoView();
  await until(() => drawn(tractions).length && places());
  const last = places();
  slider.value = 2;
  slider.dispatchEvent(new Event('input'));
  await until(() => places() !== last);
  return {first: places(), last, words: document.querySelector('.slider output').textContent,
          shown: steps.flatMap((step, i) => seen(step).height > 0 ? [i] : [])};
"""


class Browser:
    """A page in Chromium: a message is a JSON text that ends in a zero, written to its file 3 and read from its 4."""

    def __init__(self, program, folder, page):
        to_read, self.out = os.pipe()
        self.into, to_write = os.pipe()
        places = f"exec {program} \"$@\" 3<&{to_read} 4>&{to_write}"
        options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", f"--user-data-dir={folder}"]
        self.process = subprocess.Popen(["bash", "-c", places, "browser", *options], pass_fds=(to_read, to_write),
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.number, self.rest, self.session = 0, b"", {}
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = {"sessionId": self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]}
        self.ask("Page.enable")
        self.page = page

    def message(self):
        while b"\0" not in self.rest:
            part = os.read(self.into, 1 << 20)
            if not part:
                sys.exit("Chromium ended")
            self.rest += part
        text, _, self.rest = self.rest.partition(b"\0")
        return json.loads(text)

    def ask(self, method, **given):
        self.number += 1
        request = {"id": self.number, "method": method, "params": given, **self.session}
        os.write(self.out, json.dumps(request).encode() + b"\0")
        answer = self.message()
        while answer.get("id") != self.number:
            answer = self.message()
        return answer["result"]

    def open(self, width, scheme="light"):
        """Opens the page in a window of that width."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self.ask("Page.navigate", url=self.page)
        while self.message().get("method") != "Page.loadEventFired":
            pass

    def run(self, script):
        """What the script returns in the page."""
        answer = self.ask("Runtime.evaluate", expression="(async () => {" + HELPERS + script + "})()", awaitPromise=True,
                          returnByValue=True)
        if "exceptionDetails" in answer:
            sys.exit(json.dumps(answer))
        return answer["result"].get("value")

    def close(self):
        self.ask("Page.disable")
        self.process.terminate()
        self.process.wait()


def check(name, holds, found):
    if not holds:
        sys.exit(f"{name}: {json.dumps(found)[:3000]}")


def check_charts(name, found, least=4):
    check(name, found["figures"] >= least and found["bare"] == 0, found)
    check(f"{name}: words cover each other", not found["covered"], found)
    check(f"{name}: wider than the window", found["beyond"] <= 0, found)
    check(f"{name}: numbers of axes", not [text for text in found["numbers"] if "+" in text or "\u2212" in text], found)
    check(f"{name}: colours", found["paint"] == found["ink"], found)


def check_contrasts(scheme, found, least=6):
    """Curves and their words stand out from the paper by 3, which WCAG asks of graphics."""
    check(f"{scheme}: curves", len(found) >= least, found)
    check(f"{scheme}: contrast", all(contrast >= 3 for _, contrast in found), found)


def check_print(browser):
    """Paper has the first screen, what came out and where it is from; the rest if it is asked for."""
    on_screen = browser.run(SECTIONS)
    browser.ask("Emulation.setEmulatedMedia", media="print")
    short = browser.run(SECTIONS)
    whole = browser.run("document.body.classList.add('whole');" + SECTIONS)
    browser.run("document.body.classList.remove('whole');")
    check("paper: sections", short == 3 and whole == on_screen > 6, [on_screen, short, whole])
    pages = base64.b64decode(browser.ask("Page.printToPDF")["data"]).count(b"/Type /Page\n")
    check("paper: pages of the short form", 1 <= pages <= 3, pages)
    browser.ask("Emulation.setEmulatedMedia", media="")


def check_paper(found):
    """LaTeX for one column and for two, and a chart of that width with its legend."""
    check("LaTeX", "\\ifdim\\linewidth>85mm \\setlength{\\linewidth}{85mm}\\fi" in found["code"] and "\\begin{figure}" in found["code"] and
          "\\input{figures/enforcement-responses-against-seconds.pgf}" in found["code"], found["code"])
    check("LaTeX of two columns", "\\begin{figure*}" in found["wide"] and
          found["wide"].count("\\begin{minipage}{.49\\linewidth}") == 2 and "minipage" not in found["code"], found["wide"])
    check("SVG", 'width="170mm"' in found["svg"] and "role-legend" in found["svg"] and "Uzawa AL" in found["svg"], found["svg"])


def check_pointer(browser):
    """A point says what it is, and a name in the legend takes its curve away and puts it back."""
    browser.ask("Input.dispatchMouseEvent", type="mouseMoved", **browser.run(PLACE_OF_A_POINT))
    tip = browser.run(TOOLTIP)
    check("hover", tip["inside"] and "Penalty" in tip["words"] and "method" in tip["words"] and
          "factorisations" not in tip["words"], tip)
    legend = browser.run(LEGEND)
    check("legend", legend == {"less": True, "pressed": "false", "again": True}, legend)


def check_numerals(browser):
    """Numbers are those of the pages' parts that the program writes; whole ones keep their digits, but thousands."""
    wanted = json.loads(pathlib.Path(__file__).with_name("numerals.json").read_text(encoding="utf-8"))
    wanted += [[123456, 6, "123456"], [20000, 6, "2·10⁴"]]
    found = browser.run(NUMERALS % json.dumps(wanted))
    check("numerals", found == wanted, [pair for pair in zip(found, wanted) if pair[0] != pair[1]])


def check_sizes(study):
    """A report of 36 runs has 2.1 million bytes, 0.84 of them of the chart library, and its figures 2.4; and a tenth."""
    page = (study / "report.html").stat().st_size
    figures = sum(file.stat().st_size for file in (study / "figures").iterdir())
    check("bytes", page < 2.3e6 and figures < 2.6e6, [page, figures])


def check_page(browser):
    browser.open(1200)
    check_numerals(browser)
    wide = browser.run(CHARTS)
    check_charts("charts", wide)
    check("words at the ends of lines", {"1e-8", "exactly 0"} <= set(wide["words"]) and
          any(words.startswith("Uzawa AL scale=") for words in wide["words"]), wide)
    check_pointer(browser)
    choice = browser.run(CHOICE)
    check("choice", all(choice.values()), choice)
    paper = browser.run(BEFORE_PAPER)
    check("paper", all(paper.values()), paper)
    check_print(browser)
    check_paper(browser.run(FOR_A_PAPER))
    check_contrasts("light", browser.run(CONTRASTS))
    browser.open(390)
    check_charts("a phone", browser.run(CHARTS))
    check_pointer(browser)
    browser.open(1200, "dark")
    dark = browser.run(CHARTS)
    check_charts("dark", dark)
    check("dark", dark["ink"] != wide["ink"], dark)
    check_contrasts("dark", browser.run(CONTRASTS))


def check_steps(browser):
    """The slider of a run shows one step at a time, with its tractions."""
    for width, scheme in ((1200, "light"), (1200, "dark"), (390, "light"), (390, "dark")):
        browser.open(width, scheme)
        name = f"a run of {width} pixels, {scheme}"
        check_charts(name, browser.run(CHARTS), 1)
        check_contrasts(name, browser.run(CONTRASTS), 1)
        found = browser.run(STEPS)
        check(name, found["first"] != found["last"] and found["words"].startswith("step 2, t = 1: ") and
              found["shown"] == [2], found)


def run_with_steps(program, source, folder):
    """A run of a shipped scene whose steps are kept."""
    text = (source / "studies/scenes/ironing.json").read_text()
    scene = folder / "ironing.json"
    scene.write_text(text.replace('"method":', '"output": {"fields": "all"}, "method":'))
    subprocess.run([program, "run", scene, "-o", folder / "run", "--report"], check=True, capture_output=True)
    return folder / "run" / "report.html"


def main():
    program, source = sys.argv[1], pathlib.Path(sys.argv[2])
    chromium = next(filter(None, map(shutil.which, BROWSERS)), None)
    if not chromium:
        print("skipped: there is no Chromium here (Debian: apt install chromium)")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        study = pathlib.Path(folder) / "study"
        subprocess.run([program, "study", source / "studies/scenes/greco_plate.study.json", "-o", study],
                       check=True, capture_output=True)
        check_sizes(study)
        browser = Browser(chromium, pathlib.Path(folder) / "profile", (study / "report.html").as_uri())
        try:
            check_page(browser)
            browser.page = run_with_steps(program, source, pathlib.Path(folder)).as_uri()
            check_steps(browser)
        finally:
            browser.close()


if __name__ == "__main__":
    main()
