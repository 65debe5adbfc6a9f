"""SINUMERIK machine data of the ROBX transformation: catalogue, alarms, reader and translation to a chain."""

from chainbuild.formats.sinumerik.machine import RobxMachine, read_machine
from chainbuild.formats.sinumerik.reading.reader import is_sinumerik

__all__ = ["RobxMachine", "is_sinumerik", "read_machine"]
