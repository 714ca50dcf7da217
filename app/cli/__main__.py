"""Entry point of `python -m app.cli`, equivalent to `hexapods`."""

import sys

from app.cli import main

sys.exit(main())
