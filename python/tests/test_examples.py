"""Runs the example of each public function, method and member of a map."""
import doctest
import inspect

import numpy as np
import pytest

import byre


def public_names():
    """Functions of the package, methods of its classes and all members of Map, with their docstrings."""
    for name in byre.__all__:
        bound = getattr(byre, name)
        if inspect.isclass(bound):
            for member, value in vars(bound).items():
                if not member.startswith("_") and (bound is byre.Map or inspect.isroutine(getattr(bound, member))):
                    yield f"{name}.{member}", getattr(bound, member).__doc__
        else:
            yield name, bound.__doc__


@pytest.fixture(scope="module")
def part(room, frames, tmp_path_factory):
    """Mapping of half of the recording: a Slam and its map file, which a mission on all of it extends."""
    path = tmp_path_factory.mktemp("maps") / "part.byre"
    mapped = byre.Slam.mapping(byre.Recording(room).calibration, byre.SlamOptions(workers=byre.Workers.repeatable))
    for images in frames[: len(frames) // 2]:
        mapped.process(images)
    mapped.finish()
    mapped.save(path)
    return mapped, path


def test_each_has_an_example_that_runs(room, frames, m, picks, part, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tags.yaml").write_text("size: 0.24\ntags:\n  - id: 3\n  - id: 7\n")
    mapped, path = part
    mission = byre.Slam.on_map(byre.Recording(room).calibration, path)
    for images in frames:
        mission.process(images)
    names = {
        "byre": byre,
        "np": np,
        "room": room,
        "recording": byre.Recording(room),
        "images": frames[10],
        "path": path,
        "mapped": mapped,
        "mission": mission,
        "m": m,
        "picks_in_map": picks[0],
        "picks_in_plan": picks[1],
    }
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    tested = dict(public_names())
    assert len(tested) > 60
    for name, text in tested.items():
        examples = doctest.DocTestParser().get_doctest(text, dict(names), name, None, 0)
        assert examples.examples, f"{name} has no example"
        runner.run(examples)
    assert runner.failures == 0


def test_each_doubt_has_advice():
    assert all(byre.advice_for(doubt) for doubt in byre.DistrustReason if doubt is not byre.DistrustReason.none)
