//! The hosts of `ROS_STATIC_PEERS`.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, ToSocketAddrs};

const MOST: usize = 16;

/// Other hosts that are announced to by unicast, with or without multicast: at most 16 IPv4 addresses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StaticPeers {
    hosts: [Option<Ipv4Addr>; MOST],
}

impl StaticPeers {
    /// Reads addresses, or names of hosts, separated by semicolons, as in ROS 2. A name is looked up in the host's
    /// resolver; its first IPv4 address counts.
    ///
    /// # Errors
    /// The reason, in words.
    pub fn read(text: &str) -> Result<Self, &'static str> {
        let mut peers = Self::default();
        let mut free = peers.hosts.iter_mut();
        for name in text.split(';').map(str::trim).filter(|name| !name.is_empty()) {
            let address = address_of(name)
                .ok_or("must be IPv4 addresses or known names of hosts, separated by semicolons")?;
            *free.next().ok_or("has more than 16 hosts")? = Some(address);
        }
        Ok(peers)
    }

    /// Addresses of the hosts.
    pub fn iter(&self) -> impl Iterator<Item = Ipv4Addr> + '_ {
        self.hosts.iter().flatten().copied()
    }

    /// True for an empty list of peers.
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }
}

fn address_of(name: &str) -> Option<Ipv4Addr> {
    if let Ok(address) = name.parse() {
        return Some(address);
    }
    // A resolver takes 192.0.2 for 192.0.0.2.
    if name.bytes().all(|b| b.is_ascii_digit() || b == b'.') {
        return None;
    }
    let ipv4 = |address: SocketAddr| match address.ip() {
        IpAddr::V4(address) => Some(address),
        IpAddr::V6(_) => None,
    };
    (name, 0).to_socket_addrs().ok()?.find_map(ipv4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_names_are_read_and_anything_else_is_refused() {
        let hosts = |text: &str| StaticPeers::read(text).map(|peers| peers.iter().collect::<Vec<_>>());
        let [one, two] = [Ipv4Addr::new(192, 0, 2, 1), Ipv4Addr::new(192, 0, 2, 2)];
        assert_eq!(hosts("192.0.2.1;192.0.2.2"), Ok(vec![one, two]));
        assert_eq!(hosts(" 192.0.2.2 ; ;"), Ok(vec![two]));
        assert_eq!(hosts("localhost"), Ok(vec![Ipv4Addr::LOCALHOST]));
        assert!(StaticPeers::read(";").is_ok_and(|peers| peers.is_empty()));
        for bad in ["192.0.2", "192.0.2.1,192.0.2.2", "2001:db8::1", "a b"] {
            assert!(hosts(bad).is_err(), "{bad}");
        }
        assert!(hosts(&"192.0.2.1;".repeat(MOST)).is_ok());
        assert!(hosts(&"192.0.2.1;".repeat(MOST + 1)).is_err());
    }
}
