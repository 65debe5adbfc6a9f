"""Text files that are no machine data: told for what they are, with what could be done."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

from chainbuild.errors import ChainbuildError, ParseError, Span
from chainbuild.formats.overlay import SUFFIX
from chainbuild.formats.text import SourceText, is_dh, xml_root

_AS_URDF: Final = "export the robot as URDF where the model comes from, and give that"
_AS_BODY: Final = "give the machine data, and name this file as a body in [geometry] of the overlay"
_MACHINE_DATA: Final = "give the machine data: SINUMERIK, TwinCAT, a Denavit-Hartenberg table or a URDF"

# Outermost element of an XML file → what it is, what could be done.
_XML_KINDS: Final = {
    "mujoco": ("MJCF, a model of MuJoCo", _AS_URDF),
    "mujocoinclude": ("MJCF, a part of a model of MuJoCo", _AS_URDF),
    "sdf": ("SDF, a model of Gazebo", _AS_URDF),
    "gazebo": ("SDF, a model of Gazebo", _AS_URDF),
    "COLLADA": ("a mesh (COLLADA)", _AS_BODY),
    "launch": ("a launch file of ROS", "give the URDF that it loads"),
    "package": ("a package file of ROS", "give a URDF of the package"),
    "svg": ("a picture (SVG)", _MACHINE_DATA),
    "html": ("a web page", _MACHINE_DATA),
    "plist": ("a property list", _MACHINE_DATA),
}
_HEAD_CHARACTERS: Final = 20_000  # enough to tell what a text is
_DRAWING: Final = "it holds shapes and no joints: give the machine data, and a mesh of it in [geometry] of the overlay"
_BLOCK: Final = r"(?:N\d+ ?)?(?:G\d{1,3}\b|[XYZ]-?\d[\d.]* +[XYZ]-?\d|TRAORI\b|#(?:TRAFO|KIN ID)\b)"
# First match counts: how a text begins, or what it has → what it is, what could be done.
_KINDS: Final = (
    (r"ISO-10303-21;", "a drawing (STEP)", _DRAWING),
    (r"solid\b[^\n]*\n\s*facet\b", "a mesh (STL)", _AS_BODY),
    (r"(?:#[^\n]*\n|\s)*(?:mtllib|o|g|v)\s[^\n]*\n(?:[^\n]*\n)*?v\s", "a mesh (OBJ)", _AS_BODY),
    (r"\s*(?:&ACCESS|DEFDAT\b|DEF\s+\w+\()", "KUKA data", "enter the lengths of the arm as a Denavit-Hartenberg table"),
    (r"(?:%%%|\s)*MODULE\s+\w+", "a RAPID module", "enter the lengths of the arm as a Denavit-Hartenberg table"),
    (
        rf"(?:[^\n]*\n){{0,60}}?[ \t]*{_BLOCK}[^\n]*\n(?:[^\n]*\n){{0,20}}?[ \t]*{_BLOCK}",
        "an NC program",
        f"{_MACHINE_DATA}; axis values or poses as a CSV table (--axes, --poses)",
    ),
    (r"\s*[\[{]\s*(?:[\"{\[]|-?\d)", "JSON", _MACHINE_DATA),
)
_TABLE: Final = re.compile(r"\s*(?:#[^\n]*\n)*[A-Za-z_]\w*(?: *[\[(][^\])]*[\])])?\s*[,;\t][^\n]*\n\s*[-+\d.\"]")


def refuse_other_xml(text: str, file: Path) -> None:
    """Refuse XML that is neither URDF nor a TwinCAT project, where it is known.

    Raises:
        ParseError: it is a model or a picture of something else.
    """
    known = _XML_KINDS.get(xml_root(text))
    if known is not None:
        raise ParseError(f"this is {known[0]}, which is not read", span=Span(str(file)), hint=known[1])


def no_machine_data(source: SourceText, file: Path) -> ChainbuildError:
    """Return the error of a text without machine data, which says what it is where it is known."""
    what, hint = _known(source.text, file)
    if what:
        return ParseError(f"this is {what}, not machine data", span=Span(str(file)), hint=hint)
    numbered = ((number, line) for number, line in enumerate(source.lines(), start=1) if line.strip())
    first = next((Span(source.file, number, 1, line) for number, line in numbered), Span(source.file))
    return ParseError(
        "the file holds neither SINUMERIK machine data nor a TwinCAT channel list, nor DH parameters or a URDF",
        span=first,
        permitted="lines like '$MC_ROBX_…=…' or 'trafo[0].param[6] 8300000', a header a,d,alpha,theta, or <robot>",
    )


def _known(text: str, file: Path) -> tuple[str, str]:
    """Return what a text is and what could be done; two empty strings where it is unknown."""
    if file.name.endswith(SUFFIX):
        return "an overlay", f"give the machine file beside it: {file.name.removesuffix(SUFFIX)} with its own ending"
    head = text[:_HEAD_CHARACTERS].lstrip()
    for pattern, what, hint in _KINDS:
        if re.match(pattern, head):
            return what, hint
    if _TABLE.match(head) and not is_dh(text):
        return "a table", "options read tables (--axes, --poses); one of DH parameters has the header a,d,alpha,theta"
    return "", ""
