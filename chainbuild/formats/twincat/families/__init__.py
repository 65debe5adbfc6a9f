"""Recipes of the KIN_TYPs: one module a family, found automatically.

A module of this package holds functions ``kin_N`` and ends with the table that registers them::

    RECIPES: Final[Mapping[int, RecipeFunction]] = {9: kin_9, 25: kin_25}

`types.catalogue` beside this folder imports every module here and joins their tables; no other code needs a change.
CONTRIBUTING lists the data and the tests. A type enters the catalogue when both its data file ``data/kinNNN.toml`` and
its recipe exist.

A recipe reads like the drawing, from the machine base to the tool tip, and is 5 to 25 lines long::

    def kin_9(p: Params, choose: Choices) -> Recipe:
        \"\"\"Build the C/A head: C carries A, A swivels the tool.\"\"\"
        return Recipe(
            tool=[
                linear("X", "x"), linear("Y", "y"), linear("Z", "z"),
                shift(p.mm("static_x"), p.mm("static_y")),
                driven("C", "z", Drive(1.0, -p.deg("offset_c"))),
                shift(-p.mm("c_pivot_x"), -p.mm("c_pivot_y"), -p.mm("c_pivot_z")),
                driven("A", "x", Drive(1.0, -p.deg("offset_a"))),
                shift(z=-p.mm("tool_z")), mark("flange"), shift(z=-p.tool_length_mm),
            ],
        )

    def kin_58(p: Params, choose: Choices) -> Recipe:
        \"\"\"Build the A/C table: A carries C, C carries the workpiece.\"\"\"
        return Recipe(
            tool=[linear("X", "x"), linear("Y", "y"), linear("Z", "z"), shift(z=-p.mm(1)), mark("flange"), ...],
            workpiece=[
                shift(p.mm(7), p.mm(8), p.mm(9)),
                table_rotary(choose, "A", "x", sign=table_flag(p, choose, 12), zero_deg=p.deg(10)),
                ...
            ],
        )

Rules:

- ``linear``, ``rotary``, ``shift``, ``turn``, ``mark`` come from `chainbuild.chain.assemble`; lengths are mm, angles
  degrees. A joint has the name of its axis; ``drive={"X": -1.0}`` or ``sign=-1.0`` for a workpiece slide that runs
  against the WCS axis; several axes on one joint (gears, absolute angles) by ``drive={"A2": k, "C1": j}``.
- Values: ``p.mm(key)``, ``p.deg(key)``, ``p.flag(key)`` (checked against the table), ``p.direction(key)`` (flag 0/1 as
  +1/-1), ``p.sign(key)`` (negative is -1; 0 counts as +1 and leaves finding CB402, unless ``zero_is_plus=True``),
  ``p.number(key)`` (ratio or count unchanged), ``p.given(key)``; the key is the HD's name in the data file or its
  number. A wrong kind raises TypeError: the recipe is wrong, not the file. Channel list and tool are already added.
- ``p.tool_length_mm`` acts along minus the tool vector unless the manual says otherwise; ``p.tool_radius_mm`` is 0
  without an active tool.
- Sign and zero offset meet only in ``zero_and_sign`` (convention `offset_inside_flag`), which ``head_rotary`` (printed
  sign·axis - zero) and ``table_rotary`` (printed sign·(axis - zero), uses `table_rotary_sense`) call;
  ``table_flag`` decodes the flags of 57, 58, 61, 63, 64, 80, 81, 82, 209. Axes without flag use ``driven(name,
  direction, Drive(sign, offset_deg))``: joint = sign·axis + offset.
- Conventions: ``choose["name"]`` returns the choice and notes the use, ``choose.sign("name")`` +1/-1 for plus/minus.
  Use it only where the choice can change this chain.
- ``mark("flange")`` where the tool is clamped, before the tool's own length and offsets; without it the flange is
  the tool.
- Machines with a nonlinear map return ``Recipe(axis_map=...)``; the map's q is in the order of the joints, tool branch
  first. Lengths there are SI. ``p.axes`` are the type's axes; ``Recipe(axes=...)`` replaces them (`carries`, `held`).
- Closed loops: ``Recipe(branches=..., loops=...)`` gives the arms, each from the base to a marked end, and where the
  ends meet; the axis map is their closed form. Joints that no axis drives have names of their own.
- Refusing: ``p.refuse(key, "text", "permitted")`` raises MachineDataError CB401 at the line of the HD where the
  collector is strict and returns where it is lenient: the recipe must still return something finite. Remarks:
  ``p.note("CB4nn", key, "text")`` with a number from `data/findings.toml`.
"""
