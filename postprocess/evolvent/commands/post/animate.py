"""The command evolvent-post animate."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.post.common import complain, open_with_warning
from evolvent.commands.program import say
from evolvent.errors import USAGE, HistoryError, replacing
from evolvent.history import file_label


def animate(
    file: Annotated[Path, argument("FILE", "History (.h5).")],
    output: Annotated[
        Path | None,
        option(
            "-o --output PATH", "File, .gif or .mp4; the history's name with .gif if not given."
        ),
    ] = None,
    mesh: Annotated[
        str | None, option("--mesh NAME", "Zoom on this mesh; otherwise the whole gearbox.")
    ] = None,
    begin: Annotated[float | None, option("--from TIME", "First time shown [s].")] = None,
    end: Annotated[
        float | None,
        option(
            "--to TIME",
            "Last time shown [s]. Without --to and --speed: the last, or for fast wheels the last "
            "that 120 frames can show.",
        ),
    ] = None,
    fps: Annotated[float, option("--fps", "Frames a second.", min=1.0, max=50.0)] = 20.0,
    speed: Annotated[
        float | None,
        option(
            "--speed X",
            "Seconds of the run in one second of the picture, 0.01 for a hundredfold slow "
            "motion; if not given, for 120 frames.",
        ),
    ] = None,
    dpi: Annotated[
        int, option("--dpi", "Pixels an inch of a picture 7.2 inches wide.", min=30, max=400)
    ] = 100,
    exaggerate: Annotated[
        float,
        option(
            "--exaggerate X",
            "Magnification of tip and root relief and crowning, which are too small to see. Pitch "
            "errors and runout are not drawn.",
            min=0.0,
        ),
    ] = 1.0,
) -> None:
    """Write an animation of the rotating wheels and the forces on their teeth.

    \b
    Teeth are to scale; the length of an arrow is proportional to its force. Each frame is an
    output of the history. MP4 needs the program ffmpeg.
    Example:
      evolvent-post animate spur-pair.h5
      evolvent-post animate rattle.h5 -o rattle.mp4 --mesh pinion-gear --from 0.1 --to 0.11
      evolvent-post animate tip-relief.h5 -o relief.gif --mesh pinion-gear --exaggerate 50
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.pages import animation

    path = output if output is not None else Path(f"{file_label(file)}.gif")
    if speed is not None and not 0.0 < speed < float("inf"):
        raise WrongUsageError(f"{speed} is not greater than 0", "--speed")
    animation.check_format(path)
    with replacing(path) as temporary, open_with_warning(file) as history:
        names = [str(name) for name in history["mesh"].values]
        if mesh is not None and mesh not in names:
            raise HistoryError(f"{file}: has no mesh `{mesh}`; there is {', '.join(names)}", USAGE)
        clip = animation.choose_clip(history, begin, end, fps, speed)
        if clip.advance > animation.BLURRED_ADVANCE:
            complain(
                f"{file}: teeth move {clip.advance:.2g} pitches from frame to frame and appear to "
                "jump; choose a smaller --speed, or write outputs more often"
            )
        number = None if mesh is None else names.index(mesh)
        animation.animate(history, temporary, clip, number, dpi, exaggerate)
    say(path)
