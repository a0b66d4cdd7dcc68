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
ROOM = "scratch, filled before it is read"


def alike(reason: str, names: str) -> dict[str, str]:
    """Names with one reason."""
    return dict.fromkeys(names.split(), reason)


#: type: file of the type, file and name of the procedure that saves it, prefix of its
#: components there, and components that are not saved.
TYPES: dict[str, tuple[str, str, str, str, dict[str, str]]] = {
    "radau_t": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "keep_radau",
        "self",
        {
            **alike(GIVEN, "options limited"),
            **alike("of one step", "refusal refused_t refused_y"),
        },
    ),
    "step_control_t": (
        "integrator/step_control.f90",
        "integrator/radau_archive.f90",
        "keep_radau",
        "self%control",
        {},
    ),
    "radau_growth": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "keep_radau",
        "self%fastest_growth",
        {},
    ),
    "radau_counts": (
        "integrator/radau.f90",
        "integrator/radau_archive.f90",
        "keep_radau",
        "self%counts",
        {},
    ),
    "stage_solver_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "keep_(?:stages|arrays)",
        "self",
        {
            "n": GIVEN,
            "integrals": f"{PATTERN}, and scratch",
            "row": PATTERN,
            "column": PATTERN,
            "rounding": f"{PATTERN}, and scratch",
            "error_weight": ROOM,
            "tolerance": GIVEN,
            "output_factor": GIVEN,
            "newton_stop": GIVEN,
            "times": ROOM,
        },
    ),
    "stage_counts": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "keep_stages",
        "self%counts",
        {},
    ),
    "continuation_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "keep_stages",
        "self%continuation",
        {},
    ),
    "linear_prediction_t": (
        "integrator/stage_solver.f90",
        "integrator/stage_archive.f90",
        "keep_stages",
        "self%linear",
        {},
    ),
    "condensed_t": (
        "integrator/condensed_systems.f90",
        "integrator/factor_archive.f90",
        "keep_condensed",
        "self",
        alike(
            PATTERN,
            "n kept kinematic partner rate_entry row column inner_entry inner_place coupling_start"
            " coupling_entry coupling_from coupling_place is_inverted",
        ),
    ),
    "sparse_lu_t": (
        "integrator/sparse_lu.f90",
        "integrator/factor_archive.f90",
        "keep_sparse",
        "self",
        alike(PATTERN, "n component row_start diagonal column unknown index target"),
    ),
    "dense_lu_t": (
        "integrator/dense_lu.f90",
        "integrator/factor_archive.f90",
        "keep_dense",
        "self",
        {"n": GIVEN},
    ),
    "root_finder_t": (
        "integrator/root_finder.f90",
        "integrator/search_archive.f90",
        "keep_roots",
        "self",
        {"n": GIVEN},
    ),
    "extreme_finder_t": (
        "integrator/extreme_finder.f90",
        "integrator/search_archive.f90",
        "keep_extremes",
        "self",
        {"to_between": GIVEN, "is_rough": GIVEN},
    ),
    "growth_t": (
        "integrator/growth.f90",
        "integrator/growth.f90",
        "keep_growth",
        "self",
        {
            **alike(PATTERN, "n row column entry scale"),
            **alike(
                ROOM,
                "product x_piece matrix eigenvalue_re eigenvalue_im length difference jacobian",
            ),
        },
    ),
    "known_piece_t": (
        "integrator/growth.f90",
        "integrator/growth.f90",
        "keep_piece",
        "self",
        alike(PATTERN, "entry row column"),
    ),
    "gearbox_ode": (
        "gearbox/gearbox_ode.f90",
        "gearbox/gearbox_ode_archive.f90",
        "keep_gearbox_ode",
        "self",
        alike(GIVEN, "gearbox cycle entries constants in_lanes"),
    ),
    "integration_t": (
        "api/capi_radau.f90",
        "api/capi_radau.f90",
        "evl_radau_keep",
        "self",
        {"found": ROOM, "status": "cleared before each step"},
    ),
}

#: Saved as raw memory.
PLAIN_TYPES = ("lane_slot",)

#: struct: its file, file and function that saves it, and members that are not saved.
STRUCTS: dict[str, tuple[str, str, str, dict[str, str]]] = {
    "integration": (
        "integrate/integration.h",
        "integrate/integration.c",
        "integration_keep",
        {
            **alike(GIVEN, "model options"),
            "reason": "of the result",
            **alike(ROOM, "pool fired events trial old lanes"),
            "cpu_start": "found from the processor time in the counts",
        },
    ),
    "output_grid": (
        "integrate/output_grid.h",
        "integrate/output_grid.c",
        "output_grid_keep",
        {"options": GIVEN},
    ),
    "position_grid": (
        "integrate/position_grid.h",
        "integrate/position_grid.c",
        "position_grid_keep",
        alike(GIVEN, "model per_unit position_of t_end"),
    ),
    "simulation": (
        "simulate/simulate.c",
        "simulate/simulate.c",
        "keep",
        {
            "prepared": GIVEN,
            "outputs": "none are left: they are given before",
            "reason": "of the result",
            "stop": "a run that goes on has not been stopped",
            "is_cut": "nor cut",
        },
    ),
    "contact_watch": (
        "simulate/contact_watch.h",
        "simulate/contact_watch.c",
        "contact_watch_keep",
        alike(GIVEN, "n_meshes opened closed impact place"),
    ),
    "invariant_watch": (
        "simulate/invariant_watch.c",
        "simulate/invariant_watch.c",
        "invariant_watch_keep",
        alike(GIVEN, "n_wheels n_meshes tolerance is_tracked places constants"),
    ),
    "positions_watch": (
        "simulate/positions.h",
        "simulate/positions.c",
        "positions_keep",
        {"rule": GIVEN},
    ),
    "extremes": (
        "simulate/extremes.c",
        "simulate/extremes.c",
        "extremes_keep",
        alike(GIVEN, "pool from to"),
    ),
    "extreme_channels": (
        "simulate/extreme_channels.h",
        "simulate/extreme_channels.c",
        "extreme_channels_keep",
        {
            **alike(GIVEN, "dae pool n n_padded n_in_group states first_state"),
            "y": ROOM,
        },
    ),
    "channel_past": (
        "simulate/extremes_by_ends.h",
        "simulate/extremes_by_ends.c",
        "channel_past_keep",
        {},
    ),
    "numbers": (
        "simulate/numbers.c",
        "simulate/numbers.c",
        "numbers_keep",
        {
            **alike(GIVEN, "pool model window closed impact"),
            **alike(ROOM, "angles values"),
            "settled": "found by numbers_judge at the end",
        },
    ),
    "number_sums": (
        "simulate/number_sums.h",
        "simulate/number_sums.c",
        "number_sums_keep",
        {
            **alike(GIVEN, "model taken n_meshes n_channels n_pairs first places"),
            "nodes": ROOM,
            "channels": "one by one, as of `sums_channel`",
        },
    ),
    "sums_channel": (
        "simulate/number_sums.c",
        "simulate/number_sums.c",
        "number_sums_keep",
        alike(GIVEN, "quantity element value"),
    ),
}

STRUCTS["statistics"] = (
    "batch/batch_statistics.c",
    "batch/batch_statistics.c",
    "statistics_keep",
    {
        **alike(GIVEN, "table from to"),
        **alike("kept by the simulation", "extremes numbers"),
    },
)
STRUCTS["batch_sink"] = (
    "batch/batch_case.c",
    "batch/batch_case.c",
    "keep",
    {
        **alike(GIVEN, "plan pool wanted places"),
        "keeper": "what is about the checkpoints, and keep_head",
    },
)

#: Saved as raw memory, so that they may hold no pointer.
PLAIN_STRUCTS = {
    "integrate_counts": "integrate/dae.h",
    "dae_growth": "integrate/dae.h",
    "accumulator": "batch/batch_statistics.c",
    "contact_watch_mesh": "simulate/contact_watch.h",
    "of_wheel": "simulate/invariant_watch.c",
    "of_mesh": "simulate/invariant_watch.c",
    "number_waves": "simulate/number_channel.h",
    "channel_sums": "simulate/number_channel.h",
    "number_channel": "simulate/number_channel.h",
    "mesh_sums": "simulate/mesh_numbers.h",
    "mesh_numbers": "simulate/mesh_numbers.h",
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
    of_type, of_keeper, keeper, before, constants = TYPES[name]
    parent, components = fortran_type(name, ROOT / "src" / of_type)
    kept = fortran_procedures(keeper, ROOT / "src" / of_keeper)
    names = {component for _, component in components}
    things = re.findall(r"call keep\w*\(archive, (?:size\([^()]*\), |.*c_loc\()?([\w%]+)", kept)
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
    files = [*(ROOT / "src").glob("*/*.f90")]
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
    of_struct, of_keeper, keeper, constants = STRUCTS[name]
    kept = c_function(keeper, ROOT / "driver" / of_keeper)
    members = c_struct(name, ROOT / "driver" / of_struct)
    calls = r"KEEP(?:_ARRAY)?\(archive, ([^,;]*?)[,)]|keep\(&?([^,;]*?),"
    things = [first or second for first, second in re.findall(calls, kept)]
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
