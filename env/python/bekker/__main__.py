"""``python -m bekker check SCRIPT...``: scripted tests in the environment; the rest is in the program ``bekker``."""

import sys

from .checks import main

if len(sys.argv) < 2 or sys.argv[1] != "check":
    sys.exit("usage: python -m bekker check SCRIPT... [--on core|fmu|environment]")
sys.exit(main(sys.argv[2:]))
