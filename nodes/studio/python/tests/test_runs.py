import pathlib

import grainlab
import numpy as np
import pytest


def test_a_run_is_a_function_of_scene_and_seed(run):
    again = list(grainlab.simulate("demo", seed=3, set={"grains.count": 150}, threads=2))
    assert len(again) == len(run) > 0
    for a, b in zip(run, again, strict=True):
        assert a.positions.tobytes() == b.positions.tobytes() and a.step == b.step
    other = list(grainlab.simulate("demo", seed=5, set={"grains.count": 150}))
    assert other[-1].positions.tobytes() != run[-1].positions.tobytes()


def test_a_scene_is_a_name_a_file_or_a_text(tmp_path):
    text = "base = 'demo'\nname = 'mine'\ngrains.count = 40\n"
    path = tmp_path / "mine.toml"
    path.write_text(text)
    (of_text,) = grainlab.simulate(text)
    (of_file,) = grainlab.simulate(str(path))
    assert np.array_equal(of_text.positions, of_file.positions) and len(of_text) == 40


@pytest.mark.parametrize(
    ("scene", "keys", "words"),
    [
        ("dmeo", {}, "demo, s1"),
        ("demo", {"grains.cuont": 5}, "did you mean count"),
        ("demo", {"grains.count": -5}, "grains.count"),
        ("demo", {"friction": float("nan")}, "friction"),
        ("base = 'demo'\nphase = 3\n", {}, "phase"),
        ("not toml at all\n[", {}, "TOML"),
    ],
)
def test_a_scene_with_faults_is_refused_with_each_of_them(scene, keys, words):
    with pytest.raises(grainlab.SceneError, match=words):
        grainlab.simulate(scene, set=keys)


def test_threads_of_zero_are_refused():
    with pytest.raises(grainlab.SceneError, match="at least one"):
        grainlab.simulate("demo", threads=0)


def test_a_file_that_is_no_packing_raises_and_names_itself(tmp_path):
    path = tmp_path / "noise.csv"
    path.write_bytes(bytes(range(256)) * 10)
    for wrong in (path, tmp_path / "missing.csv", tmp_path):
        with pytest.raises(grainlab.FileError, match=wrong.name):
            grainlab.load(wrong)
    with pytest.raises(grainlab.FileError):
        grainlab.open(path)


def test_a_recording_has_the_packings_that_the_same_run_gives_here(recording):
    opened = grainlab.open(recording)
    packings = list(opened.packings())
    last = opened.last_packing()
    assert opened.topics["/packing"]["messages"] == len(packings) > 0
    assert np.array_equal(last.positions, packings[-1].positions)
    *_, here = grainlab.simulate(opened.scene)
    assert here.positions.tobytes() == last.positions.tobytes()
    assert here.contact_normal_forces.tobytes() == last.contact_normal_forces.tobytes()


def test_messages_of_every_topic_are_dictionaries(recording):
    opened = grainlab.open(recording)
    counts = {}
    times = []
    for topic, time, fields in opened.messages():
        counts[topic] = counts.get(topic, 0) + 1
        times.append(time)
        assert isinstance(fields, dict)
    assert counts == {t: e["messages"] for t, e in opened.topics.items() if e["messages"]}
    assert times == sorted(times)
    stress = [fields for _, _, fields in opened.messages("stress")]
    assert len(stress) == counts["/stress"] and stress[0]["header"]["frame_id"] == "cell"
    with pytest.raises(grainlab.FileError, match="/stress"):
        opened.messages("strss")


def test_the_notebook_runs():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    path = pathlib.Path(__file__).parents[1] / "examples/tour.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
