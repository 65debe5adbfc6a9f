"""The command line as `python -m chainbuild`."""

import sys

from chainbuild.cli import main

if __name__ == "__main__":
    sys.exit(main())
