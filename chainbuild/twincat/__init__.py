"""TwinCAT CNC: parameter lists and their containers, the catalogue of KIN_TYPs, and the translation to a chain."""

from chainbuild.twincat.catalogue import KinType, catalogue
from chainbuild.twincat.files import is_twincat, read_machine
from chainbuild.twincat.machine import TwinCatMachine

__all__ = ["KinType", "TwinCatMachine", "catalogue", "is_twincat", "read_machine"]
