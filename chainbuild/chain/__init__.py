"""The kinematic chain: the one thing between machine data and everything computed from them."""
