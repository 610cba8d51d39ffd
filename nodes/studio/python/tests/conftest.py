"""Packings for the tests."""

import pathlib

import grainlab
import pytest

TOP = pathlib.Path(__file__).resolve().parents[4]


@pytest.fixture(scope="session")
def run():
    """The packings of a small run."""
    return list(grainlab.simulate("demo", seed=3, set={"grains.count": 150}))


@pytest.fixture(scope="session")
def packing(run):
    return run[-1]


@pytest.fixture(scope="session")
def golden():
    """2,000 grains."""
    (packing,) = grainlab.load(TOP / "tests/golden/packings/anisotropic_2000.csv.gz")
    return packing


@pytest.fixture(scope="session")
def smooth():
    """500 grains without friction."""
    (packing,) = grainlab.load(TOP / "tests/golden/packings/smooth_500.csv.gz")
    return packing


@pytest.fixture(scope="session")
def recording():
    """A recorded run, made by the code that runs these tests; None if it made none."""
    import os

    path = os.environ.get("GRAINLAB_RECORDING")
    if path is None:
        pytest.skip("GRAINLAB_RECORDING is not set to a recording")
    return path
