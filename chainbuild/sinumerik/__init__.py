"""SINUMERIK machine data of the ROBX transformation: catalogue, alarms, reader and translation to a chain."""
