"""The types that the package states are the ones it has."""

import doctest
import subprocess
import sys

import bekker


def test_property_stubs_describe_the_binary() -> None:
    subprocess.run([sys.executable, "-m", "mypy.stubtest", "bekker._bekker"], check=True)


def test_property_the_guided_tour_runs() -> None:
    outcome = doctest.testmod(bekker)
    assert outcome.attempted > 10 and outcome.failed == 0
