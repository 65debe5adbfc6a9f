"""TwinCAT CNC: parameter lists and their containers, the catalogue of KIN_TYPs, and the translation to a chain."""

from chainbuild.formats.twincat.files import is_twincat, read_machine
from chainbuild.formats.twincat.machine import TwinCatMachine
from chainbuild.formats.twincat.types.catalogue import KinType, catalogue

__all__ = ["KinType", "TwinCatMachine", "catalogue", "is_twincat", "read_machine"]
