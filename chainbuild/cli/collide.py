"""`chainbuild collide`: self-collisions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from chainbuild.cli.axisvalues import At, given_rows
from chainbuild.cli.show import console, empty_table, note, print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, REJECTED, BetweenRows, Json, MachineOptions, UsageError, Whole
from chainbuild.progress import bars_shown, counted
from chainbuild.units import m_from_mm, mm_from_m

if TYPE_CHECKING:
    from chainbuild.analysis.collision.paths import Contact
    from chainbuild.collision.model import CollisionModel, Distance


@Parameter(name="*", group="Pairs")
@dataclass(frozen=True, slots=True)
class PairOptions:
    """Which pairs of links can collide.

    Attributes:
        pairs: List the pairs of links that never, always or sometimes collide, by sampling.
        samples: Number of random positions that --pairs and --srdf sample.
        srdf: Folder to write the SRDF to, as FOLDER/NAME/NAME.srdf.
    """

    pairs: Annotated[bool, Parameter(negative="")] = False
    samples: Whole = 10_000
    srdf: Path | None = None


DEFAULT_PAIRS = PairOptions()


def collide(
    file: str,
    /,
    *,
    at: At = (),
    axes: Path | None = None,
    between: BetweenRows = "ptp",
    clearance: float = 0.0,
    picture: Path | None = None,
    json: Json = False,
    sampling: PairOptions = DEFAULT_PAIRS,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Find self-collisions at axis values, or along a path, including between its rows.

    Bodies are capsules along the links unless the overlay's table [geometry] gives radii, shapes, hulls or meshes. The
    exit code is 3 if bodies collide.

    Example: `chainbuild collide kr6r900 --at 0,-90,90,0,0,0`

    Example: `chainbuild collide kr6r900 --axes path.csv --between cp`

    Args:
        file: A machine file, or the name of a shipped machine.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated.
        axes: CSV table of axis values: a path; - is standard input.
        between: What the machine does between the rows of --axes. ptp: all axes change evenly, no contact is missed;
            cp: the tip moves along a straight line, sampled; rows: only the rows are looked at.
        clearance: Smallest permitted distance between bodies in mm.
        picture: SVG file to write: the smallest distance over the rows.
        json: Print JSON.
        sampling: Which pairs can collide.
        options: Which kinematic.
    """
    from chainbuild.collision.model import CollisionModel

    robot = options.robot(file)
    rows = given_rows(robot, at, axes)
    asked = sampling.pairs or sampling.srdf is not None
    if not (len(rows) or asked):
        raise UsageError("expected --at, --axes, --pairs or --srdf")
    model = CollisionModel(robot)
    data: dict[str, Any] = {"bodies": [solid.name for solid in model.solids]}
    if asked:
        data["pairs"] = _sample(model, sampling, json)
    if not len(rows):
        if json:
            print_json("collide", data)
        return 0
    found = _positions(model, rows, between if axes is not None else None, m_from_mm(clearance))
    if picture:
        note(f"wrote {_draw(model, rows, picture)}")
    if json:
        print_json("collide", data | found.data())
    else:
        found.print()
    return REJECTED if found.collides else 0


class _Found:
    """Contacts along the rows, and the closest bodies at each position."""

    def __init__(
        self,
        contacts: list[Contact],
        closest: list[Distance | None],
        names: list[str],
        between: BetweenRows | None,
        remarks: tuple[str, ...],
    ) -> None:
        self.contacts, self.closest, self.names = contacts, closest, names
        self.between, self.remarks = between, remarks

    @property
    def collides(self) -> bool:
        return bool(self.contacts)

    def data(self) -> dict[str, Any]:
        return {
            "collides": self.collides,
            "between": self.between,
            "remarks": list(self.remarks),
            "contacts": [
                {
                    "row": contact.row + 1,
                    "share": contact.share,
                    "axes": dict(zip(self.names, contact.axes.tolist(), strict=True)),
                    "bodies": list(contact.pair),
                    "distance_mm": mm_from_m(contact.distance),
                }
                for contact in self.contacts
            ],
            "closest": [
                None
                if one is None
                else {
                    "row": row,
                    "bodies": list(one.pair),
                    "distance_mm": mm_from_m(one.distance),
                    "points_mm": (one.points * 1000.0).tolist(),
                }
                for row, one in enumerate(self.closest, start=1)
            ],
        }

    def print(self) -> None:
        shown = empty_table("Closest bodies", "Row", "Bodies", "Distance [mm]")
        for row, one in enumerate(self.closest, start=1):
            if one is not None and (len(self.closest) <= 20 or one.distance <= 0.0):
                shown.add_row(str(row), " – ".join(one.pair), f"{mm_from_m(one.distance):.3f}")
        console().print(shown)
        for contact in self.contacts:
            values = ", ".join(f"{n} {v:.4g}" for n, v in zip(self.names, contact.axes.tolist(), strict=True))
            between = f"row {contact.row + 1}" if contact.share == 0.0 else f"after row {contact.row + 1}"
            say(f"{between}: {' and '.join(contact.pair)} touch at {values}")
        if not self.contacts:
            say("no collision")
        for remark in self.remarks:
            say(remark)


def _positions(model: CollisionModel, rows: Any, between: BetweenRows | None, clearance: float) -> _Found:
    """Return what collides; `between`: None for positions that are no path."""
    from chainbuild.analysis.collision.paths import collision_remarks, contacts

    names = [axis.name for axis in model.robot.axes]
    bar, motion = bars_shown(), between or "rows"
    closest = [model.nearest(row) for row in counted(rows, len(rows), bar, "distances")]
    found = list(contacts(model.robot, rows, clearance=clearance, bodies=model, between=motion, progress=bar))
    remarks = () if between is None else collision_remarks(model.robot, between)
    return _Found(found, closest, names, between, (*remarks, *_at_home(model, found)))


def _at_home(model: CollisionModel, contacts: list[Contact]) -> list[str]:
    """Return which of the pairs found touch at home already: there the bodies are no castings."""
    link_of = {solid.name: solid.link for solid in model.solids}
    found = {frozenset(link_of[name] for name in contact.pair) for contact in contacts}
    return [
        f"{one} and {other} touch at home already: by default a body reaches from joint to joint, and no data say how "
        "castings pass one another; set them in [geometry] of the overlay, or name the pair under ignore"
        for one, other in (model.touching_at_home() if found else ())
        if frozenset((one, other)) in found
    ]


def _sample(model: CollisionModel, sampling: PairOptions, as_json: bool) -> dict[str, Any]:
    from chainbuild.analysis.collision.pairs import classify_pairs
    from chainbuild.writers.models.robotfiles import write_robot_files
    from chainbuild.writers.models.srdf import srdf_text

    found = classify_pairs(model.robot, sampling.samples, progress=bars_shown())
    if sampling.srdf is not None:
        name = f"{model.robot.name}.srdf"
        files = write_robot_files(model.robot, sampling.srdf, {name: srdf_text(model.robot, found)})
        note(f"wrote {files[name]}")
    if not as_json:
        shown = empty_table(f"Pairs of links at {found.samples} positions", "Links", "Collide", "Positions")
        for pair in found.pairs:
            shown.add_row(" – ".join(pair.links), pair.verdict, str(pair.hits))
        console().print(shown)
        say(f"never: with {found.confidence:.0%} confidence, at less than a share {found.bound:.2g} of all positions")
    return {
        "samples": found.samples,
        "confidence": found.confidence,
        "bound": found.bound,
        "verdicts": [{"links": list(p.links), "verdict": p.verdict, "hits": p.hits} for p in found.pairs],
    }


def _draw(model: CollisionModel, rows: Any, path: Path) -> Path:
    import numpy as np

    from chainbuild.writers.picture import distance_picture, write_picture

    nearest = [model.nearest(row) for row in rows]
    distances = np.array([np.nan if one is None else one.distance for one in nearest])
    return write_picture(path, distance_picture(distances, model.robot.chain.title))
