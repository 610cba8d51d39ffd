//! Buses of tools, and free domains.

use crate::failure::Failure;
use grainlab_node_kit::Logger;
use grainlab_node_kit::RosArgs;
use grainlab_node_kit::Signals;
use grainlab_node_kit::{DdsBus, Identity, Names, Network, Scope};
use std::net::{Ipv4Addr, UdpSocket};

/// Joins the domain set in the environment as `name`; SIGINT and SIGTERM interrupt its waits.
pub fn tool_bus(name: &str) -> Result<DdsBus, Failure> {
    let network = Network::from_env().map_err(Failure::usage)?;
    let signals = Signals::install().map_err(Failure::failed)?;
    let mut bus = bus_in(network.domain, name)?;
    bus.watch(signals).map_err(Failure::failed)?;
    Ok(bus)
}

/// Joins a domain as `name`, with the discovery range of the environment. Logs warnings to stderr.
pub fn bus_in(domain: u16, name: &str) -> Result<DdsBus, Failure> {
    bus_as(domain, name, Identity::from_env(Scope::Everyone))
}

/// The same with this identity.
pub fn bus_as(domain: u16, name: &str, identity: Identity) -> Result<DdsBus, Failure> {
    let quiet = RosArgs { log_level: log::LevelFilter::Warn, rosout: false, ..RosArgs::default() };
    Logger::install(name, &quiet);
    let network = Network { domain, ..Network::from_env().map_err(Failure::usage)? };
    let names = Names::new(name).map_err(Failure::usage)?;
    DdsBus::join(network, names, identity).map_err(Failure::failed)
}

/// A DDS domain without participants on this host, locked against other launchers until this is dropped.
#[derive(Debug)]
pub struct FreeDomain {
    /// Its id.
    pub id: u16,
    _lock: UdpSocket,
}

/// Domains above 101 overlap with the ephemeral ports.
const DOMAINS: std::ops::RangeInclusive<u16> = 0..=101;

/// Participants of a domain whose ports precede that of the lock.
const PARTICIPANTS: u16 = 119;

impl FreeDomain {
    /// The first free domain; 0 is the default of ROS 2 tools.
    pub fn take() -> Result<Self, Failure> {
        DOMAINS.into_iter().find_map(Self::try_take).ok_or_else(|| {
            Failure::failed(
                "every DDS domain from 0 to 101 is in use on this host: set ROS_DOMAIN_ID to share one",
            )
        })
    }

    fn try_take(id: u16) -> Option<Self> {
        let bind = |offset: u16| UdpSocket::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * id + offset)).ok();
        // The last port of the domain's range, which only its 120th participant would use, is the lock
        // between launchers.
        let lock = bind(249)?;
        // A domain is in use if a port for unicast discovery of any possible participant (RTPS 9.6.2.3) is in
        // use.
        (0..PARTICIPANTS).all(|n| bind(10 + 2 * n).is_some()).then_some(Self { id, _lock: lock })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_domain_that_is_taken_is_not_given_twice() {
        let (a, b) = (FreeDomain::take().unwrap(), FreeDomain::take().unwrap());
        assert_ne!(a.id, b.id);
    }

    #[test]
    fn a_domain_with_any_participant_is_not_free() {
        let id = FreeDomain::take().unwrap().id;
        // The sixth participant, after the first five have left.
        let _participant = UdpSocket::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * id + 20)).unwrap();
        assert!(FreeDomain::try_take(id).is_none());
    }
}
