//! Domains for tests: two tests that run at once on one host must use different ones.

use super::network::Network;
use std::net::{Ipv4Addr, TcpListener};

/// The domains for tests: below 101, where Linux has no ephemeral ports, and above those that users choose.
const DOMAINS: std::ops::Range<u16> = 20..101;

/// A domain that no other holder of a claim on this host uses, until this is dropped.
#[derive(Debug)]
pub struct ClaimedDomain {
    network: Network,
    /// The domain's first port number, as TCP: RTPS uses UDP alone.
    _lock: TcpListener,
}

impl ClaimedDomain {
    /// Claims a free domain; `None` if every one is in use.
    pub fn claim() -> Option<Self> {
        let start = std::process::id() as u16 % DOMAINS.len() as u16;
        let rotated = (0..DOMAINS.len() as u16).map(|i| DOMAINS.start + (start + i) % DOMAINS.len() as u16);
        rotated.into_iter().find_map(|domain| {
            let lock = TcpListener::bind((Ipv4Addr::LOCALHOST, 7400 + 250 * domain)).ok()?;
            Some(Self { network: Network::localhost(domain), _lock: lock })
        })
    }

    /// The domain, on this host only.
    pub fn network(&self) -> Network {
        self.network
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_claims_never_share_a_domain() {
        let claims: Vec<ClaimedDomain> = (0..5).map_while(|_| ClaimedDomain::claim()).collect();
        let mut domains: Vec<u16> = claims.iter().map(|c| c.network().domain).collect();
        domains.sort_unstable();
        domains.dedup();
        assert_eq!(domains.len(), claims.len());
        assert!(!claims.is_empty());
    }
}
