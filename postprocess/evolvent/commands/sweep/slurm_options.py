"""Options common to all commands that create Slurm jobs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

from evolvent.commands.command_line import option

if TYPE_CHECKING:
    from evolvent.sweep.slurm import Site


@dataclass(frozen=True)
class Order:
    """Options of Slurm jobs: each field is an option."""

    cpus: Annotated[int, option("--cores K", "Cores per shard.", min=1)] = 1
    submit: Annotated[bool, option("--submit", "Also submit the scripts.")] = False
    account: Annotated[str | None, option("--account", "Account, passed to Slurm.")] = None
    partition: Annotated[str | None, option("--partition", "Partition, passed to Slurm.")] = None
    time: Annotated[str | None, option("--time", "Time limit of a shard, passed to Slurm.")] = None
    options: Annotated[
        list[str] | None, option("--option KEY=VALUE", "Another #SBATCH option; may be repeated.")
    ] = None
    lines: Annotated[
        list[str] | None,
        option(
            "--line SHELL",
            "Additional line of the scripts, such as 'module load X'; may be repeated.",
        ),
    ] = None

    @property
    def site(self) -> Site:
        """Site-specific lines in the head of the scripts."""
        from evolvent.sweep.slurm import Site

        options, lines = tuple(self.options or ()), tuple(self.lines or ())
        return Site(self.account, self.partition, self.time, options, lines)


def with_options_of_slurm(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options of an `Order` to a command, which receives them as its argument `order`."""
    of_slurm = _parameters(Order)
    own = {name: one for name, one in _parameters(command).items() if name != "order"}

    @wraps(command)
    def with_options(**values: Any) -> None:
        order = Order(**{name: values[name] for name in of_slurm})
        command(**{name: values[name] for name in own}, order=order)

    shown = {**own, **of_slurm}
    with_options.__signature__ = Signature(list(shown.values()))  # type: ignore[attr-defined]
    with_options.__annotations__ = {name: one.annotation for name, one in shown.items()}
    return with_options


def _parameters(function: Callable[..., Any]) -> dict[str, Parameter]:
    """Return the parameters by name, as keyword-only ones, with evaluated annotations."""
    hints = get_type_hints(function, include_extras=True)
    return {
        name: one.replace(annotation=hints[name], kind=Parameter.KEYWORD_ONLY)
        for name, one in signature(function).parameters.items()
    }
