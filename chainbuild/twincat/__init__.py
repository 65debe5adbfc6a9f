"""TwinCAT CNC: parameter lists and their containers, the catalogue of KIN_TYPs, and the translation to a chain."""
