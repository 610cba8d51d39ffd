//! Domain in which a run is looked for.

use grainlab_console::Failure;
use grainlab_node_kit::{Network, is_in_use, is_launched};

/// Domains that a launcher chooses from.
const LAUNCHED: std::ops::RangeInclusive<u16> = 0..=101;

/// The domain of the environment, or else that in which a launcher works.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice {
    network: Network,
    is_set: bool,
}

impl Choice {
    pub(crate) fn from_env() -> Result<Self, Failure> {
        let is_set = std::env::var("ROS_DOMAIN_ID").is_ok_and(|v| !v.trim().is_empty());
        Ok(Self { network: Network::from_env().map_err(Failure::usage)?, is_set })
    }

    /// The network to be in, from the domain joined now and whether a run is followed there. Without `ROS_DOMAIN_ID` none
    /// is joined until a launcher works in it, because a launcher takes a domain without participants; processes started
    /// by hand are in domain 0.
    pub(crate) fn network(&self, joined: Option<u16>, is_busy: bool) -> Option<Network> {
        let in_domain = |domain| Some(Network { domain, ..self.network });
        match joined {
            _ if self.is_set => in_domain(self.network.domain),
            Some(domain) if is_busy || is_launched(domain) => in_domain(domain),
            _ => match LAUNCHED.into_iter().find(|id| is_launched(*id)) {
                Some(domain) => in_domain(domain),
                None => (joined == Some(0) || is_in_use(0)).then_some(Network { domain: 0, ..self.network }),
            },
        }
    }

    pub(crate) fn awaited(&self) -> String {
        if self.is_set {
            format!("in DDS domain {}", self.network.domain)
        } else {
            "in any DDS domain of this host".to_owned()
        }
    }
}
