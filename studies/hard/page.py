"""The page of the suite: one HTML file without a network, a row a case, each row open to its sentences and figures."""

import html
import math
import urllib.parse
from pathlib import Path

from case_file import METHODS
from run_case import SOLVED

LARGEST_FIGURE = 60_000  # bytes of an SVG that is put into the page; larger ones are linked
STYLE = Path(__file__).with_name("page.css")


def escape(text):
    return html.escape(str(text), quote=True)


def short(value):
    """A number of the table of answers."""
    if isinstance(value, bool) or value is None:
        return "none" if value is None else str(value)
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, list):
        return ", ".join(short(one) for one in value)
    return str(value)


def plural(count, word):
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def error_text(error):
    if error is None:
        return ""
    if math.isinf(error):
        return "no number"
    return f"{error:.1e}" if error else "0"


def _cell(row, change):
    mark = "&#10003;" if row["green"] else "&#10007;"
    parts = [f"error {error_text(row['error'])}"] if row["error"] is not None else []
    if row.get("newton"):
        parts.append(f"{sum(row['newton'])} it.")
    parts.append(f"{row['seconds']:.1f} s")
    if row["certificate"]:
        parts.append(f"certificate {row['certificate']}")
    if row["faults"] and not row["faults"][0].startswith("status "):
        parts.append(row["faults"][0])
    changed = f'<span class="changed">{escape(change)}</span>' if change else ""
    return (f'<span class="cell {"green" if row["green"] else "red"}"><span class="method-name">{row["method"]}</span>'
            f'<b>{mark} {escape(row["status"].replace("_", " "))}</b> {escape(", ".join(parts))}{changed}</span>')


def _checks(row):
    if not row["checks"]:
        return ""
    lines = []
    for check in row["checks"]:
        verdict = '<span class="good">&#10003;</span>' if check["holds"] else '<span class="bad">&#10007;</span>'
        error = error_text(check["error"]) + (f"<br/>of {check['tolerance']:g}" if check["tolerance"] else "")
        lines.append(f"<tr><td>{verdict}</td><td>{escape(check['what'])}</td><td>{escape(short(check['got']))}</td>"
                     f"<td>{escape(check['expected'])}</td><td>{error}</td></tr>")
    return ('<div class="scroll"><table><tr><th></th><th>what</th><th>found</th><th>right</th><th>error</th></tr>'
            + "".join(lines) + "</table></div>")


def _figure(folder, path, caption):
    """The SVG inside of the page, or a link where it is large; nothing where there is none."""
    if not path.is_file():
        return ""
    if path.stat().st_size > LARGEST_FIGURE:
        link = urllib.parse.quote(path.relative_to(folder).as_posix())
        return f'<p><a href="{link}">{escape(caption)}</a></p>'
    data = urllib.parse.quote(path.read_text(encoding="utf-8"), safe=" =:/,;()")
    return (f'<figure><img loading="lazy" alt="{escape(caption)}" src="data:image/svg+xml,{data}">'
            f"<figcaption>{escape(caption)}</figcaption></figure>")


def _method(folder, row, change):
    run = folder / "runs" / f"{row['case']}.{row['method']}"
    parts = [f"<h3>{row['method']}: {escape(row['status'])}</h3>",
             f"<p class=\"dim\">expected: {escape(row['expected'])}</p>"]
    if row["faults"]:
        parts.append('<ul class="bad">' + "".join(f"<li>{escape(fault)}</li>" for fault in row["faults"]) + "</ul>")
    if change:
        parts.append(f"<p><i>{escape(change)}</i></p>")
    if row["message"]:
        parts.append(f"<pre>{escape(row['message'])}</pre>")
    parts.append(_checks(row))
    if row["warnings"]:
        parts.append("<p>warnings</p><ul>" + "".join(
            f"<li><b>{escape(w['code'])}</b> {escape(w['text'])}</li>" for w in row["warnings"]) + "</ul>")
    if row["certificate_text"]:
        parts.append(f"<p>certificate</p><pre>{escape(row['certificate_text'])}</pre>")
    counts = [f"{sum(row['newton'])} iterations in {plural(row['steps'], 'step')}" if row.get("newton") else "",
              f"{sum(row['augmentations'])} augmentations" if sum(row.get("augmentations", [])) else "",
              f"{row['cutbacks']} cuts of steps" if row.get("cutbacks") else "", f"{row['seconds']:.2f} s"]
    parts.append(f"<p class=\"dim\">{', '.join(filter(None, counts))}</p>")
    parts.append(_figure(folder, run / "figures" / "histories.svg", "history of the iterations"))
    if (run / "report.html").is_file():
        parts.append(f"<p><a href=\"runs/{urllib.parse.quote(run.name)}/report.html\">report of the run</a></p>")
    return f'<div class="method">{"".join(parts)}</div>'


def _picture(folder, case, rows):
    """One picture of the case: of the first method that solved it, or of the last that has one."""
    for row in sorted(rows, key=lambda row: row["status"] not in SOLVED):
        path = folder / "runs" / f"{case.name}.{row['method']}" / "figures" / "overview.svg"
        if path.is_file():
            name = f"the scene by {row['method']}, at the last step that was solved"
            return f'<div class="picture">{_figure(folder, path, name)}</div>'
    return ""


def _case(folder, case, rows, changes):
    cells = "".join(_cell(row, changes.get(f"{row['case']}.{row['method']}")) for row in rows)
    sentences = [f"<p><b>Hard:</b> {escape(case.hard)}</p>", f"<p><b>Must:</b> {escape(case.must)}</p>"]
    sentences += [f"<p>{escape(note)}</p>" for note in case.notes]
    if case.case:
        sentences.append(f'<p class="dim">In the list of verification problems: {escape(case.case)}.</p>')
    if case.source:
        sentences.append(f'<p class="dim">The answers are from: {escape(case.source)}</p>')
    methods = "".join(_method(folder, row, changes.get(f"{row['case']}.{row['method']}")) for row in rows)
    return (f'<details id="{escape(case.name)}"><summary><span class="name">{escape(case.name)}</span>{cells}</summary>'
            f'<div class="body">{"".join(sentences)}{_picture(folder, case, rows)}'
            f'<div class="methods">{methods}</div></div></details>\n')


def _jump_list(rows):
    """Links to the cases that have a red run."""
    red = {}
    for row in rows:
        if not row["green"]:
            red.setdefault(row["case"], []).append(row["method"])
    if not red:
        return ""
    items = "".join(f'<li><a href="#{escape(name)}">{escape(name)}</a>'
                    + ("" if len(methods) == len(METHODS) else f" <span class=\"dim\">{', '.join(methods)}</span>")
                    + "</li>" for name, methods in red.items())
    return f'<p>Red, by one method at least:</p><ul class="jump">{items}</ul>'


def page_text(folder, cases, rows, head, about, changes, compared):
    by_case = {}
    for row in rows:
        by_case.setdefault(row["case"], []).append(row)
    groups = {}
    for case in sorted(cases, key=lambda case: (case.group, case.name)):
        groups.setdefault(case.group, []).append(case)
    columns = ('<div class="columns"><span>case</span>' + "".join(f"<span>{m}</span>" for m in METHODS) + "</div>")
    sections = "".join(
        f"<section><h2>{escape(group)}</h2>{columns}\n"
        + "".join(_case(folder, case, by_case[case.name], changes) for case in own) + "</section>"
        for group, own in groups.items())
    since = (f"<p>{len(changes)} runs changed since the earlier suite; what changed stands in italics.</p>"
             if compared else "")
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"/><meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>Hard cases</title><style>
{STYLE.read_text(encoding="utf-8")}</style></head><body>
<h1>Hard cases</h1>
<p class="head">{escape(head)}</p>
<p class="dim">{escape(about)}</p>
<p>A row is a scene, a column a method. Green: it did what a correct program must do, which may be a failure that is
named. Red: it did not. Open a row for the sentences, the numbers and the figures.</p>
{since}{_jump_list(rows)}
{sections}</body></html>
"""


def write_page(folder, cases, rows, head, version, verify, changes, compared):
    about = version + ("; certificates by its command verify" if verify else
                       "; no certificates: this program has no command verify")
    (folder / "index.html").write_text(page_text(folder, cases, rows, head, about, changes, compared), encoding="utf-8")
