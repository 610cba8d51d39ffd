"""Other codes' stepping loops beside ours, on one packing. See ../README.md."""
