"""Links of robots from joint to joint.

In reading order: `seats` (where every joint sits and how it is built), `pieces` (plates, forks, bosses), `links` (what
lies between two joints), `slides` (linear axes within an arm), `tips` (flange and tool), `pushrods` (parallelograms).
"""
