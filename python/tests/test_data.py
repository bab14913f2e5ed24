import os
from pathlib import Path

import numpy as np
import pytest

import cede
from cede import data


def recorded():
    beside = Path(__file__).parents[2].parent / "shared" / "interaction"
    folder = Path(os.environ.get("CEDE_INTERACTION_DIR", beside))
    if not folder.is_dir():
        pytest.skip("no recorded data (CEDE_INTERACTION_DIR)")
    return folder


def test_tables_of_synthetic_encounters():
    dataset = data.open_dataset(encounters=40)
    encounters = data.encounters(dataset).to_pandas()
    states = data.states(dataset).to_pandas()
    assert len(encounters) == len(dataset) >= 40
    assert set(encounters["first"]) <= {"left", "other"}
    assert (encounters.groupby("file").size() > 0).all()
    first = states[(states.encounter == 0) & (states.vehicle == 0)]
    assert (first.step.diff().dropna() == 1).all()
    # What is recorded is where the route is.
    route = dataset.route(0, 0)
    assert route.shape[1] == 2
    moved = np.hypot(first.x.diff(), first.y.diff()).dropna()
    np.testing.assert_allclose(moved, first.s.diff().dropna(), atol=0.05)


def test_recordings_are_a_table():
    dataset = data.open_dataset(encounters=20)
    table = data.recordings(dataset)
    assert table.column_names[:3] == ["file", "track", "time_ms"]
    assert table["x"].type == "double"
    assert table.num_rows > 1000


def test_the_same_seed_gives_the_same_encounters():
    one, two = (cede.data.Dataset.synthetic(30, 4) for _ in range(2))
    assert data.states(one).equals(data.states(two))


def test_recorded_sites():
    dataset = data.open_dataset(recorded(), site="EP0")
    assert dataset.site == "EP0"
    assert len(data.encounters(dataset, "train")) == 215
    kinds = {kind for kind, _ in dataset.map_lines()}
    assert "stop" in kinds


def test_a_folder_without_recordings_is_named(tmp_path):
    with pytest.raises(cede.Error, match=str(tmp_path)):
        data.open_dataset(tmp_path)


def test_recorded_needs_a_folder(monkeypatch):
    monkeypatch.delenv("CEDE_INTERACTION_DIR", raising=False)
    with pytest.raises(cede.Error, match="CEDE_INTERACTION_DIR"):
        data.open_dataset("recorded")


def test_environments_over_recordings():
    import gymnasium

    made = gymnasium.make_vec(
        "cede/Encounter-v0", num_envs=32, data=str(recorded()), site="EP0", mode="left"
    )
    made.reset(seed=1)
    for _ in range(50):
        seen, *_ = made.step(made.action_space.sample())
    assert seen in made.observation_space


def test_a_site_by_name_has_the_description_beside_it(tmp_path):
    folder = tmp_path / "X"
    folder.mkdir()
    rows = "".join(f"1,{0.1 * step:.1f},{0.8 * step:.1f},0\n" for step in range(50))
    (folder / "tracks_0.csv").write_text("track,t,x,y\n" + rows)
    with pytest.warns(UserWarning, match="no X.toml beside its recordings"):
        cede.data.Dataset.load(tmp_path, "X")
    (tmp_path / "X.toml").write_text('name = "described"\nfolder = "X"\n')
    assert cede.data.Dataset.load(tmp_path, "X").site == "described"
