"""Published robots as ROBX: every row of the reference poses, position and rotation."""

from __future__ import annotations

import json

import numpy as np
import pytest

from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.machine import read_machine
from chainbuild.formats.text import is_sinumerik, read_source
from chainbuild.robot import Robot
from tests.kit.paths import REFERENCE

FILES = sorted(REFERENCE.glob("robx_*.tea"))


def test_there_are_reference_files():
    assert len(FILES) >= 3


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_reference_poses(path):
    source = read_source(path)
    assert is_sinumerik(source.text)
    robot = Robot(read_machine(source, path, Overlay(), Collector()).chain())
    reference = json.loads(path.with_suffix(".json").read_text())
    assert reference["rows"]
    for row in reference["rows"]:
        pose = robot.fk(row["axes"])
        assert np.abs(pose.translation * 1000 - row["p"]).max() <= 1e-6
        assert np.abs(pose.rotation - row["R"]).max() <= 1e-9
