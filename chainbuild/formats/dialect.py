"""Which dialect a text is written in, told by its content, without a look at either dialect's own code."""

from __future__ import annotations

import re
from typing import Final

# Structures of a TwinCAT list that say something about kinematics, tools or axes; what else there is, is ignored.
TWINCAT_ROOTS: Final = frozenset(
    {
        "trafo", "kin_step", "kinematik", "trafo_pcs", "wz", "gruppe", "kenngr", "kopf", "kinematik_id",
        "kinematik_name", "default_id_of_kin_step", "default_name_of_kin_step", "ori_rotation_angle",
    }
)  # fmt: skip
_XML: Final = re.compile(r"\s*<(\?xml|!--|!DOCTYPE|TcSm|[A-Za-z])")
_TWINCAT: Final = re.compile(
    rf"^[ \t]*(?:{'|'.join(sorted(TWINCAT_ROOTS))})(?=[ \t\[.]|$)", re.MULTILINE | re.IGNORECASE
)
_SINUMERIK: Final = re.compile(
    r"\\?\$(?:M[NCA]|S[NCA]|TC|ON)_[A-Z]"
    r"|^[ \t]*(?:CHANDATA[ \t]*\(|%_N_\w|(?:ROBX|TRAFO6|TRAFO_TYPE)_[A-Z0-9]|(?:N|MD)[ \t]*62[69]\d\d\b)",
    re.IGNORECASE | re.ASCII | re.MULTILINE,
)


def is_xml(text: str) -> bool:
    """Return True where a text is XML."""
    return _XML.match(text) is not None


def is_twincat(text: str) -> bool:
    """Return True where a text is a TwinCAT CNC parameter list, or XML: a project that may hold one."""
    return is_xml(text) or _TWINCAT.search(text) is not None


def is_sinumerik(text: str) -> bool:
    r"""Tell by content whether a text holds SINUMERIK machine data.

    >>> is_sinumerik("N62905 $MC_ROBX_NUM_AXES=6"), is_sinumerik("trafo[0].id 9"), is_sinumerik("MD62905 6")
    (True, False, True)
    """
    return _SINUMERIK.search(text) is not None
