"""Named bad files: each is refused with file, line, what is permitted and the controller's alarm, no traceback."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from chainbuild.errors import ChainbuildError, FileAccessError, Span
from chainbuild.findings import Collector, finding_kinds
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.machine import read_machine
from chainbuild.formats.text import read_source
from tests.kit.bad_robx_files import BAD, nr6
from tests.kit.robx_files import CC4, NR6, read, robx_text


@pytest.mark.parametrize("name", BAD)
def test_refused(name):
    bad = BAD[name]
    with pytest.raises(ChainbuildError) as caught:
        read(bad.text)
    error, shown = caught.value, str(caught.value)
    assert error.code == bad.code
    assert error.alarm == bad.alarm
    assert all(word in shown for word in bad.words), shown
    assert shown.startswith("arm.tea:")
    assert error.span is not None
    assert bad.line in error.span.text
    if bad.line:
        assert bad.text.split("\n")[error.span.line - 1] == error.span.text
    if bad.alarm:
        assert f"controller alarm {bad.alarm}" in shown


@pytest.mark.parametrize("name", BAD)
def test_lenient_door_keeps_the_same_error_and_goes_on(name):
    bad = BAD[name]
    machine = read(bad.text, strict=False)
    errors = [finding for finding in machine.findings if finding.severity == "error"]
    assert bad.code in {finding.code for finding in errors}
    with pytest.raises(ChainbuildError) as caught:
        machine.chain()
    assert caught.value.code in {finding.code for finding in errors}


def test_there_are_enough_bad_files():
    assert len(BAD) >= 45


def test_all_errors_of_a_file_are_found():
    text = nr6(NUM_AXES=7, WRIST_AXES=4, MAIN_LENGTH_AB=("nan", "1,5"))
    machine = read(text, strict=False)
    assert [f.code for f in machine.findings if f.severity == "error"] == ["CB106", "CB106", "CB103", "CB104"]
    text = robx_text({**NR6, "MAIN_LENGTH_AB": (1, 0), "DHPAR4_5A": (0, 1)})
    machine = read(text, strict=False)
    assert [f.code for f in machine.findings if f.severity == "error"] == ["CB341", "CB306"]


def test_every_code_is_registered():
    for finding in (BAD[name].code for name in BAD):
        assert finding_kinds()[finding].severity == "error"


FILES = {
    "empty": (b"", "empty"),
    "blank": (b"  \r\n\n", "empty"),
    "nul": (b"CHANDATA(1)\n\0\0", "NUL"),
    "long line": (b"; " + b"x" * 10_000_000, "characters"),
}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_no_text(tmp_path, name):
    path = tmp_path / "arm.tea"
    path.write_bytes(FILES[name][0])
    with pytest.raises(FileAccessError, match=FILES[name][1]):
        read_machine(read_source(path), path, Overlay(), Collector())


def test_a_folder(tmp_path):
    with pytest.raises(FileAccessError, match="folder"):
        read_source(tmp_path)


def test_a_missing_file(tmp_path):
    with pytest.raises(FileAccessError, match="no such file"):
        read_source(tmp_path / "none.tea")


def test_a_forbidden_file(tmp_path, monkeypatch):
    path = tmp_path / "arm.tea"
    path.write_text(nr6())

    def forbidden(self, mode):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", forbidden)
    with pytest.raises(FileAccessError, match="permission"):
        read_source(path)


def test_truncated_anywhere_never_leaves_a_traceback():
    text = robx_text({**NR6, **{"MAMES": (1, 2, 3, 4, 5, 6)}}, extra="$TC_DP3[1,1]=5\n$MA_POS_LIMIT_PLUS[AX1]=9")
    for end in range(0, len(text), 3):
        try:
            read(text[:end])
        except ChainbuildError as error:
            assert isinstance(error.span, Span)


def test_random_damage_never_leaves_a_traceback():
    random.seed(1)
    text = robx_text(CC4, extra="$TC_DP3[1,1]=5\nN36110 $MA_POS_LIMIT_PLUS[AX1]=9")
    for _ in range(400):
        damaged = list(text)
        for _ in range(random.randrange(1, 6)):
            damaged[random.randrange(len(damaged))] = random.choice("0123456789.-=[]$'\"; \nAXeH,")
        for strict in (True, False):
            try:
                read("".join(damaged), strict=strict).chain()
            except ChainbuildError as error:
                assert str(error)
