"""The program ``grainlab``: ``python -m grainlab``."""

from .program import main

main()
