//! Domains without participants.

use crate::bus_error::{BusError, create_error};
use crate::dds::Network;
use grainlab_console::Failure;
use std::net::{Ipv4Addr, UdpSocket};

/// A DDS domain without participants on this host, locked against other launchers until this is dropped.
#[derive(Debug)]
pub struct FreeDomain {
    /// Id of the domain.
    pub id: u16,
    _lock: UdpSocket,
}

/// Domains above 101 overlap with the ephemeral ports.
const DOMAINS: std::ops::RangeInclusive<u16> = 0..=101;

/// The last port of the domain's range, which only its 120th participant would use, is the lock between launchers.
const LOCK: u16 = 249;

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

    /// The domain, on this host only.
    pub fn network(&self) -> Network {
        Network::localhost(self.id)
    }

    fn try_take(id: u16) -> Option<Self> {
        let lock = bind(id, LOCK)?;
        (!is_in_use(id)).then_some(Self { id, _lock: lock })
    }
}

/// Binds a port of a domain; `None` if the port is in use or does not exist, as the last ones of domain 232.
fn bind(id: u16, offset: u16) -> Option<UdpSocket> {
    let port = u16::try_from(7400 + 250 * u32::from(id) + u32::from(offset)).ok()?;
    UdpSocket::bind((Ipv4Addr::LOCALHOST, port)).ok()
}

/// True if a participant of this domain, at most 101, is on this host: a port for unicast discovery of any possible one
/// (RTPS 9.6.2.3) is in use.
pub fn is_in_use(id: u16) -> bool {
    !(0..PARTICIPANTS).all(|n| bind(id, 10 + 2 * n).is_some())
}

/// True if no other participant of this domain fits on this host: the port for unicast discovery of each possible one is in use.
fn is_full(id: u16) -> bool {
    // The last port is the lock between launchers where a launcher chose the domain.
    (0..=PARTICIPANTS).all(|n| bind(id, 10 + 2 * n).is_none())
}

/// Returns the error of a participant that could not be created: if the domain is full, what to do.
pub(crate) fn no_participant(domain: u16, error: &dyn std::error::Error) -> BusError {
    match create_error("DDS participant", error) {
        BusError::Network { what, .. } if is_full(domain) => {
            let reason = format!(
                "all {} ports of DDS domain {domain} on this host are in use: end other processes of the domain, or set ROS_DOMAIN_ID \
                 to another one",
                PARTICIPANTS + 1
            );
            BusError::Network { what, reason }
        }
        fault => fault,
    }
}

/// True if a launcher on this host has taken this domain, at most 101.
pub fn is_launched(id: u16) -> bool {
    bind(id, LOCK).is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_domain_that_is_taken_is_not_given_twice() {
        let (a, b) = (FreeDomain::take().unwrap(), FreeDomain::take().unwrap());
        assert_ne!(a.id, b.id);
        assert!(is_launched(a.id) && is_launched(b.id));
    }

    #[test]
    fn a_domain_without_a_free_port_is_named_with_the_variable_that_chooses_another() {
        let free = FreeDomain::take().unwrap();
        let sockets: Vec<_> = (0..=PARTICIPANTS).map(|n| bind(free.id, 10 + 2 * n)).collect();
        let error = free.network().context().err().unwrap().to_string();
        drop(sockets);
        assert!(
            error.contains(&format!("DDS domain {}", free.id)) && error.contains("ROS_DOMAIN_ID"),
            "{error}"
        );
        assert!(!is_full(free.id));
    }

    #[test]
    fn a_domain_with_any_participant_is_not_free() {
        let id = FreeDomain::take().unwrap().id;
        // The sixth participant, after the first five have left.
        let _participant = UdpSocket::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * id + 20)).unwrap();
        assert!(FreeDomain::try_take(id).is_none());
    }
}
