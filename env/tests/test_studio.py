"""The workbench from Python: a server that answers, stops, and refuses what cannot be."""

import json
import socket
import urllib.error
import urllib.request
from pathlib import Path

import bekker
import pytest
from bekker.errors import InputError, ModelError

SAND = Path(__file__).parents[2] / "examples/sand_wheel"


def asked(address: str, body: object = None) -> tuple[object, str]:
    """The JSON of an answer, and who may show the page in a frame."""
    data = None if body is None else json.dumps(body).encode()
    with urllib.request.urlopen(address, data, timeout=60) as answer:
        policy = answer.headers["Content-Security-Policy"]
        return json.load(answer), policy.split("frame-ancestors ")[1]


def test_agreement_the_workbench_answers_with_the_numbers_of_a_comparison() -> None:
    with bekker.studio(SAND, parameters={"soil.cohesion": 400.0}) as bench:
        assert bench.running and bench.url.startswith("http://127.0.0.1:")
        listed, ancestors = asked(f"{bench.url}api/experiments")
        assert isinstance(listed, dict)
        assert ancestors == "'self'", "no other page may show it where there is no notebook"
        [one] = listed["experiments"]
        trial, _ = asked(f"{bench.url}api/experiments/{one['id']}/trial", {"values": {}})
        assert isinstance(trial, dict)
        comparison = bekker.compare(SAND, parameters={"soil.cohesion": 400.0})
        assert comparison.given is not None and trial["rmse"] == comparison.given.rmse
        shown = bench._repr_html_()
        assert f'<iframe src="{bench.url}"' in shown and 'height="900"' in shown
    assert not bench.running
    with pytest.raises(urllib.error.URLError):
        asked(f"{bench.url}api/experiments")
    assert "stopped" in bench._repr_html_() and "stopped" in repr(bench)
    bench.stop()
    with pytest.raises(InputError, match="was stopped"):
        bench.open()


def test_property_notebooks_of_this_machine_may_show_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "ipykernel", object())  # type: ignore[arg-type]
    with bekker.studio(SAND, SAND) as bench:
        listed, ancestors = asked(f"{bench.url}api/experiments")
        assert isinstance(listed, dict) and len(listed["experiments"]) == 2
        assert "http://localhost:*" in ancestors and "*" not in ancestors.split()


def test_property_what_cannot_be_opened_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no experiment is given"):
        bekker.studio()
    with pytest.raises(InputError, match="port: 70000"):
        bekker.studio(SAND, port=70000)
    with pytest.raises(ModelError, match=r"experiment\.toml"):
        bekker.studio(tmp_path)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(InputError, match="0 takes a free one"):
            bekker.studio(SAND, port=taken.getsockname()[1])


def test_agreement_a_list_is_a_set_on_one_soil() -> None:
    folders = [SAND.parent / name for name in ("sand_plates", "sand_shear")]
    with bekker.studio(folders, SAND, soil_scatter=0.1) as bench:
        listed, _ = asked(f"{bench.url}api/experiments")
        assert isinstance(listed, dict)
        assert [one["name"] for one in listed["experiments"]] == ["sand_plates + sand_shear", "a wheel on dry sand"]
        trial, _ = asked(f"{bench.url}api/experiments/{listed['experiments'][0]['id']}/trial", {"part": "sand_shear"})
        assert isinstance(trial, dict)
        comparison = bekker.compare(folders, soil_scatter=0.1)
        assert comparison.given is not None and trial["rmse"] == comparison.given.rmse
    with pytest.raises(InputError, match="soil_scatter: expected several experiments"):
        bekker.studio(SAND, soil_scatter=0.1)
