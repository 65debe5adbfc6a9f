"""Files appear whole or not at all; numbers read the same on every machine."""

from __future__ import annotations

import math
import os
import random
from pathlib import Path

import pytest

from chainbuild.errors import FileAccessError
from chainbuild.files import angle_text, make_folder, number_text, numbers_text, open_atomic, write_text


def one_bit_around(value: float) -> list[float]:
    return [math.nextafter(value, -math.inf), value, math.nextafter(value, math.inf)]


@pytest.mark.parametrize("value", [0.0, -0.0, 6.123e-17, -1.2e-16, 4e-15, -4e-15])
def test_noise_around_zero_is_zero(value: float) -> None:
    assert number_text(value) == "0"
    assert angle_text(value) == "0"


@pytest.mark.parametrize("value", [0.4, 0.025, -0.455, 1.0, 9.87654321, 12.5, 0.0000123])
def test_decimal_lengths_survive_the_last_bits(value: float) -> None:
    for near in one_bit_around(value):
        assert float(number_text(near)) == value


@pytest.mark.parametrize("degrees", [90.0, -90.0, 180.0, 45.0, 30.0, 12.3456789, -170.25, 2700.0])
def test_decimal_degrees_survive_the_last_bits(degrees: float) -> None:
    texts = {angle_text(near) for near in one_bit_around(math.radians(degrees))}
    assert len(texts) == 1
    assert float(texts.pop()) == pytest.approx(math.radians(degrees), rel=1e-14)


def test_other_numbers_keep_what_a_pose_needs() -> None:
    rng = random.Random(1)
    for _ in range(1000):
        value = rng.uniform(-7.0, 7.0)
        assert abs(float(number_text(value)) - value) <= 1e-13
        assert abs(float(angle_text(value)) - value) <= 1e-13
        assert len(number_text(value).lstrip("-").replace(".", "")) <= 15


def test_the_last_bit_rarely_shows_in_other_numbers() -> None:
    rng = random.Random(2)
    values = [rng.uniform(-2.0, 2.0) for _ in range(2000)]
    changed = sum(len({number_text(near) for near in one_bit_around(value)}) > 1 for value in values)
    assert changed <= 20


def test_numbers_are_separated_by_single_spaces() -> None:
    assert numbers_text([0.1 + 0.2, -0.0, 1]) == "0.3 0 1"


def test_write_creates_and_replaces(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    write_text(path, "one\n")
    write_text(path, "zwölf\n")
    assert path.read_bytes() == "zwölf\n".encode()
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_leaves_what_stood_there(tmp_path: Path) -> None:
    path = tmp_path / "file.txt"
    write_text(path, "old\n")
    for error in (ValueError, KeyboardInterrupt):
        with pytest.raises(error), open_atomic(path) as stream:
            stream.write("half of")
            raise error
    assert path.read_text("utf-8") == "old\n"
    assert list(tmp_path.iterdir()) == [path]


def test_new_files_obey_the_umask_and_old_ones_keep_their_mode(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "new", "x")
        assert (tmp_path / "new").stat().st_mode & 0o777 == 0o640
        (tmp_path / "new").chmod(0o604)
        write_text(tmp_path / "new", "y")
        assert (tmp_path / "new").stat().st_mode & 0o777 == 0o604
    finally:
        os.umask(before)


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("old", "utf-8")
    link.symlink_to(target)
    write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text("utf-8") == "new"


def test_what_is_no_file_is_written_to_and_not_replaced() -> None:
    write_text(Path(os.devnull), "gone")
    assert not Path(os.devnull).is_file()


@pytest.mark.parametrize(
    ("name", "reason"), [("", "directory"), ("missing/file", "No such file"), ("a/b", "directory")]
)
def test_trouble_is_a_file_access_error(tmp_path: Path, name: str, reason: str) -> None:
    (tmp_path / "a").write_text("a file", "utf-8")
    with pytest.raises(FileAccessError, match=reason) as caught:
        write_text(tmp_path / name, "x")
    assert caught.value.file == str(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_a_folder_that_cannot_be_made_is_a_file_access_error(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("a file", "utf-8")
    make_folder(tmp_path / "b" / "c")
    with pytest.raises(FileAccessError, match="folder cannot be created"):
        make_folder(tmp_path / "a" / "c")
