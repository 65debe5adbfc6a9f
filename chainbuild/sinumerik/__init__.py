"""SINUMERIK machine data of the ROBX transformation: catalogue, alarms, reader and translation to a chain."""

from chainbuild.sinumerik.machine import RobxMachine, read_machine
from chainbuild.sinumerik.reader import is_sinumerik

__all__ = ["RobxMachine", "is_sinumerik", "read_machine"]
