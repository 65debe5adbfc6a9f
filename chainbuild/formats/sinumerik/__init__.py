"""SINUMERIK machine data of the ROBX transformation."""
