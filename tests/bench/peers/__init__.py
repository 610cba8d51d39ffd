"""Stepping loops of other codes and of grainlab on one packing. See ../README.md."""
