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
            "-o --output PATH",
            "File to write, .gif or .mp4; if not given, the name of the history with .gif.",
        ),
    ] = None,
    mesh: Annotated[
        str | None,
        option("--mesh NAME", "Show only this mesh, enlarged; if not given, the whole gearbox."),
    ] = None,
    begin: Annotated[float | None, option("--from TIME", "Start time [s].")] = None,
    end: Annotated[
        float | None,
        option(
            "--to TIME",
            "End time [s]. Without --to and --speed: the end of the history, or for fast wheels "
            "the latest time that 120 frames can reach.",
        ),
    ] = None,
    fps: Annotated[float, option("--fps", "Frames per second.", min=1.0, max=50.0)] = 20.0,
    speed: Annotated[
        float | None,
        option(
            "--speed X",
            "Simulated seconds per second of the animation: 0.01 shows the motion 100 times "
            "slower; if not given, for 120 frames.",
        ),
    ] = None,
    dpi: Annotated[
        int,
        option(
            "--dpi",
            "Resolution of the frames, 7.2 inches wide, in pixels per inch.",
            min=30,
            max=400,
        ),
    ] = 100,
    exaggerate: Annotated[
        float,
        option(
            "--exaggerate X",
            "Magnification of tip relief, root relief and profile crowning. Pitch errors and "
            "runout are not shown.",
            min=0.0,
        ),
    ] = 1.0,
) -> None:
    """Write an animation of the rotating wheels and the tooth forces.

    \b
    Teeth are drawn to scale. The length of an arrow is proportional to the force. Each frame shows
    one output of the history. MP4 requires the program ffmpeg.
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
