"""Runs the command line as ``python -m chainbuild.cli``."""

import sys

from chainbuild.cli.entry import main

sys.exit(main())
