"""Chains of URDF files composed: what carries what weighs as before, and names of links and frames stay apart."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.compose import displaced, follow, stack
from chainbuild.chain.elements import Chain
from chainbuild.frames import rot_z, transform
from tests.kit.urdf_files import joint, link, written

LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
Y, Z = f'<axis xyz="0 1 0"/>{LIMIT}', f'<axis xyz="0 0 1"/>{LIMIT}'


def lift(folder: Path) -> Chain:
    """Return a carriage of 5 kg on a vertical slide."""
    return chainbuild.from_urdf(
        written(
            folder, link("carriage", 5, "0.1 0 0"), joint("Z", "prismatic", "column", "carriage", inside=Z), name="lift"
        )
    )


def arm(folder: Path) -> Chain:
    """Return an arm of 2 and 3 kg on a foot of 7 kg."""
    return chainbuild.from_urdf(
        written(
            folder,
            link("foot", 7, "0 0 0.1", "1 0 0 1 0 1"),
            link("upper", 2, "0.3 0 0", "0.1 0 0 0.2 0 0.3"),
            link("carriage", 3, "0.2 0 0.1", "0.1 0 0 0.2 0 0.3"),
            joint("A", "revolute", "foot", "upper", "0 0 0.4", Y),
            joint("B", "revolute", "upper", "hand", "0.6 0 0", Y),
            joint("f", "fixed", "hand", "carriage", "0.1 0 0"),
            name="arm",
        )
    )


def torques(chain: Chain, q: list[float]) -> dict[str, float]:
    model = chainbuild.Robot(chain).model
    found = pin.computeGeneralizedGravity(model, model.createData(), np.array(q))
    return dict(zip(list(model.names)[1:], found.tolist(), strict=True))


def test_a_lift_carries_the_whole_arm(tmp_path: Path) -> None:
    upper = displaced(arm(tmp_path), transform(rot_z(90.0), (0.5, 0.0, 0.2)))
    both = stack(lift(tmp_path), transform(rot_z(30.0), (0.1, 0.2, 0.3)), upper)
    assert {name: round(one.mass, 12) for name, one in both.geometry.inertias.items()} == {
        "carriage": 12.0, "upper": 2.0, "hand": 3.0,
    }  # fmt: skip
    found, alone = torques(both, [0.3, 0.4, -1.0]), torques(arm(tmp_path), [0.4, -1.0])
    assert found["Z"] == pytest.approx(9.81 * 17.0)
    assert (found["A"], found["B"]) == pytest.approx((alone["A"], alone["B"]))
    # The foot's centre of mass (0, 0, 0.1) by way of the workpiece: T_offset · T · centre, weighed with the carriage's.
    place = transform(rot_z(30.0), (0.1, 0.2, 0.3)) @ transform(rot_z(90.0), (0.5, 0.0, 0.2)) @ [0.0, 0.0, 0.1, 1.0]
    expected = (5.0 * np.array([0.1, 0.0, 0.0]) + 7.0 * place[:3]) / 12.0
    np.testing.assert_allclose(both.geometry.inertias["carriage"].centre, expected, atol=1e-15)
    frames, links = {frame.name for frame in both.frames}, {one.name for one in both.links}
    assert not frames & links - {"base"}


def test_links_that_are_turned_round_keep_their_masses_where_they_are(tmp_path: Path) -> None:
    """The workpiece of the arm rides on the lift: carried by it, arm and lift hang on the carriage in turn."""
    guest = follow(arm(tmp_path), workpiece_of=lift(tmp_path))
    rail = chainbuild.from_urdf(
        written(tmp_path, joint("R", "prismatic", "rail", "runner", inside=Z), link("runner", 4), name="rail")
    )
    both = stack(rail, transform(rot_z(20.0), (0.1, 0.2, 0.3)), guest)
    axes = [100.0, -200.0, 30.0]
    expected, found = (centres(one, values) for one, values in ((guest, axes), (both, [50.0, *axes])))
    np.testing.assert_allclose(found, expected, atol=1e-15)
    assert both.geometry.inertias["runner"].mass == pytest.approx(9.0)  # with the carriage


def centres(chain: Chain, axes: list[float]) -> np.ndarray:
    """Return (3, 3) where upper, hand and foot of the arm have their centres, seen from the column of the lift [m]."""
    placed, inertias = chainbuild.Robot(chain).frame_placements(axes), chain.geometry.inertias
    links = ("upper", "hand", chain.frame("foot").link)
    return np.array([placed["column"].inverse() * placed[name] * inertias[name].centre for name in links])
