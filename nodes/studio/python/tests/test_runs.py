import pathlib

import grainlab
import numpy as np
import pytest

FROM_PACKING = "name='go'\nfriction=0.3\n[start]\npacking='-'\n[[phase]]\nkind='relax'\nname='rest'\nuntil={hold=0.0,pressure_below=1e9,timeout=0.001}\n"


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
    (of_file,) = grainlab.simulate(path)
    assert np.array_equal(of_text.positions, of_file.positions) and len(of_text) == 40


def test_settings_are_mappings_lists_and_numbers_as_in_a_scene():
    nested = grainlab.Scene("s2", set={"grains": {"count": 200}, "phase.load-50kPa.control": {"xx": {"stress": np.float64(1e5)}}})
    flat = grainlab.Scene("s2", set={"grains.count": 200, "phase.load-50kPa.control.xx.stress": 1e5})
    assert nested.text == flat.text and "count = 200" in nested.text and nested.name == "s2"
    assert "demo" in grainlab.scenes() and "grains.count" in grainlab.scene_keys() and grainlab.scene_check("s2") == nested.check()
    with pytest.raises(TypeError, match="no value of TOML"):
        grainlab.Scene("s2", set={"grains.count": object()})


def test_a_run_is_advanced_and_looked_at_and_starts_from_a_packing(run):
    ended = []
    other = grainlab.simulate("demo", seed=3, set={"grains.count": 150}, on_phase=lambda run, name: ended.append((name, run.phase)))
    assert other.phase == "gas" and other.step() is None and other.steps > 0 and not other.finished
    assert other.run(5000) == [] and other.steps >= 5000 and 0 <= (other.progress or 0) <= 1 and other.time > 0
    (last,) = other.run()
    assert last.positions.tobytes() == run[-1].positions.tobytes() and ended[0] == ("gas", "rest") and ended[-1] == ("settle", None)
    assert other.finished and np.allclose(other.stress, last.stress, rtol=1e-6, atol=1) and np.array_equal(other.strain, last.strain)
    first = next(grainlab.simulate(FROM_PACKING, start=last))
    assert first.contact_tangential_forces.tobytes() == last.contact_tangential_forces.tobytes() and first.phase == 0


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


@pytest.mark.parametrize("seed", [5.5, 5.0, -1, True, "5", 2**63])
def test_a_seed_is_a_whole_number_from_0_on(seed):
    for call in (grainlab.Scene, grainlab.simulate, grainlab.launch):
        with pytest.raises(ValueError, match="seed is .*; it must be a whole number, 0 or more"):
            call("demo", seed=seed)


def test_settings_are_a_mapping_with_whole_floats_as_whole_numbers_and_one_seed():
    assert grainlab.Scene("demo", set={"grains.count": 200.0, "friction": 0.3}, seed=np.int64(3)).text == grainlab.Scene(
        "demo", set={"grains": {"count": 200}, "friction": 0.3, "seed": 3}).text
    with pytest.raises(ValueError, match="seed is a keyword, and a key of set"):
        grainlab.Scene("demo", seed=3, set={"seed": 4})
    with pytest.raises(TypeError, match="set is 'friction=0.2'; it must be a mapping"):
        grainlab.simulate("demo", set="friction=0.2")


def test_a_run_goes_on_by_whole_numbers_of_steps_or_until_a_condition():
    run = grainlab.simulate("demo", seed=3, set={"grains.count": 40})
    for steps in (-5, 1.5):
        with pytest.raises(ValueError, match=f"steps is {steps}"):
            run.run(steps)
    with pytest.raises(ValueError, match="every is 0"):
        run.run_until(lambda run: False, every=0)
    assert run.run_until(lambda run: run.steps >= 700, every=100) == [] and 700 <= run.steps < 900 and run.phase == "gas"
    assert run.run_until(lambda run: run.phase != "gas") == [] and run.phase == "rest"


def test_on_phase_sees_the_packing_at_the_end_of_its_phase():
    seen = []
    run = grainlab.simulate("demo", seed=3, set={"grains.count": 40}, on_phase=lambda run, name: seen.append(run.packing))
    run.run_until(lambda run: len(seen) == 2)
    assert [(p.phase, p.end_of_phase) for p in (*seen, run.packing)] == [(1, True), (2, True), (2, True)]
    run.step()
    assert (run.packing.phase, run.packing.end_of_phase) == (3, False)


def test_on_phase_is_a_function_and_its_stop_iteration_is_an_error():
    stopping = grainlab.simulate("demo", seed=3, set={"grains.count": 40}, on_phase=lambda run, name: next(iter([])))
    with pytest.raises(RuntimeError, match="on_phase raised StopIteration"):
        list(stopping)
    with pytest.raises(TypeError, match="on_phase is 5"):
        grainlab.simulate("demo", on_phase=5)


def test_a_warning_on_a_start_names_the_packing_and_no_file(packing):
    with pytest.warns(UserWarning, match="^the packing given as start: .* contacts carry more tangential force"):
        grainlab.simulate(FROM_PACKING.replace("friction=0.3", "friction=0.001"), start=packing)


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


def test_the_packings_of_a_recording_are_a_sequence(recording):
    packings = grainlab.open(recording).packings()
    every = list(packings)
    assert len(packings) == len(every) and packings[-1].positions.tobytes() == every[-1].positions.tobytes()
    assert [p.step for p in packings[::-1]] == [p.step for p in every[::-1]] and packings[5:] == []
    with pytest.raises(IndexError):
        packings[len(every)]
    pytest.importorskip("matplotlib").use("Agg")
    assert len(grainlab.plot(recording, "stress").lines) == 6
    with pytest.raises(ValueError, match="coordination"):
        grainlab.plot(recording, "colour")


def test_a_launched_run_has_the_packings_of_a_simulation_and_a_report(run, tmp_path):
    made = grainlab.launch("demo", seed=3, set={"grains.count": 150}, out=tmp_path)
    assert made.packings()[-1].positions.tobytes() == run[-1].positions.tobytes() and made.summary["exit"] == 0
    assert "<iframe" in grainlab.report(made)._repr_html_()
    for call, error in ((lambda: grainlab.launch("demo", set={"grains.cuont": 5}), grainlab.SceneError), (lambda: grainlab.report(tmp_path / "x"), grainlab.GrainlabError)):
        with pytest.raises(error, match="cuont|x: No such file"):
            call()


def test_a_campaign_is_gathered_as_columns(tmp_path):
    file = {"name": "two", "scenes": ["demo"], "seeds": [3, 4], "set": {"grains.count": 150}}
    made = grainlab.campaign(file, tmp_path / "two", jobs=2)
    assert made.status()["counts"] == {"finished": 2} and len(made.runs) == 2
    assert np.isfinite(made.gather()["z"]).all() and list(made.gather()["seed"]) == [3, 4]
    with pytest.raises(grainlab.SceneError, match="seeds"):
        grainlab.campaign({"name": "x", "scenes": ["demo"]}, tmp_path / "x")


def test_the_program_is_in_the_package():
    assert "demo" in grainlab.command("scene", "list")
    with pytest.raises(ValueError, match="unrecognized subcommand"):
        grainlab.command("inverse")


@pytest.mark.parametrize("name", ["tour", "figure", "inversion", "campaign"])
def test_the_notebooks_run(name, tmp_path):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    path = pathlib.Path(__file__).parents[1] / f"examples/{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()


def test_damage_of_a_recording_is_an_error_and_never_a_shorter_list(tmp_path):
    run = grainlab.launch("demo", seed=3, set={"grains.count": 100}, out=tmp_path, record="results")
    (file,) = pathlib.Path(run).glob("*.mcap")
    whole, packings = file.read_bytes(), grainlab.open(run).packings()
    steps = [p.step for p in packings]
    bad, refused = tmp_path / "bad.mcap", []
    for start in range(len(whole) * 2 // 5, len(whole) - 2000, max(997, len(whole) // 100)):
        bad.write_bytes(whole[:start] + bytes(range(180)) + whole[start + 180 :])
        try:
            assert [p.step for p in grainlab.open(bad).packings()] == steps, start
        except grainlab.FileError:
            refused.append(start)
    assert refused, "no place of the file held a packing"
    start = refused[0]
    bad.write_bytes(whole[:start] + bytes(range(180)) + whole[start + 180 :])
    damaged = grainlab.open(bad)
    for _ in range(2):
        for read in (
            lambda: list(damaged.packings()),
            lambda: damaged.packings()[-1],
            lambda: damaged.packings()[:],
            lambda: grainlab.analyze(damaged.packings()),
            lambda: damaged.last_packing(),
            lambda: list(damaged.messages("packing")),
        ):
            with pytest.raises(grainlab.FileError, match="may be missing"):
                read()
    assert steps == [packings[n].step for n in range(len(packings))]


def test_an_index_of_a_damaged_recording_gives_the_packing_of_its_number_or_an_error(tmp_path):
    scene = pathlib.Path(__file__).resolve().parents[4] / "tests/golden/scenes/tiny.toml"
    run = grainlab.launch(str(scene), seed=3, out=tmp_path)
    (file,) = pathlib.Path(run).glob("*.mcap")
    whole, steps = file.read_bytes(), [p.step for p in grainlab.open(run).packings()]
    bad, refused = tmp_path / "bad.mcap", 0
    for start in range(1000, len(whole) - 2000, len(whole) // 30):
        bad.write_bytes(whole[:start] + bytes(range(180)) + whole[start + 180 :])
        packings = grainlab.open(bad).packings()
        for number, step in enumerate(steps[: len(packings)]):
            try:
                assert packings[number].step == step, (start, number)
            except grainlab.FileError:
                refused += 1
    assert len(steps) == 2 and refused, "no place of the file held a packing"
