"""Named poses of a chain: which one a text means, and that composing drops them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.check import check_chain
from chainbuild.chain.names import pose_named
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.errors import ChainError


def posed(*poses: NamedPose) -> chainbuild.Chain:
    return replace(chainbuild.load("ca_head_kin9").chain(), named_poses=poses)


def test_a_text_means_the_pose_of_that_name() -> None:
    chain = posed(*(NamedPose(name, (n, 0.0, 0.0, 0.0, 1.0)) for n, name in enumerate(("Park", "park", "Tool change"))))
    for text, first in (("Park", 0.0), (" park ", 1.0), ("TOOL change", 2.0)):
        found = pose_named(chain, text)
        assert found is not None
        np.testing.assert_array_equal(found, [first, 0.0, 0.0, 0.0, 1.0])
    for text in ("PARK", "toolchange", "0,0,0,0,1", ""):  # the first might mean two
        assert pose_named(chain, text) is None


def test_a_pose_has_a_value_for_each_axis() -> None:
    check_chain(posed(NamedPose("park", (0.0,) * 5)))
    with pytest.raises(ChainError, match="pose park has 4 values for 5 axes"):
        check_chain(posed(NamedPose("park", (0.0,) * 4)))


def test_a_composed_chain_has_no_poses_of_its_parts() -> None:
    head = posed(NamedPose("park", (0.0,) * 5))
    assert chainbuild.stack(head, np.eye(4), head).named_poses == ()
    assert chainbuild.follow(head, workpiece_of=head).named_poses == ()
