#!/usr/bin/env python3
"""Writes the notices of the crates that FMU libraries contain to fmu/package/third-party.txt.

    python3 fmu/scripts/third_party.py [--check]

Crates are those that `cargo tree` lists for both libraries, without procedural macros and what only they need. Equal
texts are printed once. `--check` writes nothing and fails where the file's list of crates is not that of Cargo.lock.
"""

import argparse
import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = ROOT / "fmu" / "package" / "third-party.txt"
# Preferred where a crate gives the choice: the shortest terms that ask for nothing but the notice.
PREFERRED = ["MIT", "BSD-2-Clause", "BSD-3-Clause", "Zlib", "Apache-2.0", "Unlicense"]
HEADER = """Notices of the Rust crates that are compiled into the library of this FMU.
Made by fmu/scripts/third_party.py; do not edit.
"""


def crates() -> list[str]:
    """`name version` of every linked crate that is not the project's own."""
    command = ["cargo", "tree", "--locked", "-p", "bekker-fmu", "-e", "normal,no-proc-macro", "--prefix", "none",
               "--no-default-features", "--features", "rigid", "--no-dedupe", "-f", "{p}"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    found = {" ".join(line.split()[:2]).replace(" v", " ") for line in listed if line and "(" not in line}
    return sorted(found)


def packages() -> dict[str, dict]:
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    data = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
    return {f"{package['name']} {package['version']}": package for package in data["packages"]}


def chosen(expression: str) -> str:
    """One licence of an expression such as `MIT OR Apache-2.0`; an expression with AND stays as it is."""
    if " AND " in expression:
        return expression
    offered = re.split(r" OR |/|\s*/\s*", expression)
    offered = [word.strip(" ()") for word in offered]
    return next((licence for licence in PREFERRED if licence in offered), expression)


def notice(package: dict, licence: str) -> str:
    """The text that the crate itself ships for the licence, or who wrote it where it ships none."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(path for path in folder.iterdir() if re.match(r"(?i)(licen[cs]e|copying|unlicense)", path.name))
    word = licence.split("-")[0].lower()
    own = [path for path in files if word in path.name.lower()] or [
        path for path in files if re.fullmatch(r"(?i)(licen[cs]e|copying)(\.(md|txt))?", path.name)]
    texts = [path.read_text(encoding="utf-8", errors="replace") for path in own if path.is_file()]
    if texts:
        return "\n\n".join("\n".join(line.rstrip() for line in text.strip().splitlines()) for text in texts)
    authors = ", ".join(re.sub(r"\s*<.*?>", "", author) for author in package["authors"]) or "its authors"
    source = package["repository"] or package["homepage"] or ""
    return f"Copyright {authors}. The crate ships no text of its own; licensed under {licence}. {source}".strip()


def written(names: list[str]) -> str:
    known = packages()
    by_text: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name in names:
        licence = chosen(known[name]["license"] or "")
        by_text[licence, notice(known[name], licence)].append(name)
    parts = [HEADER, "Crates: " + ", ".join(names) + "\n"]
    for (licence, text), users in sorted(by_text.items(), key=lambda item: (item[0][0], item[1])):
        parts.append(f"{'-' * 80}\n{', '.join(users)}: {licence}\n\n{text}\n")
    return "\n".join(parts)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="compare the list of crates only")
    names = crates()
    if parser.parse_args().check:
        line = next((line for line in TARGET.read_text().splitlines() if line.startswith("Crates: ")), "")
        if line != "Crates: " + ", ".join(names):
            print(f"{TARGET.relative_to(ROOT)} is not that of Cargo.lock: run fmu/scripts/third_party.py", file=sys.stderr)
            return 1
        return 0
    TARGET.write_text(written(names), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
