//! Domains without participants.

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

/// A port of a domain, unless it is in use.
fn bind(id: u16, offset: u16) -> Option<UdpSocket> {
    UdpSocket::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * id + offset)).ok()
}

/// True if a participant of this domain, at most 101, is on this host: a port for unicast discovery of any possible one
/// (RTPS 9.6.2.3) is in use.
pub fn is_in_use(id: u16) -> bool {
    !(0..PARTICIPANTS).all(|n| bind(id, 10 + 2 * n).is_some())
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
    fn a_domain_with_any_participant_is_not_free() {
        let id = FreeDomain::take().unwrap().id;
        // The sixth participant, after the first five have left.
        let _participant = UdpSocket::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * id + 20)).unwrap();
        assert!(FreeDomain::try_take(id).is_none());
    }
}
