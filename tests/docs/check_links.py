#!/usr/bin/env python3
"""check_links.py SOURCE: every link of a page to a file leads to one, and to a heading if it names one; images too.
`--self-test` proves that a fault is seen."""
import pathlib
import re
import sys

LINK = re.compile(r"\]\(([^)\s]+)\)|(?:src|srcset)=\"([^\"\s]+)\"")


def anchors(text):
    """What headings are linked by: lower case, blanks as hyphens, no punctuation."""
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, re.M)}


def fault(page, link):
    """What is wrong with a link, or ""."""
    if link.startswith(("http://", "https://", "mailto:")):
        return ""
    path, _, anchor = link.partition("#")
    target = page.parent / path if path else page
    if not target.exists():
        return f"{page}: {link}: there is no such file"
    if anchor and anchor not in anchors(target.read_text()):
        return f"{page}: {link}: there is no such heading"
    return ""


def self_test():
    page = pathlib.Path(__file__)
    if fault(page, "replay.py") or not fault(page, "nothing.py") or not fault(page, "replay.py#nothing"):
        sys.exit("a broken link is not seen")


def main():
    if sys.argv[1] == "--self-test":
        return self_test()
    source = pathlib.Path(sys.argv[1])
    pages = [page for folder in (".", "docs", "core", "tests") for page in sorted((source / folder).glob("*.md"))]
    faults = [fault(page, link or image) for page in pages for link, image in LINK.findall(page.read_text())]
    if any(faults):
        sys.exit("\n".join(filter(None, faults)))


if __name__ == "__main__":
    main()
