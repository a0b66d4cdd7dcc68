"""Python of a mutant's tree: an installation of evolvent in this environment would hide it."""

import sys

sys.meta_path[:] = [f for f in sys.meta_path if not type(f).__module__.startswith("_editable")]
