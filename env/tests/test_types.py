"""The words of the package: its guided tour runs, and its page of environments is the one that its script writes."""

import doctest
import subprocess
import sys
from pathlib import Path

import bekker


def test_property_the_guided_tour_runs() -> None:
    outcome = doctest.testmod(bekker)
    assert outcome.attempted > 10 and outcome.failed == 0


def test_regress_the_page_of_environments_is_up_to_date() -> None:
    script = Path(__file__).parents[2] / "examples" / "environment.py"
    subprocess.run([sys.executable, script, "--check"], check=True)
