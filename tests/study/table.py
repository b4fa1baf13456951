"""Rows and tables of a study: rates with Wilson intervals, confusion, times."""

import csv
import math
from collections import Counter, defaultdict

import score

GOOD = ("right", "right_tie", "cautious")
BAD = ("wrong", "extra", "false_alarm")
Z = 1.96

# Counted apart: the library had its sharp limit only when the report set was made.
APART = "rim_adhesion"

NAMES = ("name", "kind", "size", "case", "form", "noise", "seed", "group", "outcome", "verdict", "said", "tied", "beside")
NAMES += ("visible", "deviations", "allowed_ties", "removed", "attainable", "seconds", "seconds_made", "error")


def wilson(hits, total):
    """95 % interval of a rate (Wilson 1927)."""
    if total == 0:
        return 0.0, 1.0
    rate, z2 = hits / total, Z * Z
    middle = (rate + z2 / (2 * total)) / (1 + z2 / total)
    half = Z * math.sqrt(rate * (1 - rate) / total + z2 / (4 * total * total)) / (1 + z2 / total)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def rate(hits, total):
    if total == 0:
        return "-"
    low, high = wilson(hits, total)
    return f"{hits}/{total} = {100 * hits / total:.1f} % ({100 * low:.1f} .. {100 * high:.1f})"


def group_of(truth):
    case, effects = truth["case"], truth["effects"]
    if case == "clean":
        return "nothing hidden"
    if case in score.CAUTION:
        return "misleading"
    if not all(e["visible"] for e in effects):
        return "too weak to be seen"
    if all(e["outside"] for e in effects):
        return "outside the library"
    return "two effects" if len(effects) == 2 else "one effect"


def row_of(record):
    """One flat row of a diagnosed experiment."""
    truth, result, job = record["truth"], record["result"], record["job"]
    effects = truth["effects"]
    row = {k: job[k] for k in ("kind", "size", "case", "form", "noise", "seed")}
    row |= {k: record[k] for k in ("name", "seconds", "seconds_made", "attainable")}
    row["group"], row["outcome"] = group_of(truth), score.outcome(truth, result)
    row["removed"] = None if "error" in result else score.removed_share(truth, result)
    row["verdict"] = result.get("verdict", "error")
    row["error"] = " ".join(result.get("error", "").split())
    row["said"] = "+".join(result.get("effects", []))
    row["tied"] = "+".join(sorted(score.tied(result)))
    row["beside"] = "+".join(sorted(score.beside(result)))
    row["visible"] = all(e["visible"] for e in effects)
    row["deviations"] = " ".join(f"{e['deviations']:.1f}" for e in effects)
    row["allowed_ties"] = " ".join("+".join(e["allowed_ties"]) or "-" for e in effects)
    return row | {k: round(row[k], 4) for k in ("removed", "attainable") if row[k] is not None}


def append_row(path, row):
    """Adds a row in one write, so that processes do not tear each other's lines."""
    new = not path.exists()
    if not new and path.open(encoding="utf-8").readline().strip() != ",".join(NAMES):
        raise SystemExit(f"{path} has other columns than {', '.join(NAMES)}: rows of another version; begin a new file")
    with open(path, "a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, NAMES, lineterminator="\n")
        if new:
            writer.writeheader()
        writer.writerow(row)


def read_rows(path):
    """The rows of a file, numbers as numbers; none where there is no file."""
    if not path.exists():
        return []
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name in ("noise", "removed", "attainable", "seconds", "seconds_made"):
            row[name] = float(row[name]) if row[name] else None
    return rows


TARGETS = (
    ("one effect", "named rightly, or in a tie of at most three look-alikes", GOOD, ">= 95 % at 2 % noise, >= 90 % at 5 %"),
    ("one effect", "wrongly named or one too many", BAD, "<= 1 %"),
    ("nothing hidden", "false alarm", BAD, "<= 5 %"),
    ("outside the library", "called unexplained", GOOD, ">= 95 %"),
    ("outside the library", "wrongly named", BAD, "none"),
    ("two effects", "both named", GOOD, ">= 80 %"),
    ("two effects", "wrongly named", BAD, "<= 1 %"),
    ("misleading", "cautious", GOOD, "no confident wrong name"),
    ("too weak to be seen", "cautious", GOOD, "no confident wrong name"),
)


def summary(rows):
    lines = ["| hidden | kind | noise | what | rate (95 % Wilson) | target |", "|---|---|---|---|---|---|"]
    for apart in (False, True):
        some = [r for r in rows if (r["case"] == APART) == apart]
        for group, what, words, target in TARGETS:
            for kind, noise in sorted({(r["kind"], r["noise"]) for r in some}):
                chosen = [r for r in some if (r["kind"], r["noise"], r["group"]) == (kind, noise, group)]
                if chosen:
                    hits = sum(r["outcome"] in words for r in chosen)
                    name = f"{group}: {APART}" if apart else group
                    lines.append(f"| {name} | {kind} | {noise:g} | {what} | {rate(hits, len(chosen))} | {'apart' if apart else target} |")
    return lines + carried(rows)


def carried(rows):
    """How often a rightly named effect carries the whole drop of the left-out error."""
    right = [r for r in rows if r["group"] == "one effect" and r["case"] != APART and r["outcome"] in GOOD and r["removed"] is not None]
    could = [r for r in right if r["attainable"] is not None and r["attainable"] >= score.WHOLE]
    lines = []
    if right:
        gone = sorted(r["removed"] for r in right)
        lines.append(f"| one effect, rightly named | all | all | 90 % of the removable left-out error gone | {rate(sum(g >= score.WHOLE for g in gone), len(gone))} | - |")
        lines.append(f"| one effect, rightly named | all | all | removable left-out error gone, median | {100 * gone[len(gone) // 2]:.0f} % | >= 90 % |")
    if could:
        hits = sum(r["removed"] >= score.WHOLE for r in could)
        lines.append(f"| the same, where the true form removes 90 % | all | all | 90 % of the removable left-out error gone | {rate(hits, len(could))} | >= 90 % |")
    return lines


def by_case(rows):
    lines = ["| kind | case | form | noise | good (95 % Wilson) | bad | outcomes | s a diagnosis, median |", "|" + "---|" * 8]
    cells = defaultdict(list)
    for r in rows:
        cells[(r["kind"], r["group"], r["case"], r["form"], r["noise"])].append(r)
    for (kind, group, case, form, noise), found in sorted(cells.items()):
        good, bad = (sum(r["outcome"] in words for r in found) for words in (GOOD, BAD))
        counts = ", ".join(f"{name} {n}" for name, n in Counter(r["outcome"] for r in found).most_common())
        seconds = sorted(r["seconds"] for r in found)[len(found) // 2]
        note = f"{case} ({group})" if group == "too weak to be seen" else case
        lines.append(f"| {kind} | {note} | {form} | {noise:g} | {rate(good, len(found))} | {bad} | {counts} | {seconds:.1f} |")
    return lines


def confusion(rows, kind):
    """Rows: what is hidden; columns: what was said."""
    chosen = [r for r in rows if r["kind"] == kind and r["verdict"] != "error"]
    said = lambda r: r["said"] if r["verdict"] == "effect_missing" else r["verdict"]
    columns = sorted({said(r) for r in chosen})
    lines = ["| hidden | " + " | ".join(columns) + " |", "|" + "---|" * (len(columns) + 1)]
    for case in sorted({r["case"] for r in chosen}):
        counts = Counter(said(r) for r in chosen if r["case"] == case)
        lines.append(f"| {case} | " + " | ".join(str(counts[c] or "") for c in columns) + " |")
    return lines


def times(rows):
    lines = ["| kind | experiments | s a diagnosis: median | 90 % | longest | s to make one, median |", "|" + "---|" * 6]
    for kind, size in sorted({(r["kind"], r["size"]) for r in rows}):
        some = [r for r in rows if (r["kind"], r["size"]) == (kind, size)]
        s, g = sorted(r["seconds"] for r in some), sorted(r["seconds_made"] for r in some)
        at = lambda values, q: values[min(int(q * len(values)), len(values) - 1)]
        lines.append(f"| {kind} {size} | {len(s)} | {at(s, 0.5):.1f} | {at(s, 0.9):.1f} | {s[-1]:.1f} | {at(g, 0.5):.1f} |")
    return lines


def markdown(rows, title):
    parts = [f"# {title}", "", f"{len(rows)} experiments.", "", "## Rates", "", *summary(rows)]
    parts += ["", "## By case", "", *by_case(rows)]
    for kind in sorted({r["kind"] for r in rows}):
        parts += ["", f"## What was said: {kind}", "", *confusion(rows, kind)]
    errors = [r for r in rows if r["verdict"] == "error"]
    if errors:
        parts += ["", "## Errors", ""] + [f"- {r['name']}: {r['error'][:200]}" for r in errors]
    return "\n".join(parts + ["", "## Times", "", *times(rows), ""])
