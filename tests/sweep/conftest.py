"""The command evolvent-sweep as a fixture."""

from sweep_command import sweep

__all__ = ["sweep"]
