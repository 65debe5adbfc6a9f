"""Findings on a transformation: the same words for number, name and place of a machine datum everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from chainbuild.errors import ChainbuildError, MachineDataError
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.robx import Robx


@dataclass(frozen=True, slots=True)
class Report:
    """A transformation and where findings on it go."""

    robx: Robx
    collector: Collector

    def add(
        self,
        code: str,
        text: str,
        data: Sequence[str] = (),
        *,
        general: str | None = None,
        permitted: str | None = None,
        alarm: int | None = None,
        hint: str | None = None,
        error: type[ChainbuildError] = MachineDataError,
    ) -> None:
        """Add a finding.

        Args:
            code: Finding number.
            text: What is the matter.
            data: Names without ROBX_: the first is the parameter at fault, the first that the file gives the place.
            general: Name of a datum that is not ROBX's, in place of `data`.
            permitted: What would be accepted.
            alarm: The controller's alarm.
            hint: What to do.
            error: Class to raise at the strict door.
        """
        span = self.robx.span(*data)
        parameter = self.robx.parameter(data[0]) if data else None
        if general is not None:
            span = self.robx.data.span(general) or span
            parameter = f"$MC_{general}"
        self.collector.add(
            code, text, span=span, parameter=parameter, permitted=permitted, alarm=alarm, hint=hint, error=error
        )
