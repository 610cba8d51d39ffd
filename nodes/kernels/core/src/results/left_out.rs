//! Springs of the contact law that a stiffness lacks.

use super::elastic_stiffness::StiffnessMethod;
use crate::contact::ContactLaw;

/// What a stiffness leaves out of the contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LeftOut {
    /// The rolling springs.
    #[error(
        "the contact network has normal and tangential springs alone: the rolling springs of the contact law are left out, so \
         that the packing is at least as stiff as its moduli; the strain probe has the whole law"
    )]
    RollingSprings,
}

impl StiffnessMethod {
    /// What a stiffness of this method leaves out of `law`, if anything.
    pub fn leaves_out(self, law: &ContactLaw) -> Option<LeftOut> {
        let network = matches!(self, Self::FrozenNetwork | Self::PrestressedNetwork);
        (network && law.rolling.is_some()).then_some(LeftOut::RollingSprings)
    }
}
