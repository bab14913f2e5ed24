import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cede
from cede.replay import main, replay

CROSSING = Path(__file__).parents[2] / "fuzz" / "seeds" / "commonroad" / "crossing.xml"


def test_a_replay_is_the_record():
    driven = replay("replay", encounters=40, split="all", encounter=3)
    dataset = cede.data.open_dataset(encounters=40)
    recorded = cede.data.states(dataset).to_pandas().query("encounter == 3")
    assert driven.end == "finished"
    for vehicle in range(2):
        mine = driven.states[driven.states.vehicle == vehicle]
        theirs = recorded[recorded.vehicle == vehicle][: len(mine)]
        np.testing.assert_allclose(mine.s[: len(theirs)], theirs.s, atol=0.5)
        assert (mine.step.diff().dropna() == 1).all()
    # Those around them are as they were.
    others = driven.states[driven.states.vehicle >= 2]
    merged = others.merge(recorded, on=["vehicle", "step"], suffixes=("", "_recorded"))
    assert len(merged) == len(others)
    assert (merged.s == merged.s_recorded).all()


def test_the_shield_is_seen():
    def blind(view):
        return 3.0

    driven = replay(blind, encounters=40, split="all", encounter=3, shield=True)
    assert driven.states.shielded.any()
    assert not driven.states[driven.states.vehicle >= 2].shielded.any()


def test_a_gif_has_a_picture_for_each_step(tmp_path):
    image = pytest.importorskip("PIL.Image", reason="no Pillow (pip install 'cede[gif]')")
    driven = replay("cede", CROSSING)
    driven.gif(tmp_path / "x.gif", speed=2)
    with image.open(tmp_path / "x.gif") as made:
        assert made.size == (480, 480)
        # Equal pictures in a row are one that lasts longer.
        lasts, colours = 0, set()
        for frame in range(made.n_frames):
            made.seek(frame)
            lasts += made.info["duration"]
            colours |= {tuple(colour) for _, colour in made.convert("RGB").getcolors()}
        assert lasts == 50 * (driven.states.step.max() + 1)
    assert {(194, 65, 12), (29, 78, 216)} <= colours
    with pytest.raises(cede.Error, match="speed = 0"):
        driven.gif(tmp_path / "y.gif", speed=0)


def test_a_recording_for_rerun_has_every_state(tmp_path):
    pytest.importorskip("rerun", reason="no Rerun (pip install 'cede[rerun]')")
    driven = replay("cede", CROSSING)
    path = tmp_path / "x.rrd"
    driven.rerun(path)
    assert path.read_bytes().startswith(b"RRF")
    told = subprocess.run(
        [sys.executable, "-m", "rerun", "rrd", "print", str(path)],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    for entity in ("/vehicle/left", "/vehicle/other", "/v/left", "/distance/other", "/map/stop"):
        assert entity in told, entity


def test_from_a_shell(tmp_path, capsys):
    pytest.importorskip("PIL", reason="no Pillow (pip install 'cede[gif]')")
    out = tmp_path / "x.gif"
    main([str(CROSSING), "--driver", "idm", "--shield", "all-way-stop", "--out", str(out)])
    assert out.read_bytes().startswith(b"GIF89a")
    assert "finished" in capsys.readouterr().out
    with pytest.raises(SystemExit) as ended:
        main([str(CROSSING), "--encounter", "9", "--out", str(out)])
    assert ended.value.code == 3
    assert "encounter = 9 is outside [0, 1)" in capsys.readouterr().err
    with pytest.raises(SystemExit) as ended:
        main([str(CROSSING), "--out", "x.mp4"])
    assert ended.value.code == 2
