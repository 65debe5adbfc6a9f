"""Files that are no machine data are called by their name, with what could be done."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import zipfile
from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, FileAccessError


def packed(*names: str) -> bytes:
    """Return a zip archive of some files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name in names:
            archive.writestr(name, "N10 $MC_TRAFO_TYPE_1=4100\n")
    return stream.getvalue()


def mesh() -> bytes:
    """Return a binary STL of two triangles."""
    return bytes(80) + (2).to_bytes(4, "little") + b"\x01" * 100


FILES: dict[str, tuple[str, bytes | str, str, str]] = {
    "excel": ("arm.xlsx", packed("[Content_Types].xml", "xl/workbook.xml"), "an Excel workbook", "CSV UTF-8"),
    "old_excel": (
        "arm.xls",
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(99),
        "an old Office file",
        "machine data as text",
    ),
    "calc": ("arm.ods", packed("mimetype/opendocument.spreadsheet"), "a LibreOffice sheet", "CSV"),
    "word": ("arm.docx", packed("word/document.xml"), "a Word document", "machine data as text"),
    "zip": ("arm.zip", packed("machine.mpf"), "a zip archive", "unpack it"),
    "dsf": ("archive.dsf", packed("NC/channel.tea"), "a zip archive", "SINUMERIK commissioning archive (.dsf"),
    "gz": ("arm.mpf.gz", gzip.compress(b"$MC_TRAFO_TYPE_1=4100"), "compressed with gzip", "gunzip"),
    "bz2": ("arm.bz2", bz2.compress(b"$MC_TRAFO_TYPE_1=4100"), "compressed with bzip2", "unpack"),
    "xz": ("arm.xz", lzma.compress(b"$MC_TRAFO_TYPE_1=4100"), "compressed with xz", "unpack"),
    "7z": ("arm.7z", b"7z\xbc\xaf\x27\x1c\0\x04", "a 7-Zip archive", "unpack"),
    "pdf": ("manual.pdf", b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n", "a PDF", "machine data as text"),
    "png": ("arm.png", b"\x89PNG\r\n\x1a\n\0\0", "a picture (PNG)", "machine data as text"),
    "stl": ("arm.stl", mesh(), "a mesh (STL)", "[geometry]"),
    "stl_text": ("arm.stl", "solid arm\n  facet normal 0 0 1\n", "a mesh (STL)", "[geometry]"),
    "obj": ("arm.obj", "# Blender\no arm\nv 0 0 1\nv 0 1 0\nf 1 2 3\n", "a mesh (OBJ)", "[geometry]"),
    "glb": ("arm.glb", b"glTF\x02\0\0\0", "a mesh (glTF)", "[geometry]"),
    "dae": ("arm.dae", '<?xml version="1.0"?><COLLADA version="1.4"/>', "a mesh (COLLADA)", "[geometry]"),
    "step": ("arm.step", "ISO-10303-21;\nHEADER;\n", "a drawing (STEP)", "shapes and no joints"),
    "mjcf": (
        "arm.xml",
        '<mujoco model="arm"><worldbody/></mujoco>',
        "MJCF, a model of MuJoCo",
        "as URDF",
    ),
    "sdf": ("arm.sdf", '<?xml version="1.0"?>\n<!-- x -->\n<sdf version="1.7"/>', "SDF, a model of Gazebo", "as URDF"),
    "launch": ("view.launch", "<launch><arg name='a'/></launch>", "a launch file of ROS", "the URDF that it loads"),
    "xacro": (
        "arm.xacro",
        '<robot name="a"><xacro:macro name="b"/></robot>',
        "xacro, a template",
        "arm.xacro > robot.urdf",
    ),
    "nc_program": ("part.mpf", "%\nN10 G0 X0 Y0\nN20 G1 Z-5 F500\nM30\n", "an NC program", "--axes, --poses"),
    "nc_with_transformation": ("part.nc", "; part\nTRAORI\nG1 X10 Y10 A3=0 B3=0 C3=1\n", "an NC program", "--poses"),
    "overlay": ("kr6.chainbuild.toml", "[limits]\nA1 = [-1, 1]\n", "an overlay", "the machine file beside it: kr6"),
    "axis_table": ("axes.csv", "A1,A2,A3\n0,1,2\n", "a table", "a,d,alpha,theta"),
    "german_table": ("axes.csv", "A1;A2 [deg];A3\n0,5;1;2\n", "a table", "--axes"),
    "json": ("arm.json", '{"joints": [1, 2]}\n', "JSON", "give the machine data"),
    "kuka": ("$machine.dat", "&ACCESS RV\nDEFDAT $MACHINE PUBLIC\n", "KUKA data", "Denavit-Hartenberg table"),
    "rapid": ("arm.mod", "MODULE arm\n CONST num a := 1;\n", "a RAPID module", "Denavit-Hartenberg table"),
}


@pytest.mark.parametrize(("name", "content", "what", "hint"), FILES.values(), ids=FILES)
def test_other_files(tmp_path: Path, name: str, content: bytes | str, what: str, hint: str) -> None:
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(path)
    said = str(caught.value)
    assert said.startswith(f"{path}:")
    assert what in said
    assert hint in said
    assert "\n" not in said
    assert [finding.severity for finding in chainbuild.check(path)] == ["error"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "the file is empty"),
        (b" \n\t\n", "the file is empty"),
        (bytes(range(256)), "NUL bytes: it is not a text file"),
        (b"Dear colleague,\nplease find attached\n", "holds neither SINUMERIK machine data nor a TwinCAT channel list"),
        (b"<config/>", "the XML holds no parameter list"),
    ],
)
def test_files_of_no_kind(tmp_path: Path, content: bytes, said: str) -> None:
    path = tmp_path / "some.thing"
    path.write_bytes(content)
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(path)
    assert said in str(caught.value)


def test_a_folder_names_its_files(tmp_path: Path) -> None:
    for name in ("b.mpf", "a.urdf", ".hidden"):
        (tmp_path / name).write_text("x", "utf-8")
    with pytest.raises(FileAccessError, match=r"a folder, not a machine file; name one of its files: a\.urdf, b\.mpf$"):
        chainbuild.load(tmp_path)


TRAORI = {
    16: "the head turns the tool, by its axes A and B",
    20: "the head turns the tool, by its axes C and A",
    24: "the head turns the tool, its axes in any directions",
    33: "the table turns the workpiece, by its axes A and C",
    40: "the table turns the workpiece, its axes in any directions",
    50: "the head turns the tool, the table the workpiece, by its axes B and A",
    56: "the head turns the tool, the table the workpiece, their axes in any directions",
    72: "whose data stand in a tool carrier",
    148: "a cardanic head turns the tool",
}


@pytest.mark.parametrize(("number", "words"), TRAORI.items())
def test_transformations_of_the_control_are_named(tmp_path: Path, number: int, words: str) -> None:
    path = tmp_path / "machine.mpf"
    path.write_text(f"CHANDATA(1)\nN24100 $MC_TRAFO_TYPE_1={number}\n", "utf-8")
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(path)
    assert f"TRAFO_TYPE {number} is an orientation transformation (TRAORI)" in str(caught.value)
    assert f"{words};" in str(caught.value).replace(" of the control itself", "")
    assert "chainbuild types" in str(caught.value)
