"""Fixtures of the tests in a browser: Chromium, workbenches, a drive."""

from __future__ import annotations

import math
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from driver import CHROMIUM, MISSING, PROGRAM, ROOT, serving, sync_api


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items if MISSING else []:
        if item.path.parent == Path(__file__).parent:
            item.add_marker(pytest.mark.skip(reason="; ".join(MISSING)))


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        # Containers of a CI have no user namespaces for the sandbox; only our own page is opened.
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """One workbench for the tests of a file: tabs of it share what was found."""
    with serving("--port", 0) as found:
        yield found


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drive of 4 s by the model itself, its torque recorded 10 % too large: some windows and several signals."""
    folder = tmp_path_factory.mktemp("drive")
    commands = [(0.05 * k, 2.0 + math.sin(0.1 * k)) for k in range(81)]
    names = ["x", "velocity", "wheel[1].torque", "wheel[2].torque"]
    speeds = ["wheel[1].speed_command", "wheel[2].speed_command"]
    inputs = folder / "inputs.csv"
    inputs.write_text("\n".join([",".join(["time", *speeds]), *(f"{t},{0.9 * v},{v}" for t, v in commands)]) + "\n")
    made = ["simulate", "two_wheeled_speed", "--duration", "4", "--every", "0.05", "--input-file", inputs]
    made += ["--signals", ",".join(names), "--csv", folder / "signals.csv"]
    subprocess.run([str(part) for part in (PROGRAM, *made)], check=True, capture_output=True)
    lines = (folder / "signals.csv").read_text().splitlines()
    head = lines[0].split(",")
    rows = [",".join(["time", *speeds, *names])]
    for line, (time_, speed) in zip(lines[1:], commands, strict=False):
        row = dict(zip(head, line.split(","), strict=True))
        cells = [float(row[name]) * (1.1 if name.endswith("torque") else 1.0) for name in names]
        rows.append(",".join(map(str, [time_, 0.9 * speed, speed, *cells])))
    (folder / "drive.csv").write_text("\n".join(rows) + "\n")
    noise = "".join(f'"{name}" = {size}\n' for name, size in zip(names, [0.01, 0.01, 0.02, 0.02], strict=True))
    settings = 'name = "a short drive"\nkind = "traverse"\nmodel = "two_wheeled_speed"\n'
    (folder / "experiment.toml").write_text(f'{settings}[noise]\n{noise}[[run]]\nfile = "drive.csv"\n')
    return folder


@pytest.fixture(scope="module")
def together() -> Iterator[str]:
    """One wheel twice and plates, as if on one soil."""
    folders = [ROOT / "examples" / name for name in ("sand_wheel", "sand_wheel", "sand_plates")]
    with serving("--port", 0, *folders) as found:
        yield found
