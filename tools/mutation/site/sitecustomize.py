"""Remove editable installations of evolvent, which would hide the Python of a mutant's tree."""

import sys

sys.meta_path[:] = [f for f in sys.meta_path if not type(f).__module__.startswith("_editable")]
