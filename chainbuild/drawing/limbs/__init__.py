"""Links of robots from joint to joint.

In reading order: `plan` (how every joint is built), `seats` (where it sits), `pieces` (bars, bosses, forks, rings),
`slides` (linear axes within an arm), `links` (what lies between two joints), `lifts` and `gantries` (what is under an
arm or over it), `tips` (flange and tool), `pushrods` (parallelograms).
"""
