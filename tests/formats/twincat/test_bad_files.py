"""Named bad files: each is refused with its place, what is permitted and the controller's error, never a traceback."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, FileAccessError

ARM = "trafo[0].id 45\n"


@dataclass(frozen=True)
class Bad:
    """A file that must be refused."""

    name: str
    content: str | bytes
    says: tuple[str, ...]
    line: int | None = None
    alarm: int | None = None
    suffix: str = "lis"
    overlay: str = ""

    def __str__(self) -> str:
        return self.name


def project(text: str) -> str:
    return f'<?xml version="1.0"?>\n<TcSmProject><Cnc>\n<SdaMds><![CDATA[{text}]]></SdaMds></Cnc></TcSmProject>'


BOMB = (
    '<?xml version="1.0"?>\n<!DOCTYPE lolz [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">'
    '<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>\n<TcSmItem><SdaMds>&c;</SdaMds></TcSmItem>'
)

BAD = [
    # the line
    Bad("equals_sign", ARM + "trafo[0].param[6]=5", ("the line is not a `name value` assignment", "blanks"), 2),
    Bad("spaced_equals_sign", ARM + "trafo[0].param[6] = 5", ("`=` before its value", "blanks only"), 2),
    Bad("bracket_open", "trafo[0.id 45", ("the line is not a `name value` assignment",), 1),
    Bad("bracket_empty", "trafo[].id 45", ("index in trafo[].id is not a plain number", "digits"), 1),
    Bad("bracket_letter", "trafo[j].id 45", ("index in trafo[j].id is not a plain number",), 1),
    Bad("bracket_negative", "trafo[-1].id 45", ("not a plain number",), 1),
    Bad("bracket_decimal", "trafo[0.5].id 45", ("not a plain number",), 1),
    Bad("index_of_ten_digits", ARM + "trafo[0].param[1000000000] 5", ("not a plain number",), 2),
    Bad("index_of_five_digits", ARM + "trafo[0].param[10000] 5", ("has the index 10000", "[0] to [74]"), 2),
    Bad("tool_65536", ARM + "wz[65536].laenge 5", ("has the index 65536", "[0] to [65535]"), 2),
    Bad("index_missing", "trafo.id 45", ("trafo.id has no index", "[0] to [9]"), 1),
    Bad("param_index_missing", ARM + "trafo[0].param 5", ("trafo[0].param has no index", "[0] to [74]"), 2),
    Bad("name_incomplete", "trafo[0] 45", ("trafo[0] is not a complete name", "NAME"), 1),
    Bad("step_name_incomplete", "kin_step[0].id 45", ("not a complete name", "kin_step[i].trafo[j].NAME"), 1),
    # the value
    Bad("value_missing", ARM + "trafo[0].param[6]", ("has no value", "a finite number"), 2),
    Bad("value_only_comment", ARM + "trafo[0].param[6] # lost", ("not a number",), 2),
    Bad("decimal_comma", ARM + "trafo[0].param[6] 4000000,5", ("decimal comma", "decimal point"), 2),
    Bad("nan", ARM + "trafo[0].param[6] nan", ("is not finite: nan", "a finite number"), 2),
    Bad("inf", ARM + "trafo[0].param[6] -inf", ("is not finite: -inf",), 2),
    Bad("infinity", ARM + "trafo[0].param[6] Infinity", ("is not finite: Infinity",), 2),
    Bad("1e999", ARM + "trafo[0].param[6] 1e999", ("too large: 1e999", "at most 1e+13"), 2),
    Bad("huge", ARM + "trafo[0].param[6] 20000000000000", ("too large",), 2),
    Bad("huge_hex", ARM + "trafo[0].param[6] 0x" + "f" * 4000, ("too large",), 2),
    Bad("text_for_number", ARM + "trafo[0].param[6] lang", ("not a number: 'lang'",), 2),
    Bad("unit_glued", ARM + "trafo[0].param[6] 400mm", ("not a number: '400mm'",), 2),
    Bad("two_signs", ARM + "trafo[0].param[6] --5", ("not a number",), 2),
    Bad("quoted_number", ARM + 'trafo[0].param[6] "5"', ("not a number",), 2),
    Bad("quote_open", ARM + 'trafo[0].name "ROBOT', ("no closing quote",), 2),
    Bad("string_missing", ARM + "trafo[0].name (nothing", ("trafo[0].name has no value", "a string"), 2),
    Bad("arabic_digits", ARM + "trafo[0].param[6] ٤٥", ("not a number",), 2),
    # ids, types, limits
    Bad("id_missing", "trafo[0].param[6] 4000000", ("trafo[0] has no id", "1 to 65535"), 1, 21630),
    Bad("id_missing_type_given", "trafo[0].type 45", ("trafo[0] has no id",), 1, 21630),
    Bad("id_zero", "trafo[0].id 0\ntrafo[0].type 45", ("trafo[0] has no id",), 1, 21630),
    Bad("id_negative", "trafo[0].id -45", ("trafo[0].id is -45", "0 to 65535"), 1),
    Bad("id_decimal", "trafo[0].id 45.5", ("trafo[0].id is 45.5", "whole number"), 1),
    Bad("id_too_large", "trafo[0].id 65536", ("65536", "0 to 65535"), 1),
    Bad("type_too_large", ARM + "trafo[0].type 70000", ("trafo[0].type is 70000",), 2),
    Bad("id_repeated", ARM + "trafo[1].id 45", ("the id 45 is configured twice", "line 1", "different"), 2),
    Bad("id_repeated_same_name", ARM + "trafo[0].name A\ntrafo[1].id 45\ntrafo[1].name A", ("configured twice",), 3),
    Bad("id_repeated_old_form", ARM + "kinematik[45].param[0] 1", ("configured twice",), 2),
    Bad("eleventh_trafo", "trafo[10].id 45", ("has the index 10", "[0] to [9]"), 1),
    Bad("third_step", "kin_step[2].trafo[0].id 45", ("has the index 2", "[0] to [1]"), 1),
    Bad("param_75", ARM + "trafo[0].param[75] 1", ("has the index 75", "[0] to [74]"), 2),
    Bad("old_form_id_zero", "kinematik[0].param[0] 1", ("has no id",), 1, 21630),
    Bad("default_unknown", "kinematik_id 9\n" + ARM, ("default kinematic 9 is not configured", "45"), 1, 21630),
    Bad("default_name_unknown", "kinematik_name ROB\n" + ARM, ("'ROB' is not configured",), 1, 21630),
    Bad("default_not_a_number", "kinematik_id ROB\n" + ARM, ("not a number",), 1),
    Bad("angle_mode_6", ARM + "ori_rotation_angle 6", ("ori_rotation_angle is 6", "P-CHAN-00112"), 2),
    Bad("angle_mode_22", ARM + "ori_rotation_angle 22", ("ori_rotation_angle is 22",), 2),
    Bad("no_kinematic", "gruppe[0].achse[0].bezeichnung X\nEnde", ("configures no kinematic", "trafo[0].id"), None),
    Bad("kinematic_after_the_end", "kinematik_id 0\nEnde\n" + ARM, ("configures no kinematic",), None),
    # types
    Bad("tube_processing", "trafo[0].id 78", ("KIN_TYP 78 (tube processing)", "elsewhere"), 1),
    Bad("unknown_type_20", "trafo[0].id 20", ("KIN_TYP 20 is unknown", "permitted: KIN_TYP ", "45"), 1),
    Bad("type_wins_over_id", ARM + "trafo[0].type 20", ("KIN_TYP 20 is unknown",), 1),
    Bad("three columns", "trafo[0].id 19", ("kin19_guide must be chosen", "radial_planes, centre_on_axis"), 1),
    Bad("universal", "trafo[0].id 91", ("number_of_axes is 0", "trafo[0].number_of_axes", "3, 4, 5, 6"), 1),
    Bad("coupling", "trafo[0].id 210", ("no group is configured",), 1, alarm=292085),
    Bad(
        "two_steps",
        "default_id_of_kin_step[0] 45\ndefault_id_of_kin_step[1] 45\n" + ARM + "kin_step[1].trafo[0].id 45",
        ("KIN_TYP 45 takes deg deg deg deg deg deg", "KIN_TYP 45 gives mm mm mm deg deg deg"),
        4,
    ),
    Bad(
        "coupling_in_two_steps",
        "default_id_of_kin_step[0] 210\ndefault_id_of_kin_step[1] 9\ntrafo[0].id 210\nkin_step[1].trafo[0].id 9",
        ("cannot be part of a transformation of two steps", "controller alarm 22093"),
        3,
        alarm=22093,
    ),
    # head offsets
    Bad("direction_2", ARM + "trafo[0].param[21] 2", ("HD22 is 2", "direction_b1", "permitted: 0, 1"), 2),
    Bad("direction_minus_1", ARM + "trafo[0].param[20] -1", ("HD21 is -1", "permitted: 0, 1"), 2),
    Bad("flange_variant_3", ARM + "trafo[0].param[30] 3", ("HD31 is 3", "flange_variant"), 2),
    Bad("moving_workpiece_half", ARM + "trafo[0].param[32] 0.5", ("HD33 is 0.5",), 2),
    Bad("length_direction_7", ARM + "trafo[0].param[33] 7", ("HD34 is 7", "0, 1, 2, 3, 4, 5, 6"), 2),
    Bad("rotation_order_2", ARM + "trafo[0].param[34] 2", ("HD35 is 2",), 2),
    # tools
    Bad("tool_unknown", ARM, ("no tool 3", "none"), 2, overlay="[tool]\nnumber = 3"),
    Bad("tool_fraction", ARM + "wz[1].laenge 5", ("no tool 1.5", "permitted: 1"), 2, overlay="[tool]\nnumber = 1.5"),
    Bad("tool_inches", ARM + "wz[1].mass_einheit 1", ("inches", "0 (mm)"), 2, overlay="[tool]\nnumber = 1"),
    Bad("tool_key_of_robx", ARM, ("TC_DP3", "number = n"), 2, overlay="[tool]\nTC_DP3 = 1.0"),
    Bad("tool_flag_adds_up", ARM + "trafo[0].param[20] 1\nwz[1].kinematic.param[20] 1", ("HD21 is 2",), 2,
        overlay="[tool]\nnumber = 1"),
    Bad("tool_param_75", ARM + "wz[1].kinematic.param[75] 1", ("has the index 75", "[0] to [74]"), 2),
    Bad("tool_length_text", ARM + "wz[1].laenge lang", ("not a number: 'lang'",), 2),
    Bad("tool_without_index", ARM + "wz.laenge 1", ("wz.laenge has no index",), 2),
    # axis lists
    Bad("axis_list_missing", ARM, ("no such file",), None, overlay='axis_lists = ["nowhere.lis"]'),
    # containers
    Bad("cdata_truncated", project("trafo[0].id 45\ntrafo[0].par").split("par")[0], ("CDATA section", "cut off"), 3,
        suffix="xti"),
    Bad("xml_truncated", project(ARM)[:-12], ("malformed",), 4, suffix="tsproj"),
    Bad("xml_mismatched", "<TcSmItem><SdaMds>\ntrafo[0].id 45</Sda></TcSmItem>", ("mismatched tag",), 2, suffix="xti"),
    Bad("xml_bare_ampersand", "<TcSmItem><SdaMds>a & b</SdaMds></TcSmItem>", ("malformed",), 1, suffix="xti"),
    Bad("entity_bomb", BOMB, ("document type", "entities are not expanded"), 2, suffix="xti"),
    Bad("entity_external", '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><SdaMds>&x;</SdaMds>',
        ("document type",), 1, suffix="xti"),
    Bad("entity_undefined", "<TcSmItem><SdaMds>&x;</SdaMds></TcSmItem>", ("undefined entity",), 1, suffix="xti"),
    Bad("xml_without_list", "<TcSmItem><Cnc/></TcSmItem>", ("no parameter list", "<SdaMds>"), 1, suffix="xti"),
    Bad("xml_list_empty", project(""), ("configures no kinematic",), None, suffix="xti"),
    Bad("xml_error_inside", project("\n# c\n" + ARM + "trafo[0].param[6] x\n"), ("not a number",), 6, suffix="xti"),
    Bad("xml_two_roots", project(ARM) + "<a/>", ("junk after document element",), 4, suffix="xti"),
    # files
    Bad("empty", b"", ("empty",), None),
    Bad("blank", b" \n\t\n", ("empty",), None),
    Bad("nul", b"trafo[0].id 45\n\0\n", ("NUL",), 2),
    Bad("line_of_10_mb", ARM + "#" * 10_000_000, ("characters",), 2),
]  # fmt: skip


def write(bad: Bad, folder: Path) -> Path:
    path = folder / f"{bad.name}.{bad.suffix}"
    path.write_bytes(bad.content if isinstance(bad.content, bytes) else bad.content.encode("utf-8"))
    if bad.overlay:
        (folder / f"{bad.name}.chainbuild.toml").write_text(bad.overlay, "utf-8")
    return path


@pytest.mark.parametrize("bad", BAD, ids=str)
def test_bad_file(bad: Bad, tmp_path: Path) -> None:
    path = write(bad, tmp_path)
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.Robot.load(path)
    message = str(caught.value)
    for part in bad.says:
        assert part in message
    assert bad.overlay or str(path) in message
    assert caught.value.line == bad.line
    assert caught.value.alarm == bad.alarm
    assert "\n" not in message


@pytest.mark.parametrize("bad", BAD, ids=str)
def test_check_reports_it_and_goes_on(bad: Bad, tmp_path: Path) -> None:
    path = write(bad, tmp_path)
    try:
        findings = chainbuild.check(path)
    except FileAccessError:
        return
    assert [finding for finding in findings if finding.severity != "info"]


def test_names_are_unique_and_many() -> None:
    assert len({bad.name for bad in BAD}) == len(BAD) >= 45


def test_check_finds_every_bad_line(tmp_path: Path) -> None:
    path = tmp_path / "many.lis"
    path.write_text("trafo[0].id=1\ntrafo[0].id 45\ntrafo[0].param[6] x\ntrafo[0].param[99] 1\ntrafo[0].param[7] 1,5\n")
    errors = [finding for finding in chainbuild.check(path) if finding.severity == "error"]
    assert [(f.code, f.span.line if f.span else None) for f in errors] == [
        ("CB201", 1), ("CB202", 3), ("CB203", 4), ("CB202", 5),
    ]  # fmt: skip


def test_a_folder(tmp_path: Path) -> None:
    with pytest.raises(FileAccessError, match="folder"):
        chainbuild.load(tmp_path)


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "secret.lis"
    path.write_text(ARM)

    def refuse(_self: Path, _mode: str) -> None:
        raise PermissionError

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(FileAccessError, match="permission denied"):
        chainbuild.load(path)


@pytest.mark.parametrize(
    "content",
    [
        b"\xef\xbb\xbftrafo[0].id 45\r\ntrafo[0].name F\xc3\xbchrung\r\nEnde\r\n",
        "\ufefftrafo[0].id 45\ntrafo[0].name Führung\nEnde\n".encode("utf-16-le"),
        "trafo[0].id 45\ntrafo[0].name Führung\nEnde".encode("latin-1"),
        "trafo[0].id 45\rtrafo[0].name Führung\rEnde\r".encode(),
        "\ufeff<TcSmItem><SdaMds><![CDATA[\r\ntrafo[0].id 45\r\ntrafo[0].name Führung]]></SdaMds></TcSmItem>".encode(),
    ],
    ids=["bom_crlf", "utf16", "latin1", "cr", "bom_container"],
)
def test_encodings_and_line_ends_are_read(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "odd.lis"
    path.write_bytes(content)
    (entry,) = chainbuild.load(path).kinematics()
    assert (entry.id, entry.name) == (45, "Führung")
