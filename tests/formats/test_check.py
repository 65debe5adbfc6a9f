"""`check` reports content and never raises on it; it agrees with what `load` and `chain` refuse."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, FileAccessError
from chainbuild.findings import Finding, Findings
from tests.kit.machine_files import machine_file


def errors(path: Path, **options: Path) -> list[str]:
    return [finding.text for finding in chainbuild.check(path, **options) if finding.severity == "error"]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "empty"),
        (b" \n\t", "empty"),
        (b"trafo[0].id 9\n\0", "NUL"),
        (b"\xff\xfe", "neither SINUMERIK"),
        (b"trafo[0].id 9\n#" + b"x" * 200_000, "characters"),
        (b"hello", "neither SINUMERIK"),
        (b"<a" * 100, "malformed"),
    ],
)
def test_faulty_content_is_a_finding(content: bytes, says: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.lis"
    path.write_bytes(content)
    (text,) = errors(path)
    assert says in text
    with pytest.raises(ChainbuildError, match=says):
        chainbuild.load(path)
    overlay = tmp_path / "bad.toml"
    overlay.write_bytes(content)
    found = errors(Path("irb2600"), overlay=overlay)
    assert bool(found) == bool(content.strip(b"\xff\xfe \n\t"))


def test_a_file_that_is_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("chainbuild.tolerances.MAX_FILE_BYTES", 10)
    path = tmp_path / "large.lis"
    path.write_text("trafo[0].id 9\n", "utf-8")
    assert "14 bytes" in errors(path)[0]


def test_a_device_that_never_ends_does_not_fill_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("chainbuild.tolerances.MAX_FILE_BYTES", 10)
    (text,) = errors(Path("/dev/zero"))
    assert text == "the file has 11 bytes"


def test_what_cannot_be_read_is_raised(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "missing.lis"):
        with pytest.raises(FileAccessError):
            chainbuild.check(path)
        with pytest.raises(FileAccessError):
            chainbuild.check("irb2600", overlay=path)


def test_an_unsupported_kinematic_beside_the_default_is_a_warning(tmp_path: Path) -> None:
    path = machine_file(tmp_path, "trafo[0].id 9\ntrafo[1].id 15\n")
    (finding,) = [f for f in chainbuild.check(path) if f.severity != "info"]
    assert (finding.code, finding.severity) == ("CB223", "warning")
    assert finding in chainbuild.load(path).findings
    assert chainbuild.load(path).chain().kinematic == "KIN_TYP 9"


@pytest.mark.parametrize("overlay", ["", "kinematic = 15"])
def test_an_unsupported_default_is_an_error(overlay: str, tmp_path: Path) -> None:
    text = "trafo[0].id 9\ntrafo[1].id 15\n" if overlay else "kinematik_id 15\ntrafo[0].id 9\ntrafo[1].id 15\n"
    path = machine_file(tmp_path, text, overlay)
    assert any("tube processing" in text for text in errors(path))
    with pytest.raises(ChainbuildError, match="tube processing"):
        chainbuild.load(path).chain()


def test_an_unsupported_kinematic_that_the_overlay_passes_over_is_a_warning(tmp_path: Path) -> None:
    path = machine_file(tmp_path, "kinematik_id 15\ntrafo[0].id 9\ntrafo[1].id 15\n", "kinematic = 9")
    assert errors(path) == []
    assert chainbuild.load(path).chain().kinematic == "KIN_TYP 9"


def test_another_fault_of_a_second_kinematic_stays_an_error(tmp_path: Path) -> None:
    path = machine_file(tmp_path, "trafo[0].id 9\ntrafo[1].id 45\ntrafo[1].param[20] 7\n")
    assert any("HD21 is 7" in text for text in errors(path))


def test_shipped_machines_have_no_errors() -> None:
    for name in chainbuild.shipped():
        assert errors(Path(name)) == []


def test_an_arm_that_is_singular_in_every_position_is_found(tmp_path: Path) -> None:
    """Without a forearm the wrist meets in a point of A3, which then does not move it."""
    path = tmp_path / "short.lis"
    path.write_text("trafo[0].id 45\ntrafo[0].param[6] 4000000\ntrafo[0].param[7] 4550000\ntrafo[0].param[10] 250000\n")
    found = [finding for finding in chainbuild.check(path) if finding.code == "CB601"]
    assert len(found) == 1
    assert found[0] in chainbuild.Robot.load(path).chain.findings


@pytest.mark.parametrize("entry", ["trafo[0].foo 5", "trafo[0].param[77] x"])
def test_the_work_grows_as_the_lists_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, entry: str) -> None:
    """Counted by how often a finding is compared with those that are known."""
    asked: Counter[int] = Counter()
    path = tmp_path / "many.xti"
    own = Finding.__hash__

    def counted(count: int) -> Findings:
        def told(finding: Finding) -> int:
            asked[count] += 1
            return own(finding)

        lists = f"<SdaMds>\ntrafo[0].id 9\ntrafo[0].param[1] 3000000\n{entry}\nEnde\n</SdaMds>\n" * count
        path.write_text(f"<?xml version='1.0'?>\n<TcSmProject>{lists}</TcSmProject>\n", "utf-8")
        monkeypatch.setattr(Finding, "__hash__", told)
        return chainbuild.check(path)

    for count in (15, 30):
        assert len([one for one in counted(count) if one.code in ("CB227", "CB202")]) == count
    assert asked[30] < 2.5 * asked[15]
