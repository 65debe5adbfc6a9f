"""Alarms the controller raises for the ROBX transformation, so that findings can name the one a file would cause."""

import string
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, Literal

AlarmClass = Literal["data", "path", "runtime"]
Reaction = Literal["interpreter_stop", "no_ready", "stop", "block_end", "show"]
Clear = Literal["power_on", "reset", "cancel"]


@dataclass(frozen=True, slots=True)
class Alarm:
    """One alarm of the ROBX transformation (ROBX manual 11.5).

    Attributes:
        number: Alarm number of the controller.
        text: Paraphrase with ``{names}`` for the controller's parameters.
        parameters: Those names in the controller's order (%1, %2, ...).
        alarm_class: ``data`` found in machine data, ``path`` found by running poses, ``runtime`` only listed.
        reaction: What the controller does.
        clear: How the alarm is cleared.
        remedy: What to do.
        manual: Sections of the ROBX manual.
    """

    number: int
    text: str
    parameters: tuple[str, ...]
    alarm_class: AlarmClass
    reaction: Reaction
    clear: Clear
    remedy: str
    manual: str

    def message(self, **values: object) -> str:
        """Fill the text with parameter values; a value that is not given shows as ``?``."""
        unknown = sorted(values.keys() - set(self.parameters))
        if unknown:
            raise ValueError(f"alarm {self.number} has no parameter {', '.join(unknown)}")
        filled = dict.fromkeys(self.parameters, "?") | {name: str(value) for name, value in values.items()}
        return string.Formatter().vformat(self.text, (), filled)


@cache
def alarms() -> Mapping[int, Alarm]:
    """Return the alarms of the ROBX transformation by number."""
    source = files("chainbuild.formats.sinumerik").joinpath("data", "alarms.toml")
    entries = [_alarm(entry) for entry in tomllib.loads(source.read_text(encoding="utf-8"))["alarm"]]
    return MappingProxyType({alarm.number: alarm for alarm in entries})


def _alarm(entry: Mapping[str, Any]) -> Alarm:
    sections = "11.5" if "manual" not in entry else f"11.5, {entry['manual']}"
    return Alarm(
        number=entry["number"],
        text=entry["text"],
        parameters=tuple(entry["parameters"]),
        alarm_class=entry["class"],
        reaction=entry["reaction"],
        clear=entry["clear"],
        remedy=entry["remedy"],
        manual=sections,
    )
