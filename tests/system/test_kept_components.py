"""Checkpoints contain all variable components of an integration; exceptions are listed by name.

A component added to one of these types or structs must be saved, or listed here with the reason.
Otherwise a resumed run would differ, but only in cases that use that component.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

PATTERN = "found from the model's pattern at creation"
GIVEN = "given at creation, and the same for the same case"
SCRATCH = "scratch, filled before it is read"


def alike(reason: str, names: str) -> dict[str, str]:
    """Names with one reason."""
    return dict.fromkeys(names.split(), reason)


#: type: file of the type, file and name of the procedure that saves it, prefix of its
#: components there, and components that are not saved.
TYPES: dict[str, tuple[str, str, str, str, dict[str, str]]] = {
    "radau_t": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "serialize_radau",
        "self",
        {
            **alike(GIVEN, "options limited"),
            **alike("of one step", "refusal refused_t refused_y"),
        },
    ),
    "step_control_t": (
        "integrator/step_control.f90",
        "integrator/radau_archive.f90",
        "serialize_radau",
        "self%control",
        {},
    ),
    "radau_growth": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "serialize_radau",
        "self%fastest_growth",
        {},
    ),
    "radau_counts": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "serialize_radau",
        "self%counts",
        {},
    ),
    "stage_solver_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "serialize_(?:stages|arrays)",
        "self",
        {
            "n": GIVEN,
            "integrals": f"{PATTERN}, and scratch",
            "row": PATTERN,
            "column": PATTERN,
            "rounding": f"{PATTERN}, and scratch",
            "error_weight": SCRATCH,
            "tolerance": GIVEN,
            "output_factor": GIVEN,
            "newton_stop": GIVEN,
            "times": SCRATCH,
        },
    ),
    "stage_counts": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "serialize_stages",
        "self%counts",
        {},
    ),
    "continuation_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "serialize_stages",
        "self%continuation",
        {},
    ),
    "linear_prediction_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "serialize_stages",
        "self%linear",
        {},
    ),
    "condensed_t": (
        "integrator/condensed_systems.f90",
        "integrator/factor_archive.f90",
        "serialize_condensed",
        "self",
        alike(
            PATTERN,
            "n retained kinematic partner rate_entry row column inner_entry inner_index"
            " coupling_start coupling_entry coupling_from coupling_index is_inverted",
        ),
    ),
    "sparse_lu_t": (
        "integrator/sparse_lu.f90",
        "integrator/factor_archive.f90",
        "serialize_sparse",
        "self",
        alike(PATTERN, "n component row_start diagonal column unknown index target"),
    ),
    "dense_lu_t": (
        "integrator/dense_lu.f90",
        "integrator/factor_archive.f90",
        "serialize_dense",
        "self",
        {"n": GIVEN},
    ),
    "root_finder_t": (
        "integrator/root_finder.f90",
        "integrator/search_archive.f90",
        "serialize_roots",
        "self",
        {"n": GIVEN},
    ),
    "extreme_finder_t": (
        "integrator/extreme_finder.f90",
        "integrator/search_archive.f90",
        "serialize_extremes",
        "self",
        {"to_between": GIVEN, "is_rough": GIVEN},
    ),
    "growth_t": (
        "integrator/growth.f90",
        "integrator/growth.f90",
        "serialize_growth",
        "self",
        {
            **alike(PATTERN, "n row column entry scale"),
            **alike(
                SCRATCH,
                "product x_piece matrix eigenvalue_re eigenvalue_im length difference jacobian",
            ),
        },
    ),
    "known_piece_t": (
        "integrator/growth.f90",
        "integrator/growth.f90",
        "serialize_piece",
        "self",
        alike(PATTERN, "entry row column"),
    ),
    "gearbox_ode": (
        "gearbox/gearbox_ode.f90",
        "gearbox/gearbox_ode_archive.f90",
        "serialize_gearbox_ode",
        "self",
        alike(GIVEN, "gearbox cycle entries constants in_lanes"),
    ),
    "integration_t": (
        "capi/capi_radau.f90",
        "capi/capi_radau.f90",
        "evl_radau_serialize",
        "self",
        {"found": SCRATCH, "status": "cleared before each step"},
    ),
}

#: Saved as raw memory.
PLAIN_TYPES = ("lane_slot",)

#: struct: its file, file and function that saves it, and members that are not saved.
STRUCTS: dict[str, tuple[str, str, str, dict[str, str]]] = {
    "integration": (
        "integrate/integration.h",
        "integrate/integration.c",
        "integration_serialize",
        {
            **alike(GIVEN, "model options"),
            "reason": "of the result",
            **alike(SCRATCH, "arena fired events trial old lanes"),
            "cpu_start": "found from the processor time in the counts",
        },
    ),
    "output_grid": (
        "integrate/output_grid.h",
        "integrate/output_grid.c",
        "output_grid_serialize",
        {"options": GIVEN},
    ),
    "position_grid": (
        "integrate/position_grid.h",
        "integrate/position_grid.c",
        "position_grid_serialize",
        alike(GIVEN, "model per_unit position_of t_end"),
    ),
    "simulation": (
        "simulate/simulate.c",
        "simulate/simulate.c",
        "serialize",
        {
            "plan": GIVEN,
            "outputs": "none are left: they are given before",
            "reason": "of the result",
            "stop": "a run that goes on has not been stopped",
            "is_cut": "nor cut",
        },
    ),
    "separation_monitor": (
        "simulate/separation_monitor.h",
        "simulate/separation_monitor.c",
        "separation_monitor_serialize",
        alike(GIVEN, "n_meshes opened closed impact index"),
    ),
    "invariant_monitor": (
        "simulate/invariant_monitor.c",
        "simulate/invariant_monitor.c",
        "invariant_monitor_serialize",
        alike(GIVEN, "n_wheels n_meshes tolerance is_tracked offsets constants"),
    ),
    "positions_counts": (
        "simulate/positions.h",
        "simulate/positions.c",
        "positions_serialize",
        {"rule": GIVEN},
    ),
    "extremes": (
        "simulate/extremes.c",
        "simulate/extremes.c",
        "extremes_serialize",
        alike(GIVEN, "arena from to"),
    ),
    "extreme_channels": (
        "simulate/extreme_channels.h",
        "simulate/extreme_channels.c",
        "extreme_channels_serialize",
        {
            **alike(GIVEN, "dae arena n n_padded n_in_group states first_state"),
            "y": SCRATCH,
        },
    ),
    "channel_past": (
        "simulate/extremes_by_ends.h",
        "simulate/extremes_by_ends.c",
        "channel_past_serialize",
        {},
    ),
    "metrics": (
        "simulate/metrics.c",
        "simulate/metrics.c",
        "metrics_serialize",
        {
            **alike(GIVEN, "arena model window closed impact"),
            **alike(SCRATCH, "angles values"),
            "settled": "found by metrics_judge at the end",
        },
    ),
    "metric_sums": (
        "simulate/metric_sums.h",
        "simulate/metric_sums.c",
        "metric_sums_serialize",
        {
            **alike(GIVEN, "model taken n_meshes n_channels n_pairs first indices"),
            "nodes": SCRATCH,
            "channels": "one by one, as of `sums_channel`",
        },
    ),
    "sums_channel": (
        "simulate/metric_sums.c",
        "simulate/metric_sums.c",
        "metric_sums_serialize",
        alike(GIVEN, "quantity element value"),
    ),
}

STRUCTS["statistics"] = (
    "batch/batch_statistics.c",
    "batch/batch_statistics.c",
    "statistics_serialize",
    {
        **alike(GIVEN, "table from to"),
        **alike("retained by the simulation", "extremes metrics"),
    },
)
STRUCTS["batch_sink"] = (
    "batch/batch_case.c",
    "batch/batch_case.c",
    "serialize",
    {
        **alike(GIVEN, "plan arena requested columns"),
        "checkpointer": "what is about the checkpoints, and serialize_head",
    },
)

#: Saved as raw memory, so that they may hold no pointer.
PLAIN_STRUCTS = {
    "integrate_counts": "integrate/dae.h",
    "dae_growth": "integrate/dae.h",
    "accumulator": "batch/batch_statistics.c",
    "separation_monitor_mesh": "simulate/separation_monitor.h",
    "of_wheel": "simulate/invariant_monitor.c",
    "of_mesh": "simulate/invariant_monitor.c",
    "metric_waves": "simulate/metric_channel.h",
    "channel_sums": "simulate/metric_channel.h",
    "metric_channel": "simulate/metric_channel.h",
    "mesh_sums": "simulate/mesh_metrics.h",
    "mesh_metrics": "simulate/mesh_metrics.h",
}


def fortran_type(name: str, path: Path) -> tuple[str | None, list[tuple[str, str]]]:
    """Parent of a type, and its components: declaration and name."""
    text = re.sub(r"!.*", "", path.read_text()).replace("&\n", " ")
    found = re.search(rf"^ *type(.*?):: {name}\n(.*?)^ *end type {name}", text, re.M | re.S)
    assert found, f"{path} has no type {name}"
    parent = re.search(r"extends\((\w+)\)", found[1])
    components = []
    body = re.split(r"^ *contains", found[2], flags=re.M)[0]
    for line in filter(str.strip, body.splitlines()):
        declaration, names = line.split("::")
        flat = re.sub(r"\([^()]*\)", "", re.sub(r"\([^()]*\)", "", names))
        components += [(declaration, part.split("=")[0].strip()) for part in flat.split(",")]
    return parent[1] if parent else None, components


def fortran_procedures(pattern: str, path: Path) -> str:
    """Text of the procedures with these names."""
    text = re.sub(r"!.*", "", path.read_text())
    begin = rf"(?:module procedure|subroutine|function) {pattern}\b"
    found = re.findall(rf"{begin}.*?^ *end (?:procedure|subroutine|function)", text, re.M | re.S)
    assert found, f"{path} has no procedure {pattern}"
    return "".join(found)


def c_struct(name: str, path: Path) -> dict[str, str]:
    """Members of a struct: name and declaration."""
    text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S)
    braces = r"\{((?:[^{}]|\{[^{}]*\})*)\}"
    found = (
        re.search(rf"typedef struct \w* ?{braces} {name};", text)
        or re.search(rf"typedef struct {braces} {name};", text)
        or re.search(rf"struct {name} {braces}", text)
    )
    assert found, f"{path} has no struct {name}"
    if row := re.search(r"#define (\w+)\(", found[1]):  # a member for each row of a table
        rows = re.findall(rf"^ +{row[1]}\((\w+), (\w+),", text, re.M)
        return {member: f"{kind} {member}" for kind, member in rows}
    body = re.sub(r"\{[^{}]*\}", " ", found[1])
    members = {}
    for declaration in filter(str.strip, body.split(";")):
        flat = re.sub(r"\[[^]]*\]|_Alignas\(\w+\)", "", " ".join(declaration.split()))
        for part in flat.split(","):
            members[re.findall(r"\w+", part)[-1]] = flat
    return members


def c_function(name: str, path: Path) -> str:
    """Text of a function."""
    found = re.search(rf"^[\w ]+\b\*?{name}\([^)]*\)\n\{{\n.*?^\}}", path.read_text(), re.M | re.S)
    assert found, f"{path} has no function {name}"
    return found[0]


@pytest.mark.parametrize("name", TYPES)
def test_every_component_of_a_type_is_kept_or_known_not_to_change(name: str) -> None:
    of_type, of_checkpointer, checkpointer, before, constants = TYPES[name]
    parent, components = fortran_type(name, ROOT / "src" / of_type)
    retained = fortran_procedures(checkpointer, ROOT / "src" / of_checkpointer)
    names = {component for _, component in components}
    things = re.findall(
        r"call serialize\w*\(archive, (?:size\([^()]*\), |.*c_loc\()?([\w%]+)", retained
    )
    of_self = {
        thing.removeprefix(before + "%").split("%")[0]
        for thing in things
        if thing.startswith(before + "%")
    }
    assert names - of_self == set(constants)
    assert parent in (None, "ode_model", "stage_counts", "piece_t")  # these do not change


@pytest.mark.parametrize("name", TYPES)
def test_a_type_within_a_kept_one_is_kept_too(name: str) -> None:
    of_type, _, _, _, constants = TYPES[name]
    _, components = fortran_type(name, ROOT / "src" / of_type)
    inner = {
        kind
        for declaration, component in components
        if component not in constants
        for kind in re.findall(r"type\((\w+)\)", declaration)
    }
    assert inner <= {*TYPES, *PLAIN_TYPES}


def test_what_is_kept_as_it_lies_in_memory_lies_there_as_a_whole() -> None:
    """No component is allocated elsewhere, at any depth."""
    files = [*(ROOT / "src").rglob("*.f90")]
    texts = {path: path.read_text() for path in files}
    todo, seen = list(PLAIN_TYPES), set()
    while todo:
        name = todo.pop()
        seen.add(name)
        path = next(p for p in files if re.search(rf"^ *type.*:: {name}$", texts[p], re.M))
        parent, components = fortran_type(name, path)
        todo += [parent] if parent and parent not in seen else []
        for declaration, component in components:
            assert not re.search("allocatable|pointer|class", declaration), (name, component)
            todo += re.findall(r"type\((\w+)\)", declaration)
    assert {"contact_mode", "lane_contact", "lane_context", "lane_edge", "lane_force"} <= seen


@pytest.mark.parametrize("name", STRUCTS)
def test_every_member_of_a_struct_is_kept_or_known_not_to_change(name: str) -> None:
    of_struct, of_checkpointer, checkpointer, constants = STRUCTS[name]
    retained = c_function(checkpointer, ROOT / "driver" / of_checkpointer)
    members = c_struct(name, ROOT / "driver" / of_struct)
    calls = r"SERIALIZE(?:_ARRAY)?\(archive, ([^,;]*?)[,)]|serialize\(&?([^,;]*?),"
    things = [first or second for first, second in re.findall(calls, retained)]
    named = {word for thing in things for word in re.findall(r"(?:->|\.)(\w+)", thing)}
    assert set(members) - named == set(constants)


@pytest.mark.parametrize("name", PLAIN_STRUCTS)
def test_a_struct_that_is_kept_as_it_lies_in_memory_holds_no_pointer(name: str) -> None:
    members = c_struct(name, ROOT / "driver" / PLAIN_STRUCTS[name])
    assert members
    for declaration in members.values():
        assert "*" not in declaration
        kind = declaration.split()[0]
        assert kind in ("bool", "int", "long", "double", *PLAIN_STRUCTS), declaration
