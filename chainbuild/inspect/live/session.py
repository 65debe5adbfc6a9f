"""What a live page shows, as Python has it: a machine with changed data and conventions, and where its axes stand."""

from __future__ import annotations

import hashlib
import json
import secrets
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from chainbuild.comparison.convention_trials import Selection
from chainbuild.convention import check_choice
from chainbuild.errors import ChainbuildError
from chainbuild.formats.entries import choose_kinematic
from chainbuild.inspect.export import model_data, page_html, shade_data
from chainbuild.inspect.live.contacts import Contacts
from chainbuild.inspect.live.datalist import DataList
from chainbuild.inspect.panel import conventions_html, findings_html, panel_html
from chainbuild.inspect.presets import presets_of
from chainbuild.inspect.scene import as_shown
from chainbuild.inspect.sweep import rest_pose
from chainbuild.painting.overlay.measures import Dimension, dimensions
from chainbuild.robot import Robot

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.formats.machine import Machine
    from chainbuild.inspect.playback import Playback
    from chainbuild.kinematics.mechanism import Mechanism

_FILE, _BESIDE = "file", "beside"  # names of the further robots in the scene


class Session:
    """The state of a live page; every tab shows the same. One thread at a time may use it.

    Args:
        machine: The machine as its file has it.
        selection: Which kinematic.
        conventions: Convention name → choice.
        at: Axis values (n_axes,), mm and degrees, at which the page opens; None: a pose that shows the machine well.
        playback: Rows of a table to play back.
        beside: A second machine in the same scene, moved by the axes of the same names.

    Attributes:
        name: Random; tells a page whether it has come back to the same session.
        number: Of the model; rises with each.
        axes: (n_axes,) axis values, mm and degrees.
        robot: The robot with its data as they are now.
        values: Data that are not as in the file: short name → value.
        choices: Conventions chosen: name → choice.

    Raises:
        ChainbuildError: the kinematic cannot be built, or has no pose to show.
    """

    def __init__(
        self,
        machine: Machine,
        selection: Selection | None = None,
        *,
        conventions: Mapping[str, str] | None = None,
        at: ArrayLike | None = None,
        playback: Playback | None = None,
        beside: Mechanism | None = None,
    ) -> None:
        self.name = secrets.token_hex(8)
        self.number = 0
        self._beside = None if beside is None else as_shown(beside)
        self._given = at is not None
        self._playback = playback
        self._open(machine, selection or Selection(), conventions or {})
        if at is not None:
            self.axes = self.robot.axis_values(at)

    def _open(self, machine: Machine, selection: Selection, conventions: Mapping[str, str]) -> None:
        """Show a machine as its file has it."""
        data = DataList(machine, selection)
        robot = Robot(data.chain({}, conventions))
        axes = rest_pose(as_shown(robot))
        self._machine, self._selection, self._list = machine, selection, data
        self.values: dict[str, float] = {}
        self._conventions = self.choices = dict(conventions)
        # What is chosen as the file has it is no change.
        self._usual = {one.convention.name: one.choice for one in robot.chain.conventions}
        self.axes = axes
        self._file_shade = shade_data(as_shown(robot), axes, _FILE)
        self._show(robot)

    def _show(self, robot: Robot) -> None:
        self.robot = robot
        self._contacts = Contacts(robot)
        self.number += 1

    def open_file(self, machine: Machine) -> None:
        """Show another machine, in a session of its own: as its file has it, without table and second machine.

        Raises:
            ChainbuildError: its kinematic cannot be built, or has no pose to show; the session stays as it was.
        """
        self._open(machine, Selection(), {})
        self._playback, self._beside, self._given = None, None, False
        self.name = secrets.token_hex(8)

    def choose_kinematic(self, n: int) -> None:
        """Show the n-th kinematic of the file, from 0, in a session of its own.

        Raises:
            ChainbuildError: there is none, it cannot be built, or has no pose to show; the session stays as it was.
        """
        entries = self._machine.kinematics()
        if not 0 <= n < len(entries):
            raise ChainbuildError(f"the file has no kinematic number {n}", permitted=f"0 … {len(entries) - 1}")
        one = entries[n]
        self._open(self._machine, Selection(one.name or one.id, one.channel, self._selection.tool_length_mm), {})
        self._playback, self._given = None, False
        self.name = secrets.token_hex(8)

    def move(self, axes: ArrayLike) -> None:
        """Take axis values (n_axes,), mm and degrees.

        Raises:
            AxisValueError: wrong count, or not finite.
        """
        self.axes = self.robot.axis_values(axes)

    def contacts(self) -> dict[str, Any]:
        """Return what touches where the axes stand; see `Contacts.at`."""
        return self._contacts.at(self.axes)

    def change(self, values: Mapping[str, float], choices: Mapping[str, str] | None = None) -> None:
        """Give some data other values, or choose conventions; what is left out stays as it is.

        Raises:
            ChainbuildError: there is no such datum or convention, or no such machine; the session stays as it was.
        """
        data = {**self.values, **{key: self._list.permitted(key, value) for key, value in values.items()}}
        self._rebuild(data, {**self.choices, **(choices or {})})

    def reset(self, key: str | None = None) -> None:
        """Give a datum the value of the file, or all of them and the conventions as the session began.

        Raises:
            ChainbuildError: there is no such datum or machine; the session stays as it was.
        """
        if key is None:
            self._rebuild({}, self._conventions)
        else:
            self._list.datum(key)
            self._rebuild({name: value for name, value in self.values.items() if name != key}, self.choices)

    def _rebuild(self, values: Mapping[str, float], choices: Mapping[str, str]) -> None:
        for name, choice in choices.items():
            check_choice(name, choice)
        changed = {key: value for key, value in values.items() if value != self._list.data[key].value}
        robot = Robot(self._list.chain(changed, choices))
        if len(robot.axes) != len(self.axes):
            raise ChainbuildError("the kinematic would have another number of axes: choose it when the page is started")
        self.values = changed
        self.choices = {
            name: choice
            for name, choice in choices.items()
            if name in self._conventions or self._usual.get(name) != choice
        }
        self._show(robot)

    def restore(self, values: Mapping[str, float], choices: Mapping[str, str], axes: ArrayLike) -> None:
        """Take the state that a page has kept of an earlier session of the same machine.

        Raises:
            ChainbuildError: it does not fit; the session stays as it was.
        """
        axes = self.robot.axis_values(axes)
        self.change(values, choices)
        self.axes = axes

    def moves(self, key: str) -> dict[str, Any]:
        """Return what a datum moves where the axes stand; see `DataList.moves`.

        Raises:
            ChainbuildError: there is no such datum.
        """
        return self._list.moves(key, self.values, self.choices, self.axes)

    def presets(self) -> list[dict[str, Any]]:
        """Return the named poses of the robot as it is now."""
        return presets_of(as_shown(self.robot), self.axes)

    def hello(self) -> dict[str, Any]:
        """Return by what a page knows the session, its machine and its model."""
        return {"session": self.name, "machine": self._identity(), "number": self.number, "axes": self.axes.tolist()}

    def model(self) -> dict[str, Any]:
        """Return the robot as it is now, to be shown in place of another of the same structure."""
        shown = as_shown(self.robot)
        chain = self.robot.chain
        data = model_data(shown, self._seen(shown), self._dimensions())
        panel = {"conventions": conventions_html(chain.conventions), "findings": findings_html(chain.findings)}
        return {**data, "live": {**self._live(shown), "html": panel}}

    def page(self, connects: str) -> str:
        """Return the page as HTML, which may connect to some addresses."""
        shown = as_shown(self.robot)
        further = {_FILE: self._file_shade}
        if self._beside is not None:
            further[_BESIDE] = {
                **shade_data(self._beside, rest_pose(self._beside), _BESIDE),
                "title": self._beside.chain.title,
            }
        live = {**self._live(shown), **self.hello(), "rows": self._list.rows(), "further": further}
        live["kinematics"] = self._kinematics()
        return page_html(
            shown,
            playback=self._playback,
            at=self._seen(shown),
            dimensions=self._dimensions(),
            more={"live": live, "given": self._given},
            connects=connects,
        )

    def _live(self, shown: Mechanism) -> dict[str, Any]:
        """Return what the page shows of the session, which changes with the model."""
        conventions = [
            {
                "name": one.convention.name,
                "choice": one.choice,
                "choices": list(one.convention.choices),
                "question": one.convention.question,
            }
            for one in self.robot.chain.conventions
        ]
        return {
            "number": self.number,
            "values": self.values,
            "choices": self.choices,
            "changed": bool(self.values) or self.choices != self._conventions,
            "conventions": conventions,
            "structure": _structure(shown.chain),
        }

    def _kinematics(self) -> list[dict[str, Any]]:
        """Return the kinematics that the page can show instead: those next to the machine."""
        every, one = self._machine.kinematics(), self._selection
        wanted = self._machine.overlay.kinematic if one.kinematic is None else one.kinematic
        channel = every[0].channel if one.channel is None else one.channel
        entries = [entry for entry in every if entry.channel == channel]
        shown = None if isinstance(wanted, tuple) else choose_kinematic(entries, wanted, self._machine.file)
        return [
            {"n": n, "text": f"{entry.label}: {entry.type}, channel {entry.channel}", "shown": entry is shown}
            for n, entry in enumerate(every)
            if entry.step == 0
        ]

    def _dimensions(self) -> tuple[Dimension, ...]:
        one = self._selection
        machine = self._list.machine(self.values)
        return dimensions(machine, one.kinematic, one.channel, one.tool_length_mm, self.choices)

    def _seen(self, shown: Mechanism) -> Vector:
        """Return axis values with a pose: where the axes stand, else a pose that shows the machine well."""
        return self.axes if np.isfinite(shown.chain.axis_map.q(self.axes)).all() else rest_pose(shown)

    def _identity(self) -> str:
        """Return what tells a machine and its kinematic from others: a page keeps its state for it alone."""
        text = json.dumps([str(self._machine.path.resolve()), repr(self._selection), self.robot.chain.kinematic])
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def _structure(chain: Chain) -> str:
    """Return what two chains share between which a page changes without being loaded anew."""
    parts = [
        panel_html(chain, 0.0, varying=False),
        [link.name for link in chain.links],
        [(joint.name, joint.kind, joint.parent, joint.child) for joint in chain.joints],
        repr(chain.display),
        [repr(one) for one in chain.constraints],
        [] if chain.drives is None else [type(chain.drives).__name__, list(chain.drives.differing)],
        [chain.task, chain.tool_column, chain.angle_mode, chain.has_status, bool(chain.loops)],
    ]
    return hashlib.sha256(json.dumps(parts, default=repr).encode()).hexdigest()[:16]
