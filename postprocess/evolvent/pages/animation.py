"""Animations of a history: selection of the outputs, and writing to a file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from evolvent.errors import USAGE, EvolventError
from evolvent.history import require
from evolvent.pages.scales import largest_of
from evolvent.pages.scene import Scene, check_teeth
from evolvent.physics.teeth import pitches_passed

MAX_FRAMES = 1500
USUAL_FRAMES = 120
USUAL_ADVANCE = 0.12  # pitches from frame to frame: the motion of teeth is visible
BLURRED_ADVANCE = 0.4  # pitches from frame to frame: above, teeth seem to stop or move backwards
COLOURS = 96  # of a GIF


class AnimationError(EvolventError):
    """An animation that cannot be made; the message gives the reason and the remedy."""

    def __init__(self, message: str) -> None:
        super().__init__(message, USAGE)


@dataclass(frozen=True)
class Clip:
    """Selected outputs, and the playing speed."""

    rows: tuple[int, ...]  # outputs of the history, one a frame
    fps: float  # frames per second
    speed: float  # seconds of the run per second of the clip
    advance: float  # largest advance of teeth from frame to frame, in pitches


def choose_clip(
    history: xr.Dataset,
    begin: float | None = None,
    end: float | None = None,
    fps: float = 20.0,
    speed: float | None = None,
) -> Clip:
    """Select the displayed outputs: each frame is the output nearest to its time.

    Parameters
    ----------
    history : with angle (time, wheel).
    begin, end : first and last time [s]; those of the history if None. Without end and speed the
        clip ends after `USUAL_FRAMES` frames of `USUAL_ADVANCE` pitches.
    fps : frames per second.
    speed : seconds of the run per second of the clip; None: fits `USUAL_FRAMES`.

    Raises
    ------
    AnimationError
        No output in the time range, or more than `MAX_FRAMES` frames.
    """
    time = require(history, "time").values
    first = time[0] if begin is None and time.size else begin
    last = time[-1] if end is None and time.size else end
    inside = np.flatnonzero((time >= first) & (time <= last)) if time.size else np.empty(0, int)
    if inside.size == 0:
        raise AnimationError("there is no output between --from and --to")
    passed = pitches_passed(history)
    if end is None and speed is None:
        far = passed[inside] - passed[inside[0]] > USUAL_FRAMES * USUAL_ADVANCE
        inside = inside[: max(int(np.argmax(far)), 2)] if far.any() else inside
    span = float(time[inside[-1]] - time[inside[0]])
    if speed is None:
        speed = span * fps / USUAL_FRAMES if span > 0 else 1.0
    n = 1 + int(np.floor(span / speed * fps + 1e-9))
    if n > MAX_FRAMES:
        raise AnimationError(
            f"{n} frames are more than {MAX_FRAMES}: select a shorter time with --from and --to, "
            f"a --speed above {span * fps / MAX_FRAMES:.3g} or fewer --fps"
        )
    frame_times = time[inside[0]] + np.arange(n) * speed / fps
    right = np.clip(np.searchsorted(time, frame_times), inside[0], inside[-1])
    left = np.maximum(right - 1, inside[0])
    rows = np.where(frame_times - time[left] < time[right] - frame_times, left, right)
    steps = np.diff(passed[rows])
    return Clip(tuple(int(r) for r in rows), fps, speed, float(steps.max(initial=0.0)))


def animate(
    history: xr.Dataset,
    path: Path,
    clip: Clip,
    mesh: int | None = None,
    dpi: int = 100,
    exaggeration: float = 1.0,
) -> None:
    """Write an animation: a GIF, or an MP4 by ffmpeg, by the extension of the path.

    Parameters
    ----------
    history : as for `Scene`.
    path : file that ends in .gif or .mp4.
    clip : as from `choose_clip`.
    mesh : index of the mesh to zoom on; the whole gearbox if None.
    dpi : pixels per inch; the picture is 7.2 inches wide.
    exaggeration : factor of the deviations of the flanks.

    Raises
    ------
    AnimationError
        Another extension, or MP4 without ffmpeg.
    """
    check_format(path)
    check_teeth(history)
    largest = largest_of(history, list(clip.rows), mesh)
    scene = Scene(history, mesh, largest, clip.speed, exaggeration)
    if path.suffix.lower() == ".mp4":
        _write_mp4(scene, path, clip, dpi)
    else:
        _write_gif(scene, path, clip, dpi)


def check_format(path: Path) -> None:
    """Reject a file that `animate` cannot write."""
    if path.suffix.lower() not in (".gif", ".mp4"):
        raise AnimationError(f"{path}: the file name must end in .gif or .mp4")
    if path.suffix.lower() == ".mp4" and not FFMpegWriter.isAvailable():
        raise AnimationError(
            f"{path}: MP4 needs the program ffmpeg, which is not installed; install it (Debian: "
            "apt install ffmpeg; conda: conda install ffmpeg) or write a .gif"
        )


def _write_gif(scene: Scene, path: Path, clip: Clip, dpi: int) -> None:
    """Write a GIF; all frames share one palette, so that static parts do not flicker."""
    scene.figure.set_dpi(dpi)
    middle = [clip.rows[i * (len(clip.rows) - 1) // 3] for i in range(4)]
    samples = np.concatenate([_pixels(scene, row) for row in middle])
    palette = Image.fromarray(samples).quantize(COLOURS, dither=Image.Dither.NONE)
    colours = np.reshape(palette.getpalette() or [], (-1, 3))
    # Pillow takes a near colour, not always the nearest one: almost white becomes white.
    colours[(colours >= 248).all(axis=1)] = 255
    palette.putpalette(colours.ravel().tolist())

    def frames() -> Iterator[Image.Image]:
        for row in clip.rows:
            frame = Image.fromarray(_pixels(scene, row))
            yield frame.quantize(palette=palette, dither=Image.Dither.NONE)

    every = frames()
    first = next(every)
    first.save(
        path,
        format="GIF",
        save_all=True,
        append_images=every,
        loop=0,
        duration=round(1000 / clip.fps),
        optimize=False,
    )


def _pixels(scene: Scene, row: int) -> np.ndarray:
    canvas = scene.show(row).canvas
    assert isinstance(canvas, FigureCanvasAgg)
    canvas.draw()  # type: ignore[no-untyped-call]
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()  # type: ignore[no-untyped-call]


def _write_mp4(scene: Scene, path: Path, clip: Clip, dpi: int) -> None:
    # yuv420p and even sizes, which every player supports
    even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"]
    writer = FFMpegWriter(fps=round(clip.fps), extra_args=even)
    with writer.saving(scene.figure, str(path), dpi):
        for row in clip.rows:
            scene.show(row)
            writer.grab_frame()
