"""Moving pictures: which outputs they show, what is written, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
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
from evolvent.pages.scene import Scene


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
        ({"speed": 1e-3}, f"more than {MAX_FRAMES}: choose a shorter time"),
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
    scene = Scene(history, mesh=0, largest=200.0)
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


def test_the_picture_tells_time_pace_load_and_what_is_what(history):
    figure = Scene(history, mesh=0, largest=110.0, speed=0.01, exaggeration=20.0).show(1)
    texts = [text.get_text() for text in figure.texts]
    assert "t = 1 s" in texts
    assert "slowed down 100 times" in texts
    assert "2 tooth pairs loaded: 220 N" in texts
    keys = [text.get_text() for text in figure.axes[1].get_legend().get_texts()]
    assert {"line of action", "path of contact", "deviations 20 times"} <= set(keys)
    assert {"pinion", "gear"} <= {text.get_text() for text in figure.axes[0].texts}
    assert {"5 mm", "100 N"} <= {text.get_text() for text in figure.axes[1].texts}


@pytest.mark.parametrize("mesh", [None, 0])
def test_nothing_is_clipped_by_the_edge(history, mesh):
    figure = Scene(history, mesh, largest=110.0, speed=0.5, exaggeration=2.0).show(0)
    figure.draw_without_rendering()
    inside = figure.bbox.padded(1.0)
    for text in [*figure.texts, *figure.axes[0].texts, *figure.axes[1].texts]:
        box = text.get_window_extent()
        assert inside.containsx(box.x0), text
        assert inside.containsx(box.x1), text
        assert inside.containsy(box.y0), text
        assert inside.containsy(box.y1), text
    legend = figure.axes[1].get_legend().get_window_extent()
    keys = [text.get_window_extent() for text in figure.axes[1].texts]
    assert all(not legend.overlaps(box) for box in keys)
    assert inside.containsx(legend.x0)
    assert inside.containsx(legend.x1)


def test_a_history_of_an_older_version_is_refused_with_the_remedy(friction_run):
    with pytest.raises(HistoryError, match="run the case again"):
        Scene(friction_run.history)
