#!/usr/bin/env bash
# headline_figure.sh DIR: puts six charts of a study in DIR (a run of cattaneo_mindlin.study.json) together in one figure,
# docs/figures/headline.svg.
set -euo pipefail
[ $# -eq 1 ] || { echo "usage: headline_figure.sh DIR" >&2; exit 2; }
cd "$(dirname "${BASH_SOURCE[0]}")/.."
python3 - "$1" docs/figures/headline.svg <<'PYTHON'
import pathlib, re, sys

figures = pathlib.Path(sys.argv[1]) / "figures"
panels = [
    ("error-stiffness-responses", "Response: error against stiffness or scale"),
    ("error-stiffness-sensitivities", "Derivatives: error against stiffness or scale"),
    ("enforcement-responses-against-work-factorisations", "Response: error against work"),
    ("enforcement-sensitivities-against-work-factorisations", "Derivatives: error against work"),
    ("tractions-pressure-p", "Pressure along the contact"),
    ("tractions-tangential-traction-q", "Tangential traction along the contact"),
]
width, title_height, out, top = 640, 34, [], 0
for left, right in zip(panels[::2], panels[1::2]):
    tallest = 0
    for column, (name, title) in enumerate((left, right)):
        text = (figures / f"{name}.svg").read_text()
        height = float(re.search(r'height="([\d.]+)"', text).group(1))
        body = re.sub(r"<\?xml[^>]*\?>|<title>.*?</title>|<desc>.*?</desc>", "", text, flags=re.S).strip()
        x = column * (width + 10)
        out.append(f'<text x="{x + 70}" y="{top + 24}" font-size="15" font-weight="bold">{title}</text>')
        out.append(body.replace("<svg ", f'<svg x="{x}" y="{top + title_height}" ', 1))
        tallest = max(tallest, height)
    top += title_height + tallest
print(
    f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * width + 10} {top:.0f}" '
    'font-family="Helvetica, Arial, sans-serif">\n<title>Two cylinders pressed and sheared, by three methods</title>\n'
    '<rect width="100%" height="100%" fill="#ffffff"/>',
    *out,
    "</svg>",
    sep="\n",
    file=open(sys.argv[2], "w"),
)
PYTHON
