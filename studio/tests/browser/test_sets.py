"""Several experiments in the workbench, in a real browser: errors of each and of all, an effect in one or in all, a set put together on the page."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest
from driver import PATIENCE, PROGRAM, ROOT, of_part, opened, overall, serving, until, until_calibrated, violations, watched

#: Error over noise of the second wheel, in the page.
WHEEL_2 = "window.bekker.overallOf(window.bekker.whole.parts[1], window.bekker.trial.rmse)"


def test_several_experiments_on_one_soil_have_the_errors_of_the_command_line(browser: Any, together: str, tmp_path: Path) -> None:
    folders = [ROOT / "examples" / name for name in ("sand_wheel", "sand_wheel", "sand_plates")]
    command = [PROGRAM, "calibrate", *folders, "--json", tmp_path / "calibrated.json"]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    page = opened(browser, together)
    assert page.evaluate("window.bekker.trial.rmse") == json.loads((tmp_path / "calibrated.json").read_text())["rmse"]
    # By keyboard to the last of them: its plots, its parameters, its address.
    assert page.get_by_role("radio").count() == 3
    page.get_by_role("radio", name="sand_wheel ", exact=False).first.focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("ArrowDown")
    until(page, "window.bekker.experiment.kind === 'plate_sinkage'")
    assert page.get_by_role("radio", name="sand_plates").is_checked()
    page.get_by_role("heading", name="Measured and modelled: sand_plates").wait_for()
    assert "part=sand_plates" in page.url
    page.get_by_text("Soil and other calibrated parameters").click()
    page.get_by_role("heading", name="Of sand_plates alone").wait_for()
    before = page.evaluate("window.bekker.trial.runs")
    page.reload()
    until(page, "window.bekker?.trial")
    assert page.evaluate("window.bekker.trial.runs") == before
    page.go_back()
    page.go_back()
    until(page, "window.bekker.experiment.kind === 'single_wheel'")
    assert page.strange == []


def test_an_effect_acts_in_one_of_several_experiments_or_in_all(browser: Any, together: str) -> None:
    page = opened(browser, together)
    first, second = of_part(page, "sand_wheel"), of_part(page, "sand_wheel_2")
    place = page.get_by_label("Where slip sinkage acts")
    place.select_option(label="in sand_wheel_2")
    page.get_by_role("switch", name="slip sinkage").click()
    until(page, "window.bekker.found.has('slip_sinkage in sand_wheel_2') && !window.bekker.jobs.has('fit')")
    # The other wheel has the same soil but not the effect: one of them is fitted better, and the effect goes with its own slider.
    until(page, f"{WHEEL_2} < 0.95 * {second}")
    assert of_part(page, "sand_wheel") > of_part(page, "sand_wheel_2")
    assert page.get_by_role("slider", name="n1").count() == 1
    # In all of them instead; the row and the keyboard's focus stay.
    place.focus()
    place.select_option(label="in sand_wheel and sand_wheel_2")
    until(page, "window.bekker.found.get('slip_sinkage')?.fitted && !window.bekker.jobs.has('fit')")
    assert page.evaluate("document.activeElement?.closest('.where') !== null")
    until(page, f"{WHEEL_2} < 0.8 * {second}")
    assert of_part(page, "sand_wheel") < 0.8 * first
    whole = overall(page)
    page.get_by_role("button", name="Accept slip sinkage").click()
    until(page, "window.bekker.view.at === 2")
    assert abs(page.evaluate("window.bekker.overall(window.bekker.steps[2].rmse)") - whole) < 1e-9
    # Each has its own model, and its page says that the others were there.
    page.get_by_role("radio", name="sand_wheel_2").check()
    until(page, "window.bekker.part.part === 'sand_wheel_2'")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save model (TOML)").first.click()
    assert download.value.suggested_filename.endswith("-sand_wheel_2.toml")
    assert "slip_sinkage" in download.value.path().read_text()
    with page.expect_download(timeout=PATIENCE) as download:
        page.get_by_role("button", name="Save report").first.click()
    assert "fitted together" in download.value.path().read_text()
    assert page.strange == []


def test_a_search_in_several_experiments_names_the_effect_and_its_place(browser: Any) -> None:
    folders = [ROOT / "examples" / name for name in ("sand_plates", "sand_shear")]
    with serving("--port", 0, *folders) as address:
        page = opened(browser, address)
        before = overall(page)
        page.get_by_role("button", name="Find what is missing").click()
        until(page, "window.bekker.found.size > 2")
        until(page, "window.bekker.diagnosis && !window.bekker.jobs.has('rank')")
        found = page.evaluate("window.bekker.diagnosis.effects")
        page.get_by_role("button", name="Try ").first.click()
        until(page, f"window.bekker.overall(window.bekker.trial.rmse) < 0.8 * {before}")
        assert found
        with page.expect_download(timeout=PATIENCE) as download:
            page.get_by_role("button", name="Save page of the diagnosis").first.click()
        assert "One of sand_plates + sand_shear, fitted together" in download.value.path().read_text()
        assert page.strange == []


@pytest.mark.parametrize("width", [390, 1440])
def test_a_set_is_put_together_on_the_page(browser: Any, width: int, tmp_path: Path) -> None:
    folders = [ROOT / "examples" / name for name in ("sand_plates", "sand_shear", "sand_wheel")]
    command = [PROGRAM, "calibrate", *folders[::2], "--soil-scatter", "0.1", "--json", tmp_path / "calibrated.json"]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    with serving("--port", 0, "--apart", *folders) as address:
        page = opened(browser, address, viewport={"width": width, "height": 900})
        page.get_by_role("button", name="Fit together…").click()
        page.get_by_role("checkbox", name="shear tests of dense sand").uncheck()
        page.get_by_label("The soil differs from one to the next by").fill("10")
        assert violations(page) == []
        page.get_by_role("button", name="Fit 2 together").click()
        until_calibrated(page, "window.bekker.part")
        # The numbers are those of the command line.
        assert page.evaluate("window.bekker.trial.rmse") == json.loads((tmp_path / "calibrated.json").read_text())["rmse"]
        assert page.evaluate("window.bekker.listed.experiments.length") == 4
        # A set is no part of another one.
        page.get_by_role("button", name="Fit together…").click()
        assert page.get_by_role("group", name="Experiments").get_by_role("checkbox").count() == 3
        page.get_by_role("checkbox", name="shear tests of dense sand").check()
        page.get_by_role("checkbox", name="the soil").uncheck()
        page.get_by_role("button", name="Fit 3 together").click()
        until(page, "window.bekker.experiment?.parts.length === 3")
        assert "a soil of its own in each experiment" in page.evaluate("window.bekker.experiment.sources.join()")
        assert page.strange == []


def test_the_saved_page_of_one_of_a_set_moves_the_effects_that_were_tried(browser: Any, tmp_path: Path) -> None:
    folders = [ROOT / "examples" / name for name in ("sand_wheel", "sand_wheel")]
    command = [PROGRAM, "diagnose", *folders, "--candidates", "slip_sinkage,exit_angle", "--html", tmp_path / "report.html"]
    subprocess.run([str(part) for part in command], check=True, capture_output=True)
    report = tmp_path / "report-sand_wheel_2.html"
    assert report.stat().st_size < 8_000_000
    page = watched(browser, report.as_uri())
    page.goto(report.as_uri())
    until(page, "window.bekker?.trial")
    page.get_by_text("One of sand_wheel + sand_wheel_2, fitted together").wait_for()
    fitted = overall(page)
    assert fitted < 1.25
    page.get_by_role("switch", name="exit angle").click()
    until(page, "window.bekker.view.on.join() === 'exit_angle'")
    assert overall(page) > 1.5 * fitted
    page.get_by_role("switch", name="slip sinkage").click()
    until(page, "window.bekker.view.on.join() === 'slip_sinkage'")
    page.get_by_role("slider", name="n1").focus()
    for _ in range(60):
        page.keyboard.press("ArrowRight")
    until(page, "Object.keys(window.bekker.view.set).length > 0")
    assert overall(page) > 1.05 * fitted
    assert page.evaluate("window.bekker.saved.worst().ratio") <= 0.5
    assert violations(page) == []
    assert page.strange == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1440])
def test_a_set_breaks_no_rule_of_accessibility(browser: Any, together: str, scheme: str, width: int) -> None:
    page = opened(browser, together, color_scheme=scheme, viewport={"width": width, "height": 900})
    page.get_by_role("switch", name="slip sinkage").click()
    until(page, "!window.bekker.jobs.has('fit')")
    page.get_by_text("Soil and other calibrated parameters").click()
    assert violations(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "nothing sticks out"
