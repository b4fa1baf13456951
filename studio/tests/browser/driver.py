"""Driving the workbench in a real browser.

Needs Chromium (`chromium` in the path, or BEKKER_CHROMIUM), the packages `playwright` and `axe-playwright-python`, and the command
line (BEKKER, or target/debug/bekker); tests are skipped visibly where one of them is missing.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[3]
PROGRAM = Path(os.environ.get("BEKKER", ROOT / "target/debug/bekker"))
CHROMIUM = os.environ.get("BEKKER_CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")

try:
    from axe_playwright_python import sync_playwright as axe
    from playwright import sync_api
except ImportError:
    axe = sync_api = None

#: What is missing for tests in a browser.
MISSING = [
    reason
    for missing, reason in (
        (sync_api is None, "playwright or axe-playwright-python is not installed"),
        (CHROMIUM is None, "Chromium is not installed"),
        (not PROGRAM.exists(), f"{PROGRAM} is not built"),
    )
    if missing
]

#: A diagnosis in a debug build on a busy machine, ms.
PATIENCE = 240_000
#: What the rules of accessibility are taken from.
RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"]}


@contextlib.contextmanager
def serving(*arguments: object) -> Iterator[str]:
    """A workbench, and its address."""
    command = [str(part) for part in (PROGRAM, "studio", *arguments)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        found = re.search(r"http\S+", program.stdout.readline())
        assert found, "the address is printed first"
        try:
            yield found.group(0)
        finally:
            program.terminate()


def watched(browser: Any, address: str, **options: Any) -> Any:
    """A page that notes errors of its script and requests to anywhere else."""
    page = browser.new_context(accept_downloads=True, **options).new_page()
    page.strange = []
    page.on("pageerror", lambda error: page.strange.append(str(error)))
    page.on("request", lambda request: request.url.startswith((address.split("?")[0], "data:", "blob:")) or page.strange.append(request.url))
    return page


def opened(browser: Any, address: str, **options: Any) -> Any:
    """The page with its calibrated model, once the answer of this model is there."""
    page = watched(browser, address, **options)
    page.goto(address)
    until_calibrated(page)
    return page


def violations(page: Any) -> list[str]:
    results = axe.Axe().run(page, options=RULES).response
    return [f"{one['id']}: {one['help']}: {[node['target'] for node in one['nodes']][:3]}" for one in results["violations"]]


def until(page: Any, condition: str) -> None:
    """Waits for a condition. Playwright's own way evaluates text in the page, which the page's policy forbids."""
    end = time.monotonic() + PATIENCE / 1000
    while not page.evaluate(f"Boolean({condition})"):
        assert time.monotonic() < end, condition
        time.sleep(0.05)


def until_calibrated(page: Any, further: str = "true") -> None:
    """Waits for the calibrated model and for its answer: the answer of the model as given stays until the new one comes."""
    calibrated = "window.bekker?.experiment?.calibration && window.bekker.trial && window.bekker.view.at === 1"
    until(page, f"{calibrated} && !window.bekker.trials.asking && ({further})")


def overall(page: Any) -> float:
    value = page.evaluate("window.bekker.overall(window.bekker.trial.rmse)")
    assert isinstance(value, float)
    return value


def of_part(page: Any, part: str) -> float:
    """Error over noise of one of several experiments."""
    value = page.evaluate(f"window.bekker.overallOf(window.bekker.whole.parts.find((one) => one.part === '{part}'), window.bekker.trial.rmse)")
    assert isinstance(value, float)
    return value
