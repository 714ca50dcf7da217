"""`python -m app.cli`, the same as `hexapods`."""

import sys

from app.cli import main

sys.exit(main())
