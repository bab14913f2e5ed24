import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import cede
from cede import data

CROSSING = Path(__file__).parents[2] / "fuzz" / "seeds" / "commonroad" / "crossing.xml"


def conformance():
    beside = Path(__file__).parents[2].parent / "shared" / "conformance"
    folder = Path(os.environ.get("CEDE_CONFORMANCE_DIR", beside)) / "commonroad"
    if not folder.is_dir():
        pytest.skip("no conformance material (CEDE_CONFORMANCE_DIR)")
    return folder


def test_a_scenario_is_a_data_set():
    dataset = data.open_dataset(CROSSING)
    assert dataset.site == "ZAM_Crossing-1_1_T-1"
    encounters = data.encounters(dataset, "test").to_pandas()
    assert encounters[["left", "other"]].to_numpy().tolist() == [[31, 32]]
    assert data.recordings(dataset).num_rows == 91 + 101
    lanelets = dataset.map_lanelets()
    left, right, successors, limit = lanelets[0]
    assert left.shape == right.shape == (2, 2)
    assert (successors, limit) == ([1], 13.9)
    assert {kind for kind, _ in dataset.map_lines()} == {"solid", "dashed", "stop"}


def test_its_encounters_are_measured():
    table = data.criticality(data.open_dataset(CROSSING)).to_pandas()
    row = table.iloc[0]
    assert (row.left, row.other, row.area) == (31, 32, "lanes")
    # By hand, as in the test of the Rust function.
    assert row.ttc == pytest.approx(4.1)
    assert row.left_et == pytest.approx(0.75, abs=0.01)
    assert row.other_et == pytest.approx(1.5, abs=0.01)
    assert row.pet == pytest.approx(2.2, abs=0.01)
    assert row.deceleration == pytest.approx(0.531, abs=0.005)


def test_an_encounter_has_a_junction():
    dataset = data.open_dataset(CROSSING)
    row = data.encounters(dataset).to_pandas().iloc[0]
    assert (row.right_of_way, row.rule) == ("left", "minor-road")
    assert (row.left_control, row.other_control) == ("free", "stop")
    assert row.left_limit == np.float32(13.9) and np.isnan(row.other_limit)
    junction = data.junction(dataset, 0)
    conflict = junction.conflict(0, 1)
    assert (conflict.kind, conflict.right_of_way, conflict.priority) == (
        "crossing",
        "ego",
        "signed",
    )
    _, mine, theirs = conflict.zones[0]
    # Both are 4 m by 2 m, and meet 41.75 and 43.8 m after they began.
    np.testing.assert_allclose([*mine, *theirs], [38.75, 44.75, 40.8, 46.8], atol=0.3)
    with pytest.raises(cede.Error, match=r"encounter = 1 is outside \[0, 1\)"):
        data.junction(dataset, 1)


def test_its_encounters_are_driven(tmp_path):
    alone = cede.evaluate(["replay", "cede"], CROSSING)
    assert list(alone.n) == [1, 1] and alone.priority_accuracy[0] == 1.0
    for name in ("a.xml", "b.xml"):
        shutil.copy(CROSSING, tmp_path / name)
    both = cede.evaluate("replay", tmp_path)
    assert both.n[0] == 2


def test_criticality_of_other_data_has_the_rows_of_the_encounters():
    dataset = data.open_dataset(encounters=40)
    table = data.criticality(dataset).to_pandas()
    encounters = data.encounters(dataset).to_pandas()
    keys = ["site", "file", "left", "other"]
    assert table[keys].equals(encounters[keys])
    assert (table.gap > 0).all() and set(table.area) <= {"paths", "none"}
    known = table.pet.notna()
    assert known.sum() > 10 and (table.pet[known] >= 0).all()
    assert np.isnan(table.ttc).any() and (table.deceleration.dropna() >= 0).all()


def test_what_is_wrong_names_file_and_line(tmp_path):
    path = tmp_path / "broken.xml"
    path.write_text(CROSSING.read_text().replace('ref="2"', 'ref="77"', 1))
    with pytest.raises(cede.Error, match=r"broken.xml:5: .*there is no lanelet 77"):
        data.open_dataset(path)


def test_the_times_of_commonroad_s_own_tests():
    table = data.criticality(data.open_dataset(conformance() / "ZAM_Tjunction-1_97_T-1.xml"))
    row = table.to_pandas().query("left == 1 and other == 5").iloc[0]
    assert row.area == "lanes"
    assert row.left_et == pytest.approx(1.1, abs=0.1)
