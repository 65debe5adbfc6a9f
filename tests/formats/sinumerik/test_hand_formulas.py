"""ROBX against formulas written by hand from the manual, by somebody who had not seen the translator.

The machine goes the whole way: machine data as text, reader, typed data, chain, Pinocchio. Full poses are compared;
every number is drawn at random and non-zero, axes are reversed with offsets, every choice of every convention counts.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.convention import conventions
from tests.hand.robx_hand import parallelogram_angle_deg, pose_mm, scara_c_deg
from tests.kit.draws import seed_of
from tests.kit.straight import check_joint_values

MACHINES = 100
VECTORS = 100  # MACHINES × VECTORS = 10,000 poses
POSITION_MM = 1e-6
ROTATION = 1e-9

MainAxes = {"SS": 1, "CC": 2, "NR": 3, "SC": 4, "RR": 5, "CS": 6, "NN": 7}
LINEAR = {"SS": (0, 1, 2), "CC": (0,), "NR": (), "SC": (0, 1), "RR": (2,), "CS": (1, 2), "NN": ()}
SEQUENCES = {
    "SS": [[1, 2, 3], [2, 1, 3], [3, 2, 1], [2, 3, 1], [3, 1, 2], [1, 3, 2]],
    "CC": [[1, 2, 3], [2, 1, 3], [3, 2, 1], [2, 3, 1], [3, 1, 2], [1, 3, 2]],
    "SC": [[1, 2, 3], [2, 1, 3]],
    "CS": [[1, 2, 3], [1, 3, 2]],
}


def lengths(rng: np.random.Generator, n: int = 3) -> list[float]:
    return [round(float(rng.choice([-1, 1]) * rng.uniform(10, 600)), 3) for _ in range(n)]


def rpy(rng: np.random.Generator) -> list[float]:
    return [round(float(rng.uniform(-b, b)), 3) for b in (179, 89, 179)]


def wrist(rng: np.random.Generator, kind: int) -> dict[str, Any]:
    sign = int(rng.choice([-1, 1]))
    right, skew = (
        [-90.0 * sign, 90.0 * sign],
        [round(float(rng.uniform(20, 80)), 3) * sign, round(float(rng.uniform(-160, -100)), 3)],
    )
    if kind in (2, 3):
        return {"DHPAR4_5ALPHA": right if kind == 2 else skew}
    a, d = lengths(rng, 2), [0.0, lengths(rng, 1)[0]]
    return {"DHPAR4_5A": a, "DHPAR4_5D": d, "DHPAR4_5ALPHA": right if kind == 5 else skew}


def six_axis(rng: np.random.Generator, main: str, kind: int, track: bool = False) -> dict[str, Any]:
    """Draw the machine data of a six-axis robot with everything in it."""
    md: dict[str, Any] = {
        "KINCLASS": 1, "NUM_AXES": 6, "MAIN_AXES": MainAxes[main], "WRIST_AXES": kind, "A4PAR": 0,
        "AXES_TYPE": [1 if n in LINEAR[main] else 3 for n in range(6)],
        "MAIN_LENGTH_AB": [abs(v) for v in lengths(rng, 2)],
        "TROWO_POS": lengths(rng), "TROWO_RPY": rpy(rng), "TIRORO_POS": lengths(rng), "TIRORO_RPY": rpy(rng),
        "TX3P3_POS": lengths(rng), "TX3P3_RPY": rpy(rng), "TFLWP_POS": lengths(rng), "TFLWP_RPY": rpy(rng),
        "TTCFL_POS": lengths(rng), "TTCFL_RPY": rpy(rng), "TFL_EXT_RPY": rpy(rng),
        "MAMES": [round(float(rng.uniform(-90, 90)), 3) for _ in range(6)],
        "AXES_DIR": [int(rng.choice([-1, 1])) for _ in range(6)],
        **wrist(rng, kind),
    }  # fmt: skip
    if main in SEQUENCES:
        sequences = SEQUENCES[main]
        md["AXIS_SEQ"] = [*sequences[int(rng.integers(len(sequences)))], 4, 5, 6]
        # AXES_TYPE follows the machine axes: input axis AXIS_SEQ[i] is internal axis i.
        kinds = md["AXES_TYPE"]
        md["AXES_TYPE"] = [kinds[md["AXIS_SEQ"].index(n + 1)] for n in range(6)]
    return md


def axis_kinds(md: dict[str, Any]) -> list[int]:
    return list(md["AXES_TYPE"][: md["NUM_AXES"]])


def text_of(md: dict[str, Any]) -> str:
    assigned = md.get("TRAFO_AXES_IN", [n + 1 for n in range(md["NUM_AXES"])])
    lines = ["CHANDATA(1)", "$MC_TRAFO_TYPE_1=4100"]
    lines += [f"$MC_TRAFO_AXES_IN_1[{n}]={value}" for n, value in enumerate(assigned)]
    for name, value in md.items():
        if name == "TRAFO_AXES_IN" or name.startswith("TC_") or name == "G_PLANE":
            continue
        if isinstance(value, list):
            lines += [f"$MC_ROBX_{name}[{n}]={item}" for n, item in enumerate(value)]
        else:
            lines.append(f"$MC_ROBX_{name}={value}")
    return "\n".join([*lines, "M17", ""])


def random_axes(md: dict[str, Any], rng: np.random.Generator) -> list[float]:
    values = [rng.uniform(-800, 800) if kind == 1 else rng.uniform(-175, 175) for kind in axis_kinds(md)]
    for slot, axis in enumerate(md.get("TRAFO_AXES_IN", [])):
        if slot >= md["NUM_AXES"] and slot >= 6 and axis:
            values.append(rng.uniform(-800, 800) if slot < 9 else rng.uniform(-175, 175))
    return [float(value) for value in values]


def compare(
    md: dict[str, Any],
    folder: Path,
    rng: np.random.Generator,
    vectors: int,
    conv: dict[str, str],
    gripper: bool = False,
) -> None:
    path = folder / "machine.tea"
    path.write_text(text_of(md))
    robot = chainbuild.Robot(chainbuild.load(path).chain("gripper" if gripper else None, conventions=conv))
    check_joint_values(robot.chain, {f"EX{n}_table": f"EX{n}" for n in (1, 2, 3)})
    formula = {**md, "GRIP_REL_MOVE": int(gripper)}
    for _ in range(vectors):
        axes = random_axes(md, rng)
        T, wanted = robot.fk(axes), pose_mm(formula, axes, conv)
        where = f"{conv} {md} axes {axes}"
        np.testing.assert_allclose(T.translation * 1000.0, wanted[:3, 3], atol=POSITION_MM, rtol=0, err_msg=where)
        np.testing.assert_allclose(T.rotation, wanted[:3, :3], atol=ROTATION, rtol=0, err_msg=where)


@pytest.mark.parametrize("kind", [2, 3, 5, 6])
def test_nr_six_axes(kind: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("NR", kind))
    for _ in range(MACHINES // 4):
        compare(six_axis(rng, "NR", kind), tmp_path, rng, VECTORS, {})


@pytest.mark.parametrize("main", MainAxes)
@pytest.mark.parametrize("kind", [2, 3, 5, 6])
def test_every_arrangement_with_every_wrist(main: str, kind: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of(main, kind))
    for _ in range(10):
        compare(six_axis(rng, main, kind), tmp_path, rng, 20, {})


ARRANGEMENT_CHOICES = [
    ("SS", "ss"), ("CC", "cc_linear_sign"), ("CC", "cc_rotary_sign"), ("SC", "sc"), ("CS", "cs"), ("RR", "rr"),
    ("NN", "nn"),
    ("NR", "tfl_ext"), ("SC", "axes_dir_index"), ("CC", "axes_dir_index"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("main", "name", "choice"),
    [(main, name, choice) for main, name in ARRANGEMENT_CHOICES for choice in conventions()[name].choices],
)
def test_every_choice_of_an_arrangement(main: str, name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of(main, name, choice))
    for _ in range(10):
        md = six_axis(rng, main, 2)
        if (name, choice) == ("nn", "zyx"):
            md["TX3P3_RPY"] = rpy(rng)
        compare(md, tmp_path, rng, 20, {name: choice})


def four_axis(rng: np.random.Generator, main: str, kind: int) -> dict[str, Any]:
    """Draw a 4-axis robot within the manual's restrictions: Z3 along or across the last axis, base frames upright."""
    md = six_axis(rng, main, kind)
    last = {"SS": "z", "CC": "y", "NR": "y", "SC": "y", "RR": "y", "CS": "z", "NN": "z"}[main]
    parallel = bool(rng.integers(2))
    along = {"x": [0.0, 90.0, 0.0], "y": [0.0, 0.0, -90.0], "z": [0.0, 0.0, 0.0]}
    across = {"y": [0.0, 90.0, 0.0], "z": [0.0, 0.0, -90.0]}
    md |= {
        "NUM_AXES": 4,
        "A4PAR": int(parallel),
        "TX3P3_RPY": (along if parallel else across)[last],
        "TROWO_RPY": [0.0, 0.0, 0.0],
        "TIRORO_RPY": [round(float(rng.uniform(-179, 179)), 3) if main in ("NR", "RR", "CS", "NN") else 0.0, 0.0, 0.0],
        "AXES_TYPE": [*md["AXES_TYPE"][:4], 3, 3],
        "AXIS_SEQ": [*md.get("AXIS_SEQ", [1, 2, 3])[:3], 4, 5, 6],
    }
    return md


@pytest.mark.parametrize("main", MainAxes)
@pytest.mark.parametrize("kind", [1, 2, 3])
def test_four_axes(main: str, kind: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("four", main, kind))
    for _ in range(10):
        compare(four_axis(rng, main, kind), tmp_path, rng, 20, {})


@pytest.mark.parametrize("main", MainAxes)
@pytest.mark.parametrize("kind", [2, 3])
def test_five_axes(main: str, kind: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("five", main, kind))
    for _ in range(10):
        md = six_axis(rng, main, kind)
        md |= {
            "NUM_AXES": 5,
            "TFLWP_POS": [0.0, 0.0, lengths(rng, 1)[0]],
            "TFLWP_RPY": [round(float(rng.uniform(-179, 179)), 3), 0.0, 0.0],
            "AXES_TYPE": [*md["AXES_TYPE"][:5], 3],
        }
        compare(md, tmp_path, rng, 20, {})


@pytest.mark.parametrize("choice", conventions()["special_kin_2"].choices)
def test_parallelogram(choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("parallelogram", choice))
    for kind in (2, 3, 5, 6):
        for _ in range(10):
            md = six_axis(rng, "NR", kind) | {"SPECIAL_KIN": 2}
            compare(md, tmp_path, rng, 20, {"special_kin_2": choice})


@pytest.mark.parametrize("choice", conventions()["parallelogram_monitor"].choices)
def test_parallelogram_angle(choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("monitor", choice))
    for _ in range(20):
        md = six_axis(rng, "NR", 2) | {"SPECIAL_KIN": 2, "SW_LIMITS_PARALLEL": [-10.0, 200.0]}
        path = tmp_path / "machine.tea"
        path.write_text(text_of(md))
        (constraint,) = chainbuild.load(path).chain(conventions={"parallelogram_monitor": choice}).constraints
        assert (constraint.lower, constraint.upper) == (-10.0, 200.0)
        for _ in range(10):
            axes = random_axes(md, rng)
            wanted = parallelogram_angle_deg(md, axes, {"parallelogram_monitor": choice})
            assert constraint.sum.value(axes) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("choice", conventions()["table_origin"].choices)
def test_additional_axes_at_base_and_workpiece(choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("extra", choice))
    for slots in ((6,), (6, 7), (6, 7, 8), (9,), (9, 10), (9, 10, 11), (6, 7, 8, 9, 10, 11), (7, 10)):
        for main in ("NR", "SC"):
            md = with_extra_axes(six_axis(rng, main, 2), rng, slots)
            compare(md, tmp_path, rng, 20, {"table_origin": choice})


@pytest.mark.parametrize("slots", [(12,), (12, 13), (12, 13, 14), (6, 12, 13), (6, 7, 8, 9, 10, 11, 12, 13, 14)])
def test_additional_axes_at_the_flange(slots: tuple[int, ...], tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("flange", slots))
    for _ in range(5):
        compare(with_extra_axes(six_axis(rng, "NR", 2), rng, slots), tmp_path, rng, 20, {})


def with_extra_axes(md: dict[str, Any], rng: np.random.Generator, slots: tuple[int, ...]) -> dict[str, Any]:
    def direction() -> list[float]:
        vector = rng.normal(size=3)
        return [float(v) for v in vector / np.linalg.norm(vector)]

    md = dict(md)
    md["TRAFO_AXES_IN"] = [n + 1 if n < 6 or n in slots else 0 for n in range(15)]
    groups = {"EXT_AXIS": (6, 7, 8), "EXT_ROT_AX": (9, 10, 11), "EXT_FL_ROT_AX": (12, 13, 14)}
    for name, members in groups.items():
        if set(members) & set(slots):
            md |= {f"{name}_VECTOR_{n + 1}": direction() for n in range(3)}
    md["EXT_AX_OFFSET"] = lengths(rng)
    if set(slots) & {9, 10, 11}:
        md["EXT_ROT_AX_OFFSET"] = rpy(rng)
        for name in ("BASE_OFFSET", "JOINT_OFFSET_1", "JOINT_OFFSET_2", "PART_OFFSET"):
            md[f"EXT_ROT_{name}"] = lengths(rng)
    if set(slots) & {12, 13, 14}:
        md["EXT_FL_ROT_AX_OFFSET"] = rpy(rng)
        for name in ("BASE_OFFSET", "JOINT_OFF_1", "JOINT_OFF_2"):
            md[f"EXT_FL_ROT_{name}"] = lengths(rng)
    return md


def tool_data(rng: np.random.Generator, start: int) -> dict[str, Any]:
    md: dict[str, Any] = {"TC_DP3": lengths(rng, 1)[0], "TC_DP4": lengths(rng, 1)[0], "TC_DP5": lengths(rng, 1)[0]}
    if start > 0:
        md["TC_DPC"] = [0.0] * (start - 1) + rpy(rng) + [0.0] * (8 - start)
    if start == -1:
        md |= {
            "TC_DPV": [round(v, 3) for v in rng.normal(size=3)],
            "TC_DPVN": [round(v, 3) for v in rng.normal(size=3)],
        }
    return md | {"CC_TOA_START_NUM": start}


def tool_overlay(md: dict[str, Any]) -> str:
    lines = ["[tool]", f"plane = {md['G_PLANE']}", *(f"{name} = {md[name]}" for name in ("TC_DP3", "TC_DP4", "TC_DP5"))]
    lines += [f"TC_DPC{n + 1} = {value}" for n, value in enumerate(md.get("TC_DPC", []))]
    for name in ("TC_DPV", "TC_DPVN"):
        lines += [f"{name}{n + 3} = {value}" for n, value in enumerate(md.get(name, []))]
    return "\n".join([*lines, ""])


TOOL_CHOICES = [("", "")]
TOOL_CHOICES += [
    (name, choice) for name in ("tool_length_plane", "dpvn_axis", "tfl_ext") for choice in conventions()[name].choices
]


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("direction", [-1, 0, 1])
@pytest.mark.parametrize(("name", "choice"), TOOL_CHOICES)
def test_tools(plane: int, direction: int, name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("tool", plane, direction, name, choice))
    conv = {name: choice} if name else {}
    for start in (0, 1, 4, -1):
        md = six_axis(rng, "NR", 2) | tool_data(rng, start) | {"TOOL_DIR": direction, "G_PLANE": plane}
        (tmp_path / "machine.chainbuild.toml").write_text(tool_overlay(md))
        compare(md, tmp_path, rng, 10, conv)


GRIPPER_CHOICES = [("", "")]
GRIPPER_CHOICES += [
    (name, choice) for name in ("gripper_trowo", "gripper_flange_data") for choice in conventions()[name].choices
]


@pytest.mark.parametrize(("name", "choice"), GRIPPER_CHOICES)
def test_gripper_referred_motion(name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("gripper", name, choice))
    conv = {name: choice} if name else {}
    for slots in ((), (6, 7, 8)):
        for _ in range(5):
            md = with_extra_axes(six_axis(rng, "NR", 3), rng, slots) | tool_data(rng, 1) | {"G_PLANE": 17}
            (tmp_path / "machine.chainbuild.toml").write_text(tool_overlay(md))
            compare(md, tmp_path, rng, 20, conv, gripper=True)


SCARA_C = [
    (main, sum_, offset)
    for main in ("CC", "SC", "CS")
    for sum_ in conventions()["c_sum"].choices
    for offset in conventions()["c_offset"].choices
]


@pytest.mark.parametrize(("main", "c_sum", "c_offset"), SCARA_C)
def test_absolute_angle_c(main: str, c_sum: str, c_offset: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("C", main, c_sum, c_offset))
    conv = {"c_sum": c_sum, "c_offset": c_offset}
    done = 0
    while done < 5:
        md = four_axis(rng, main, 1) | {
            "SPECIAL_FEATURE_MASK": 1,
            "C_ANGLE_OFFSET": round(float(rng.uniform(-170, 170)), 3),
        }
        if not md["A4PAR"]:
            continue
        # C turns about X of the flange, which therefore lies along the rotary axes, either way round.
        md["TFLWP_RPY"] = [[0.0, -90.0, 180.0], [0.0, 90.0, 0.0]][int(rng.integers(2))]
        done += 1
        path = tmp_path / "machine.tea"
        path.write_text(text_of(md))
        absolute_c = chainbuild.load(path).chain(conventions=conv).absolute_c
        assert absolute_c is not None
        for _ in range(10):
            axes = [4.0 * value for value in random_axes(md, rng)]  # over several turns
            assert absolute_c.value(axes) == pytest.approx(scara_c_deg(md, axes, conv), abs=1e-9)


@pytest.mark.parametrize("direction", [-1, 0, 1])
def test_tool_length_adds_to_length_1(direction: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("length", direction))
    md = six_axis(rng, "NR", 2) | tool_data(rng, 1) | {"TOOL_DIR": direction, "G_PLANE": 17}
    path = tmp_path / "machine.tea"
    path.write_text(text_of(md))
    (tmp_path / "machine.chainbuild.toml").write_text(tool_overlay(md))
    robot = chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=123.4))
    axes = random_axes(md, rng)
    wanted = pose_mm(md | {"TC_DP3": md["TC_DP3"] + 123.4}, axes)
    np.testing.assert_allclose(robot.fk(axes).translation * 1000.0, wanted[:3, 3], atol=POSITION_MM)


@pytest.mark.parametrize("choice", conventions()["leftover_joint_offset"].choices)
def test_offsets_behind_the_last_additional_axis(choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("leftover", choice))
    for slots in ((9,), (9, 10), (10,), (9, 11), (12,), (12, 13), (9, 12)):
        md = with_extra_axes(six_axis(rng, "NR", 2), rng, slots)
        compare(md, tmp_path, rng, 10, {"leftover_joint_offset": choice})


@pytest.mark.parametrize("flange_data", conventions()["gripper_flange_data"].choices)
def test_gripper_referred_motion_with_rotary_additional_axes(flange_data: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("gripper axes", flange_data))
    conv = {"gripper_extra_axes": "built", "gripper_flange_data": flange_data}
    for slots in ((9,), (12,), (9, 10, 12, 13), (6, 9, 10, 11, 12, 13, 14)):
        for place in ("after_ttcfl", "after_fl", "orientation_only"):
            md = with_extra_axes(six_axis(rng, "NR", 2), rng, slots)
            compare(md, tmp_path, rng, 5, conv | {"tfl_ext": place}, gripper=True)
