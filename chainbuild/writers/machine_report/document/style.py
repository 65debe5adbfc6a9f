"""How reports look, on a screen and on paper."""

from __future__ import annotations

from typing import Final

# Shared with the page of a cross-check.
BASE_STYLE: Final = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem; color: #1b1f24; }
table { border-collapse: collapse; margin: .6rem 0; } th, td { padding: .2rem .7rem; text-align: right; }
th { border-bottom: 1px solid #9aa4af; }
"""

REPORT_STYLE: Final = (
    BASE_STYLE
    + """
:root { color-scheme: light; } body { background: #fff; overflow-wrap: break-word; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 1rem; }
h2 { font-size: 1.3rem; margin: 2.4rem 0 .6rem; padding-bottom: .25rem; border-bottom: 2px solid #1f6feb; }
h3 { font-size: 1.03rem; margin: 1.5rem 0 .3rem; }
p, ul { max-width: 52rem; margin: .5rem 0; } ul { padding-left: 1.3rem; } li { margin: .2rem 0; }
code { font: .88em ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; background: #f4f6f8; padding: 0 .25em;
  border-radius: 3px; } p code { white-space: nowrap; }
nav { columns: 2; column-gap: 3rem; max-width: 46rem; margin: 1rem 0 0; font-size: .95rem; }
nav a { color: #0b4fb3; text-decoration: none; display: block; padding: .08rem 0; }
.wide { overflow-x: auto; margin: .6rem 0 1rem; } .wide table { margin: 0; }
th, td { text-align: left; vertical-align: top; padding: .28rem .8rem .28rem 0; }
th { font-weight: 600; white-space: nowrap; } tbody tr { border-bottom: 1px solid #e4e8ec; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.rows td:not(:first-child), .rows th:not(:first-child) { text-align: right; padding-left: .8rem; }
td.short { white-space: nowrap; } .facts td:first-child { white-space: nowrap; color: #57606a; }
.form td { border: 1px solid #9aa4af; padding: .3rem .5rem; } .form th { padding: .3rem .5rem; }
.form td.blank { min-width: 4.2rem; height: 1.5rem; } .form td.tick { text-align: center; vertical-align: middle;
  font-size: 1.3rem; }
.form tbody { border-top: 2px solid #1b1f24; } .form tbody:last-child { border-bottom: 2px solid #1b1f24; }
.drawings { display: grid; grid-template-columns: 1fr 1fr; gap: 1.2rem; margin: .8rem 0; }
figure { margin: 0; border: 1px solid #e4e8ec; border-radius: 4px; } figcaption { padding: .35rem .7rem; color: #57606a;
  font-size: .9rem; border-top: 1px solid #e4e8ec; }
figure svg { display: block; width: 100%; height: auto; }
@media (max-width: 50rem) { .drawings { grid-template-columns: 1fr; } nav { columns: 1; } }
@page { size: A4; margin: 16mm 14mm; }
@media print {
  body { font-size: 9.5pt; margin: 0; padding: 0; max-width: none; } nav { display: none; }
  h2 { margin-top: 1.4rem; } h1, h2, h3 { break-after: avoid; } tr, figure, li, .form tbody { break-inside: avoid; }
  thead { display: table-header-group; } .wide { overflow: visible; } table { font-size: 8.3pt; } .form { width: 100%; }
  th, td { padding: .2rem .5rem .2rem 0; } .drawings { grid-template-columns: 1fr; justify-items: center; gap: .8rem; }
  figure { width: 70%; } code { background: none; padding: 0; } td.n, td.short { white-space: normal; }
  section:has(.form) { break-before: page; }
  .form td, .form th { padding: .22rem .25rem; } .form td.blank { min-width: 0; }
}
"""
)
