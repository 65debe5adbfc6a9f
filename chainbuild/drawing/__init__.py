"""Machines as one recognises them: from the topology of a chain to boxes, cylinders and balls, for people to look at.

Machine data say where the axes are and nothing of castings; the bodies here are assumed by rule. Collision takes the
skeleton of `chainbuild.chain.bodies` and what the overlay gives, never these.

In reading order: `shown` (parallelograms with their rods), `site` (what every rule looks up and builds with),
`machine` (which rule draws what), `given` (what an overlay gives), `held` (robots that carry the workpiece),
`machine_tools`, `arms`, `tracks` and their `limbs` (robots), `parallel` (closed loops) and `special` (lathes and the
rest) with their `builds`.
"""
