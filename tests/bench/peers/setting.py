"""The setting of all codes: material, contact, load and numerics, in SI units."""

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Setting:
    """One setting for all codes; density and diameter come with the packing."""

    shear_modulus: float = 29.0e9
    """Shear modulus of the grains, Pa."""
    poisson: float = 0.2
    friction: float = 0.1
    restitution: float = 0.3
    """Coefficient of restitution, for codes that use one."""
    viscosity: float = 2.0e12
    """gamma_n of LAMMPS' gran/hertz/history, 1/(m s): a third of critical damping at this packing's mean overlap,
    which corresponds to a restitution of 0.3."""
    time_step: float = 3.0e-8
    """s."""
    skin: float = 2.0e-6
    """Distance between surfaces up to which pairs are listed, m: 1 % of the diameter. No list is rebuilt in a packing
    at rest."""
    pressure: float = 1.0e5
    """Target of the servos, Pa."""

    @property
    def young(self) -> float:
        """E = 2 G (1 + nu) of the grains, Pa."""
        return 2.0 * self.shear_modulus * (1.0 + self.poisson)

    @property
    def effective_young(self) -> float:
        """E* = E / (2 (1 - nu^2)) of two equal grains, Pa."""
        return self.young / (2.0 * (1.0 - self.poisson**2))

    def values(self) -> dict[str, float]:
        """The fields by name."""
        return asdict(self)
