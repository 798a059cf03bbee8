"""`python -m plaus` is the command `plaus`."""

import sys

from plaus._command import main

sys.exit(main())
