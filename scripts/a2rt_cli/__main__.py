"""Entry point of `python -m a2rt_cli`."""

import sys

from a2rt_cli.app import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
