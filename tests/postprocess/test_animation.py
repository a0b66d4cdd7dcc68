"""Moving pictures: which outputs they show, what is written, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from real_gears import RealPair

from evolvent.errors import HistoryError
from evolvent.pages.animation import (
    MAX_FRAMES,
    USUAL_ADVANCE,
    USUAL_FRAMES,
    AnimationError,
    Clip,
    animate,
    choose_clip,
)
from evolvent.pages.scales import Largest, largest_of
from evolvent.pages.scene import Scene
from evolvent.pages.touching import touching
from evolvent.physics.teeth import drawn_meshes
from pictures import faults


@pytest.fixture(scope="module")
def history():
    """Eleven seconds with an output each; a tenth of a pitch a second."""
    return RealPair().history(0.1 * 2 * np.pi / 20 * np.arange(12))


def test_frames_are_the_outputs_nearest_to_their_times(history):
    clip = choose_clip(history, begin=2.0, end=6.0, fps=10.0, speed=4.0)
    # times 2, 2.4, 2.8, ... 6; a time in the middle between two outputs takes the later one
    assert clip.rows == (2, 2, 3, 3, 4, 4, 4, 5, 5, 6, 6)
    assert clip.advance == pytest.approx(0.1)


def test_without_a_speed_the_clip_has_the_usual_number_of_frames(history):
    clip = choose_clip(history, end=11.0)
    assert len(clip.rows) == USUAL_FRAMES + 1
    assert (clip.rows[0], clip.rows[-1]) == (0, 11)
    assert clip.speed == pytest.approx(11.0 / (USUAL_FRAMES / 20.0))


def test_fast_wheels_are_shown_for_as_long_as_their_teeth_can_be_followed():
    long = RealPair().history(0.02 * 2 * np.pi / 20 * np.arange(3000))  # 60 pitches
    clip = choose_clip(long)
    assert clip.rows[0] == 0
    shown = clip.rows[-1] * 0.02
    assert shown == pytest.approx(USUAL_FRAMES * USUAL_ADVANCE, abs=0.05)
    assert clip.advance < 1.2 * USUAL_ADVANCE


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"begin": 12.5}, "no output between"),
        ({"begin": 3.0, "end": 2.0}, "no output between"),
        ({"speed": 1e-3}, f"more than {MAX_FRAMES}: select a shorter time"),
    ],
)
def test_a_clip_that_cannot_be_says_why(history, choice, message):
    with pytest.raises(AnimationError, match=message):
        choose_clip(history, **choice)


def test_a_gif_has_the_frames_the_size_and_the_pace_that_were_asked_for(history, tmp_path):
    path = tmp_path / "pair.gif"
    animate(history, path, Clip((0, 3, 6), 10.0, 30.0, 0.3), dpi=50)
    with Image.open(path) as gif:
        assert gif.n_frames == 3
        assert gif.info["duration"] == 100
        assert gif.info["loop"] == 0
        assert gif.width == 360
        frames = []
        for number in range(3):
            gif.seek(number)
            frames.append(np.asarray(gif.convert("RGB")).astype(int))
    assert np.abs(frames[0] - frames[1]).max() > 100  # it moves
    assert all((frame[-1, -1] == 255).all() for frame in frames)  # on white


def test_the_same_history_gives_the_same_file(history, tmp_path):
    for name in ("one.gif", "two.gif"):
        animate(history, tmp_path / name, Clip((0, 1), 10.0, 10.0, 0.1), mesh=0, dpi=40)
    assert (tmp_path / "one.gif").read_bytes() == (tmp_path / "two.gif").read_bytes()


def test_an_arrow_is_as_long_as_its_force_and_begins_where_the_flanks_touch(history):
    scene = Scene(history, mesh=0, largest=Largest(force=200.0))
    scene.show(2)
    forces = history["pair_normal_force"].values[2, 0]
    loaded = forces[forces > 0]
    arrows = [path.vertices for path in scene.arrows.get_paths()]
    assert len(arrows) == 2 * loaded.size  # one on each wheel
    points = np.stack(scene.contacts.get_data(), axis=1)
    for number, force in enumerate(loaded):
        for arrow in arrows[2 * number : 2 * number + 2]:
            length = np.abs((arrow - points[number]) @ [1, 1j]).max()
            total = force * np.hypot(1.0, 0.1)  # with friction
            assert length == pytest.approx(scene.per_newton * total, rel=1e-6)


@pytest.fixture(scope="module")
def loaded(history):
    """Both wheels loaded, the tooth pairs slide."""
    torque = np.tile([-7.5, -11.25], (history.sizes["time"], 1))
    slides = 0.5 * (history["pair_position"] / history["pair_position"].max() - 0.3)
    return history.assign(
        load_torque=(("time", "wheel"), torque), pair_sliding_velocity=slides.fillna(np.nan)
    )


def test_the_picture_tells_time_pace_load_and_what_is_what(loaded):
    largest = Largest(110.0, 11.25, 0.5)
    figure = Scene(loaded, 0, largest, speed=0.01, exaggeration=20.0).show(1)
    texts = [text.get_text() for text in figure.texts]
    assert "t = 1 s" in texts
    assert "slowed down 100 times" in texts
    assert "2 tooth pairs loaded: 220 N" in texts
    keys = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert {"line of action", "path of contact", "deviations 20 times"} <= set(keys)
    assert {
        "acts on the tooth it lies in",
        "sliding of the driving flank",
    } <= set(keys)
    assert {"driving torque", "braking torque"} <= set(keys)
    # the pinion turns clockwise, the gear counterclockwise; both torques are clockwise
    names = {text.get_text() for text in figure.axes[0].texts}
    assert names == {"pinion\ndrives with 7.5 N m", "gear\nbrakes with 11.2 N m"}
    assert {"5 mm", "100 N", "500 mm/s"} <= {text.get_text() for text in figure.axes[1].texts}


def test_what_a_history_does_not_tell_is_not_in_the_key(history):
    figure = Scene(history, 0, largest_of(history, [0, 1])).show(1)
    keys = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert not any("slides" in key or "torque" in key for key in keys)
    assert {text.get_text() for text in figure.axes[0].texts} == {"pinion", "gear"}


@pytest.mark.parametrize("mesh", [None, 0])
def test_the_arrow_of_a_torque_turns_the_way_of_the_torque(loaded, mesh):
    """Seen from the axle, its tip lies behind its tail in the sense of the torque."""
    for sense in (-1.0, 1.0):
        turned = loaded.assign(load_torque=sense * loaded["load_torque"])
        scene = Scene(turned, mesh, Largest(110.0, 11.25))
        scene.show(1)
        for wheel, path in zip(scene.wheels, scene.torques.get_paths(), strict=True):
            points = path.vertices @ [1, 1j] - wheel.centre
            begin, tip = points[0], points[41]  # of 40 chords, then a barb
            assert np.sign(np.angle(tip / begin)) == -sense


def test_a_flank_slides_along_its_tangent_and_friction_resists(loaded):
    """The force on the driving flank along the sliding is opposite to it: friction takes power."""
    (mesh,) = drawn_meshes(loaded)
    signed = np.sign(loaded["pair_sliding_velocity"].fillna(0.0))
    resisting = loaded.assign(pair_friction_force=-10.0 * signed)
    for row in range(loaded.sizes["time"]):
        for touch in touching(resisting, mesh, 0, row):
            along = mesh.line()[1]
            assert (touch.sliding * along.conjugate()).real == pytest.approx(0.0, abs=1e-12)
            assert (-touch.force * touch.sliding.conjugate()).real < 0.0


@pytest.mark.parametrize("mesh", [None, 0])
def test_nothing_is_clipped_by_the_edge_and_no_label_stands_on_another(loaded, mesh):
    scene = Scene(loaded, mesh, Largest(110.0, 11.25, 0.5), speed=0.5, exaggeration=2.0)
    assert faults(scene.show(0)) == []


NAMES = st.text(st.characters(codec="ascii", categories=("L", "N")), min_size=1, max_size=40)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(NAMES, min_size=2, max_size=2, unique=True),
    st.sampled_from([None, 0]),
    st.floats(-9.0, 9.0),
)
def test_whatever_the_wheels_are_called_no_label_stands_on_another(loaded, names, mesh, power):
    torque = 10.0**power
    named = loaded.assign(load_torque=torque * loaded["load_torque"]).assign_coords(wheel=names)
    scene = Scene(named, mesh, largest_of(named, [0, 1], mesh), speed=10.0**power)
    for row in (0, 1):
        assert faults(scene.show(row)) == []


def test_a_history_of_an_older_version_is_refused_with_the_remedy(friction_run):
    with pytest.raises(HistoryError, match="run the case again"):
        Scene(friction_run.history)
