"""Tables of a study: rates with Wilson intervals, confusion, times."""

import csv
import math
from collections import Counter, defaultdict

import score

GOOD = ("right", "right_tie", "cautious")
BAD = ("wrong", "extra", "false_alarm")
Z = 1.96


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


def group_of(record):
    case, effects = record["truth"]["case"], record["truth"]["effects"]
    if case == "clean":
        return "nothing hidden"
    if case in score.CAUTION:
        return "misleading"
    if not all(e["visible"] for e in effects):
        return "too weak to be seen"
    if all(e["outside"] for e in effects):
        return "outside the library"
    return "two effects" if len(effects) == 2 else "one effect"


def evaluate(records):
    """Adds outcome, group, share removed to every record."""
    for r in records:
        r["outcome"] = score.outcome(r["truth"], r["result"])
        r["group"] = group_of(r)
        r["removed"] = None if "error" in r["result"] else score.removed_share(r["truth"], r["result"])
    return records


TARGETS = (
    ("one effect", "named rightly, honest ties included", GOOD, ">= 95 % at 2 % noise, >= 90 % at 5 %"),
    ("one effect", "wrongly named or one too many", BAD, "<= 2 %"),
    ("nothing hidden", "false alarm", BAD, "<= 5 %"),
    ("outside the library", "called unexplained", GOOD, ">= 95 %"),
    ("outside the library", "wrongly named", BAD, "-"),
    ("two effects", "both named", GOOD, ">= 80 %"),
    ("two effects", "wrongly named", BAD, "<= 2 %"),
    ("misleading", "cautious", GOOD, "no confident wrong name"),
    ("too weak to be seen", "cautious", GOOD, "no confident wrong name"),
)


def summary(records):
    lines = ["| hidden | kind | noise | what | rate (95 % Wilson) | target |", "|---|---|---|---|---|---|"]
    keys = sorted({(r["job"]["kind"], r["job"]["noise"]) for r in records})
    for group, what, words, target in TARGETS:
        for kind, noise in keys:
            chosen = [r for r in records if (r["job"]["kind"], r["job"]["noise"]) == (kind, noise) and r["group"] == group]
            if chosen:
                hits = sum(r["outcome"] in words for r in chosen)
                lines.append(f"| {group} | {kind} | {noise:g} | {what} | {rate(hits, len(chosen))} | {target} |")
    gone = sorted(r["removed"] for r in records if r["removed"] is not None and r["group"] == "one effect")
    if gone:
        enough = sum(g >= 0.9 for g in gone)
        lines.append(f"| one effect | all | all | at least 90 % of the removable held-out error gone | {rate(enough, len(gone))} | - |")
        lines.append(f"| one effect | all | all | removable held-out error gone, median | {100 * gone[len(gone) // 2]:.0f} % | >= 90 % |")
    return lines


def by_case(records):
    lines = ["| kind | case | form | noise | good (95 % Wilson) | bad | outcomes | s a diagnosis, median |", "|" + "---|" * 8]
    cells = defaultdict(list)
    for r in records:
        j = r["job"]
        cells[(j["kind"], r["group"], j["case"], j["form"], j["noise"])].append(r)
    for (kind, group, case, form, noise), found in sorted(cells.items()):
        good, bad = (sum(r["outcome"] in words for r in found) for words in (GOOD, BAD))
        counts = ", ".join(f"{name} {n}" for name, n in Counter(r["outcome"] for r in found).most_common())
        seconds = sorted(r["seconds"] for r in found)[len(found) // 2]
        note = f"{case} ({group})" if group == "too weak to be seen" else case
        lines.append(f"| {kind} | {note} | {form} | {noise:g} | {rate(good, len(found))} | {bad} | {counts} | {seconds:.1f} |")
    return lines


def confusion(records, kind):
    """Rows: what is hidden; columns: what was said."""
    chosen = [r for r in records if r["job"]["kind"] == kind and "error" not in r["result"]]
    said = lambda r: "+".join(sorted(score.named(r["result"]))) or r["result"]["verdict"]
    columns = sorted({said(r) for r in chosen})
    lines = ["| hidden | " + " | ".join(columns) + " |", "|" + "---|" * (len(columns) + 1)]
    for case in sorted({r["job"]["case"] for r in chosen}):
        counts = Counter(said(r) for r in chosen if r["job"]["case"] == case)
        lines.append(f"| {case} | " + " | ".join(str(counts[c] or "") for c in columns) + " |")
    return lines


def times(records):
    lines = ["| kind | experiments | s a diagnosis: median | 90 % | longest | s to make one, median |", "|" + "---|" * 6]
    for kind, size in sorted({(r["job"]["kind"], r["job"]["size"]) for r in records}):
        some = [r for r in records if (r["job"]["kind"], r["job"]["size"]) == (kind, size)]
        s, g = sorted(r["seconds"] for r in some), sorted(r["seconds_made"] for r in some)
        at = lambda values, q: values[min(int(q * len(values)), len(values) - 1)]
        lines.append(f"| {kind} {size} | {len(s)} | {at(s, 0.5):.1f} | {at(s, 0.9):.1f} | {s[-1]:.1f} | {at(g, 0.5):.1f} |")
    return lines


def markdown(records, title):
    parts = [f"# {title}", "", f"{len(records)} experiments.", "", "## Rates", "", *summary(records)]
    parts += ["", "## By case", "", *by_case(records)]
    for kind in sorted({r["job"]["kind"] for r in records}):
        parts += ["", f"## What was said: {kind}", "", *confusion(records, kind)]
    errors = [r for r in records if "error" in r["result"]]
    if errors:
        parts += ["", "## Errors", ""] + [f"- {r['name']}: {r['result']['error'][:200]}" for r in errors]
    return "\n".join(parts + ["", "## Times", "", *times(records), ""])


def write_csv(records, path):
    names = ("name", "kind", "size", "case", "form", "noise", "seed", "group", "outcome", "verdict", "said", "tied")
    names += ("visible", "deviations", "allowed_ties", "removed", "seconds", "seconds_made")
    with open(path, "w", encoding="utf-8", newline="") as file:
        out = csv.DictWriter(file, names, lineterminator="\n")
        out.writeheader()
        for r in records:
            effects, result = r["truth"]["effects"], r["result"]
            row = {k: r["job"][k] for k in ("kind", "size", "case", "form", "noise", "seed")}
            row |= {k: r[k] for k in ("name", "group", "outcome", "removed", "seconds", "seconds_made")}
            row["verdict"] = result.get("verdict", "error")
            row["said"] = "+".join(result.get("effects", []))
            row["tied"] = "" if "error" in result else "+".join(sorted(score.tied(result)))
            row["visible"] = all(e["visible"] for e in effects)
            row["deviations"] = " ".join(f"{e['deviations']:.1f}" for e in effects)
            row["allowed_ties"] = " ".join("+".join(e["allowed_ties"]) or "-" for e in effects)
            out.writerow(row)
