"""Collects the hand formulas of the KIN_TYP machines with rotary axes in the head, and of arm 45.

f(param, axes, tool_length_mm, conv) -> 4x4 tool in workpiece [mm]; `param` maps the raw index i of param[i] (HD(i+1))
to the raw file value, `axes` are the channel's values in its order [mm, deg], programmed ones for 28, 70, 76 and for
59/60 with HD21 = 0. Missing parameters are 0, missing conventions take their default.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from .kin_arm45 import kin45
from .kin_cardan import kin59, kin60
from .kin_drill_heads import kin2, kin3, kin4, kin5, kin6, kin7, kin9, kin17, kin25, kin28
from .kin_tilt_heads import kin8, kin10, kin11, kin16, kin18, kin22, kin30, kin33, kin70, kin76, kin207

Formula = Callable[[dict[int, float], Sequence[float], float, dict[str, str]], NDArray[np.float64]]

FORMULAS: dict[int, Formula] = {
    2: kin2,
    3: kin3,
    4: kin4,
    5: kin5,
    6: kin6,
    7: kin7,
    8: kin8,
    9: kin9,
    10: kin10,
    11: kin11,
    16: kin16,
    17: kin17,
    18: kin18,
    22: kin22,
    25: kin25,
    28: kin28,
    30: kin30,
    33: kin33,
    45: kin45,
    59: kin59,
    60: kin60,
    70: kin70,
    76: kin76,
    207: kin207,
}
