"""Wrist: one to three rotary axes in standard Denavit-Hartenberg form (ROBX manual 5.3.10–5.3.14).

    Rz(q4) · Tz(d0) Tx(a0) Rx(α0) · Rz(q5) · Tz(d1) Tx(a1) Rx(α1) · Rz(q6)

Five axes end after Rz(q5), four after Rz(q4).
"""

from __future__ import annotations

from collections.abc import Sequence

from chainbuild import frames
from chainbuild.chain.assemble import Element, Fixed
from chainbuild.formats.sinumerik.geometry.internal_axes import InternalAxes
from chainbuild.formats.sinumerik.reading.robx import Robx


def wrist(robx: Robx, axes: InternalAxes) -> Sequence[Element]:
    """Return the wrist's joints; the flange frame follows on the last of them."""
    elements: list[Element] = [axes.joint(4, "Rz")]
    for n in range(robx.num_axes - 4):
        elements += [dh(robx, n), axes.joint(5 + n, "Rz")]
    return elements


def dh(robx: Robx, n: int) -> Fixed:
    """Return the fixed part from wrist axis 4 + n to the next one."""
    link = robx.dh[n]
    return Fixed(frames.dh_link(link.d_mm, link.a_mm, link.alpha_deg))
