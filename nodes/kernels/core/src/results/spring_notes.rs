//! Notes for the reader of a stiffness, about its springs.

use super::elastic_stiffness::StiffnessMethod;
use crate::contact::ContactLaw;
use crate::packing::Packing;

/// A difference between the springs of a stiffness and the contact law of the packing, or those that inversions are
/// calibrated for.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SpringNote {
    /// The rolling springs are left out.
    #[error(
        "without the rolling springs of the contact law: the shear moduli may be several times too low; the strain probe \
         (analyze --method probe) has the whole law"
    )]
    WithoutRolling,
    /// There are no tangential springs, as in the packing.
    #[error(
        "without tangential springs, since its contacts carry no tangential force (friction 0); no inversion is calibrated for \
         that"
    )]
    Frictionless,
    /// The prestress is left out, although the packing has no friction.
    #[error(
        "without prestress, which lowers the moduli of packings without friction near isostaticity (analyze has --method \
         prestressed)"
    )]
    WithoutPrestress,
    /// There are no tangential springs, although the packing has friction.
    #[error(
        "without tangential springs, as asked, although contacts carry tangential forces (friction {friction}); no inversion is \
         calibrated for that"
    )]
    TangentialLeftOut {
        /// Friction coefficient of the packing.
        friction: f64,
    },
    /// There are tangential springs, although the packing has no friction.
    #[error(
        "with tangential springs, as asked, although contacts without friction carry no tangential force"
    )]
    TangentialAdded,
    /// Sliding contacts have a tangential spring.
    #[error(
        "with the tangential springs of all contacts, also of the {:.1} % at the Coulomb limit: the response to a strain so \
         small that none slides",
        100.0 * .share
    )]
    SlidingStuck {
        /// Share of the contacts at the limit.
        share: f64,
    },
}

impl SpringNote {
    /// Notes on a stiffness of `packing` by this method; `smooth` if it has no tangential springs.
    pub fn of(packing: &Packing, method: StiffnessMethod, smooth: bool) -> Vec<Self> {
        Self::on(&packing.law, packing.friction, packing.sliding_fraction(), method, smooth)
    }

    /// Notes for a contact law, a friction coefficient in force, and a share of contacts at its limit.
    pub(super) fn on(
        law: &ContactLaw,
        friction: f64,
        share: f64,
        method: StiffnessMethod,
        smooth: bool,
    ) -> Vec<Self> {
        let tangential = match (smooth, friction > 0.0) {
            (true, true) => Some(Self::TangentialLeftOut { friction }),
            (true, false) => Some(Self::Frictionless),
            (false, false) => Some(Self::TangentialAdded),
            (false, true) => (share > 0.0).then_some(Self::SlidingStuck { share }),
        };
        let network = !matches!(method, StiffnessMethod::StrainProbe);
        let rolling = (network && law.rolling.is_some()).then_some(Self::WithoutRolling);
        let unstressed = matches!(method, StiffnessMethod::FrozenNetwork);
        let prestress = (unstressed && smooth && friction <= 0.0).then_some(Self::WithoutPrestress);
        tangential.into_iter().chain(rolling).chain(prestress).collect()
    }
}
