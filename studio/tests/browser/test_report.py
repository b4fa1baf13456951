"""The saved report of the workbench in a real browser: the page without a server; accessibility."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from driver import PATIENCE, opened, overall, until, violations, watched


@pytest.fixture(scope="module")
def report(browser: Any, address: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a diagnosis, saved from the workbench."""
    page = opened(browser, address)
    if not page.evaluate("Boolean(window.bekker.diagnosis)"):
        page.evaluate("window.bekker.begin('rank')")
        until(page, "window.bekker.diagnosis")
    saved = tmp_path_factory.mktemp("report") / "diagnosis.html"
    with page.expect_download(timeout=PATIENCE) as download:
        page.get_by_role("button", name="Save page of the diagnosis").first.click()
    download.value.save_as(saved)
    return saved


def test_the_saved_report_is_the_page_without_a_server(browser: Any, address: str, report: Path) -> None:
    assert report.stat().st_size < 8_000_000
    page = watched(browser, report.as_uri())
    page.goto(report.as_uri())
    until(page, "window.bekker?.trial")
    page.get_by_text("One effect is missing from the model: slip sinkage.").first.wait_for()
    assert page.get_by_text("The largest difference from a simulation half way between").count() == 1
    fitted = overall(page)
    assert fitted < 1.25
    # A colleague switches the effect off, another one on, and moves the strength of the first.
    page.get_by_role("switch", name="slip sinkage").click()
    until(page, "window.bekker.view.on.length === 0")
    assert overall(page) > 2.0
    page.get_by_role("switch", name="exit angle").click()
    until(page, "window.bekker.view.on.join() === 'exit_angle'")
    page.get_by_role("switch", name="slip sinkage").click()
    until(page, "window.bekker.view.on.join() === 'slip_sinkage'")
    assert abs(overall(page) - fitted) < 1e-3
    slider = page.get_by_role("slider", name="n1")
    slider.focus()
    for _ in range(60):
        page.keyboard.press("ArrowRight")
    until(page, "Object.keys(window.bekker.view.set).length > 0")
    moved = overall(page)
    assert moved > 1.05 * fitted
    # The server's simulation at the same values agrees within what the page states.
    values = page.evaluate("window.bekker.values()")
    live = opened(browser, address)
    identity = live.evaluate("window.bekker.experiment.id")
    answer = live.evaluate(
        "([id, values]) => fetch(`api/experiments/${id}/trial`, { method: 'POST', body: JSON.stringify({ values }) }).then((one) => one.json())",
        [identity, values],
    )
    simulated = live.evaluate("(rmse) => window.bekker.overall(rmse)", answer["rmse"])
    stated = page.evaluate("window.bekker.saved.worst().ratio")
    assert stated <= 0.5
    assert abs(simulated - moved) <= stated
    # The address holds the state, links go to the text, and its figures are drawn.
    page.reload()
    until(page, "window.bekker?.trial")
    assert abs(overall(page) - moved) < 1e-6
    page.get_by_role("link", name="Which effect?").click()
    assert "at=" in page.url
    page.get_by_role("link", name="The error, step by step").click()
    until(page, "document.querySelector('#report .plot canvas')")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save the model of this step").click()
    assert "slip_sinkage" in download.value.path().read_text()
    assert page.strange == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_saved_report_breaks_no_rule_of_accessibility(browser: Any, report: Path, scheme: str) -> None:
    page = watched(browser, report.as_uri(), color_scheme=scheme, viewport={"width": 390, "height": 900})
    page.goto(report.as_uri())
    until(page, "window.bekker?.trial")
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "nothing sticks out"
