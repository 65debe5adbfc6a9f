"""The command line as `python -m chainbuild`."""

from chainbuild.cli import main

if __name__ == "__main__":
    main()
