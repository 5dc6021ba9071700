"""What changed since an earlier run of the suite."""

import json


def read_earlier(folder):
    """The document of a results.json, or None."""
    try:
        document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return document if isinstance(document, dict) and isinstance(document.get("rows"), list) else None


def compare(earlier, rows):
    """Words for each run that changed, by CASE.METHOD: verdict, status, error, iterations, warnings; not seconds."""
    before = {f"{row['case']}.{row['method']}": row for row in earlier["rows"]}
    changes = {}
    for row in rows:
        key = f"{row['case']}.{row['method']}"
        old = before.pop(key, None)
        text = "new" if old is None else _difference(old, row)
        if text:
            changes[key] = text
    return changes


def _difference(old, row):
    parts = []
    if old["green"] != row["green"]:
        parts.append("red, was green" if old["green"] else "green, was red")
    if old["status"] != row["status"]:
        parts.append(f"{row['status']}, was {old['status']}")
    if old.get("certificate") != row.get("certificate"):
        parts.append(f"certificate {row['certificate'] or 'none'}, was {old.get('certificate') or 'none'}")
    if old["status"] == row["status"]:
        was, now = sum(old.get("newton", [])), sum(row.get("newton", []))
        if was != now:
            parts.append(f"{now} iterations, was {was}")
        if _far(old.get("error"), row.get("error")):
            parts.append(f"error {_short(row['error'])}, was {_short(old['error'])}")
        warned = [sorted({warning["code"] for warning in one["warnings"]}) for one in (old, row)]
        if warned[0] != warned[1]:
            parts.append(f"warnings {', '.join(warned[1]) or 'none'}, were {', '.join(warned[0]) or 'none'}")
    return "; ".join(parts)


def _far(old, new):
    """Whether an error is another by more than a factor of 10; below 1e-12 all are alike."""
    if (old is None) != (new is None):
        return True
    if old is None:
        return False
    old, new = max(old, 1e-12), max(new, 1e-12)
    return max(old, new) > 10 * min(old, new)


def _short(error):
    return "none" if error is None else f"{error:.1e}"
