use std::{
  collections::HashMap,
  io,
  net::{IpAddr, Ipv4Addr, SocketAddr},
};

use log::{error, warn};

use crate::{
  rtps::{
    constant::{payload_budget_for_mtu, FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE},
    transmit::InterfaceSelector,
  },
  structure::locator::Locator,
};

/// Platform-neutral view of one network-interface address.
///
/// `getifaddrs` gives one entry per assigned IP; we normalize it into this small
/// struct. The inner helper functions then operate on `IfAddr` alone, which
/// keeps them free of any enumeration dependency and makes them trivially
/// unit-testable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct IfAddr {
  /// An IP address bound to the interface.
  pub ip: IpAddr,
  /// OS interface index. `0` when unknown / not applicable.
  pub index: u32,
  pub is_loopback: bool,
  /// Whether the interface is multicast-capable.
  pub is_multicast: bool,
  /// IPv4 subnet mask for `ip` (only populated for IPv4 addresses). Used to
  /// decide whether a peer is on the same subnet (i.e. reachable in one hop).
  pub netmask: Option<Ipv4Addr>,
  /// Interface MTU in bytes, when the OS reports it. Drives the per-peer
  /// datagram-payload budget for same-subnet peers.
  pub mtu: Option<u32>,
}

// ---------------------------------------------------------------------------
// Interface enumeration (Unix, via getifaddrs)
// ---------------------------------------------------------------------------

/// Enumerate all interface addresses by `getifaddrs`, in the order of the
/// interfaces, IPv4 before IPv6. The MTU is that of `/sys/class/net`, so it is
/// known on Linux only; elsewhere the default budget is used.
fn enumerate_interfaces() -> io::Result<Vec<IfAddr>> {
  use nix::{
    ifaddrs::getifaddrs,
    net::if_::{if_nametoindex, InterfaceFlags},
  };

  let mut result = Vec::new();
  for entry in getifaddrs()? {
    let Some(address) = entry.address else { continue };
    let ip = if let Some(v4) = address.as_sockaddr_in() {
      IpAddr::V4(v4.ip())
    } else if let Some(v6) = address.as_sockaddr_in6() {
      IpAddr::V6(v6.ip())
    } else {
      continue;
    };
    let name = entry.interface_name.as_str();
    // IPv4-only subnet matching for now; IPv6 peers fall back to default.
    let netmask = entry.netmask.filter(|_| ip.is_ipv4());
    result.push(IfAddr {
      ip,
      index: if_nametoindex(name).unwrap_or(0),
      is_loopback: entry.flags.contains(InterfaceFlags::IFF_LOOPBACK),
      is_multicast: entry.flags.contains(InterfaceFlags::IFF_MULTICAST),
      netmask: netmask.and_then(|mask| mask.as_sockaddr_in().map(|mask| mask.ip())),
      mtu: std::fs::read_to_string(format!("/sys/class/net/{name}/mtu"))
        .ok()
        .and_then(|text| text.trim().parse().ok()),
    });
  }
  result.sort_by_key(|address| (address.index, address.ip.is_ipv6()));

  Ok(result)
}

// ---------------------------------------------------------------------------
// Per-peer path-MTU resolution
// ---------------------------------------------------------------------------

/// Snapshot of the local interface table, used by writers to resolve a per-peer
/// datagram budget. Built once (and refreshed on interface-set changes) and
/// shared with each `Writer` via the event loop.
pub fn local_interface_table() -> Vec<IfAddr> {
  match enumerate_interfaces() {
    Ok(ifaces) => ifaces,
    Err(e) => {
      error!("Cannot enumerate local interfaces for path-MTU resolution: {e:?}");
      Vec::new()
    }
  }
}

/// Resolve the per-peer UDP-payload budget (bytes available for RTPS
/// submessages in one datagram) for `peer_ip`, using the "local
/// egress-interface MTU" heuristic:
///
/// * If some local IPv4 interface's subnet contains `peer_ip`, the peer is
///   reachable in one hop, so we use that interface's MTU (minus headers).
///   Loopback peers (e.g. `127.0.0.1`) naturally match `lo`/`lo0` and inherit
///   its (often large) MTU.
/// * Otherwise the peer is behind a router (or IPv6 / unresolved), where the
///   real path MTU is unknown; fall back to
///   [`FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE`] (a conservative
///   ~1500-byte-Ethernet budget).
///
/// An overestimate is a soft failure (IP fragmentation), never data loss, so
/// this errs toward the safe default when unsure.
pub fn path_mtu_payload_for_peer(ifaces: &[IfAddr], peer_ip: IpAddr) -> usize {
  if let IpAddr::V4(peer) = peer_ip {
    for ifa in ifaces {
      let (IpAddr::V4(local), Some(mask)) = (ifa.ip, ifa.netmask) else {
        continue;
      };
      if same_subnet_v4(local, mask, peer) {
        if let Some(mtu) = ifa.mtu {
          return payload_budget_for_mtu(mtu);
        }
        // Same subnet but MTU unknown: keep scanning in case another matching
        // interface reports one; otherwise we fall through to the default.
      }
    }
  }
  FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE
}

/// True when `local` and `peer` share the IPv4 subnet defined by `mask`.
fn same_subnet_v4(local: Ipv4Addr, mask: Ipv4Addr, peer: Ipv4Addr) -> bool {
  let m = u32::from(mask);
  (u32::from(local) & m) == (u32::from(peer) & m)
}

// ---------------------------------------------------------------------------
// Public API
// ---------------------------------------------------------------------------

pub fn get_local_multicast_locators(port: u16) -> Vec<Locator> {
  let saddr = SocketAddr::new("239.255.0.1".parse().unwrap(), port);
  vec![Locator::from(saddr)]
}

/// Build the unicast "localhost SPDP peer" locators for same-host discovery.
///
/// Returns `127.0.0.1:spdp_well_known_unicast_port(domain_id, pid)` for every
/// `pid` in `0..max_participants`, skipping `own_participant_id` (there is no
/// need to announce to ourselves; multicast + the self reader-proxy already
/// cover that). Sending SPDP to these fixed destinations lets two participants
/// on the same host find each other with no external network and without
/// relying on loopback multicast. See
/// `src/rtps/loopback_same_host_design.md`.
pub fn localhost_spdp_peer_locators(
  domain_id: u16,
  own_participant_id: u16,
  max_participants: u16,
) -> Vec<Locator> {
  (0..max_participants)
    .filter(|pid| *pid != own_participant_id)
    .map(|pid| {
      Locator::from(SocketAddr::new(
        IpAddr::V4(Ipv4Addr::LOCALHOST),
        crate::network::constant::spdp_well_known_unicast_port(domain_id, pid),
      ))
    })
    .collect()
}

/// Build the unicast SPDP locators of the hosts in `peers`:
/// `host:spdp_well_known_unicast_port(domain_id, pid)` for every `pid` in
/// `0..max_participants` (RTPS 2.5 Section 9.6.1.4).
pub fn initial_spdp_peer_locators(
  peers: &[Ipv4Addr],
  domain_id: u16,
  max_participants: u16,
) -> Vec<Locator> {
  let port = |pid| crate::network::constant::spdp_well_known_unicast_port(domain_id, pid);
  peers
    .iter()
    .flat_map(|host| {
      (0..max_participants).map(move |pid| Locator::from(SocketAddr::new((*host).into(), port(pid))))
    })
    .collect()
}

pub fn get_local_unicast_locators_filtered(
  port: u16,
  only_networks: Option<&[IpAddr]>,
) -> Vec<Locator> {
  match enumerate_interfaces() {
    Ok(ifaces) => {
      let result = get_local_unicast_locators_inner(&ifaces, port, only_networks);
      if result.is_empty() {
        if let Some(nets) = only_networks {
          warn!(
            "only_networks filter {:?} matched no unicast interfaces; this participant will be \
             invisible to peers.",
            nets,
          );
        }
      }
      result
    }
    Err(e) => {
      error!("Cannot get local network interfaces: {e:?}");
      vec![]
    }
  }
}

fn get_local_unicast_locators_inner(
  ifaces: &[IfAddr],
  port: u16,
  only_networks: Option<&[IpAddr]>,
) -> Vec<Locator> {
  ifaces
    .iter()
    // Our unicast transport (both `UDPListener` and the `UDPSender` unicast
    // socket) is IPv4-only, so an announced IPv6 locator is unreachable: peers
    // -- including our own participant, which discovers itself over multicast
    // loopback -- would try to send there and get EAFNOSUPPORT per datagram.
    // Link-local IPv6 is doubly useless, as a `Locator` carries no scope id.
    .filter(|ifa| ifa.ip.is_ipv4())
    .filter(|ifa| only_networks.is_none_or(|nets| nets.contains(&ifa.ip)))
    .map(|ifa| Locator::from(SocketAddr::new(ifa.ip, port)))
    .collect()
}

/// Enumerates local interfaces that we may use for multicasting.
///
/// The result of this function is used to set up senders and listeners.
/// When `only_networks` is `Some`, only interfaces with a matching IP are
/// included, and of loopback no multicast flag is asked: Linux does not set it
/// on `lo`, and multicasts there all the same.
pub fn get_local_multicast_ip_addrs_filtered(
  only_networks: Option<&[IpAddr]>,
) -> io::Result<Vec<IpAddr>> {
  let ifaces = enumerate_interfaces()?;
  let result = get_local_multicast_ip_addrs_inner(&ifaces, only_networks);
  Ok(result)
}

/// Inner implementation of [`get_local_multicast_ip_addrs_filtered`], factored
/// out so tests can supply a mock interface list.
fn get_local_multicast_ip_addrs_inner(
  ifaces: &[IfAddr],
  only_networks: Option<&[IpAddr]>,
) -> Vec<IpAddr> {
  ifaces
    .iter()
    .filter(|ifa| match only_networks {
      Some(nets) => nets.contains(&ifa.ip) && (ifa.is_multicast || ifa.is_loopback),
      None => ifa.is_multicast,
    })
    .map(|ifa| ifa.ip)
    .filter(IpAddr::is_ipv4)
    .collect()
}

/// Whether one of these addresses belongs to an interface with the multicast
/// flag. Only then peers are told to send by multicast.
pub fn is_any_flagged_multicast(addresses: &[Ipv4Addr]) -> bool {
  match enumerate_interfaces() {
    Ok(ifaces) => is_any_flagged_multicast_inner(&ifaces, addresses),
    Err(_) => false,
  }
}

fn is_any_flagged_multicast_inner(ifaces: &[IfAddr], addresses: &[Ipv4Addr]) -> bool {
  ifaces
    .iter()
    .filter(|ifa| ifa.is_multicast)
    .any(|ifa| matches!(ifa.ip, IpAddr::V4(a) if addresses.contains(&a)))
}

/// OS indices of the interfaces on which a participant restricted to
/// `only_networks` listens: those that carry one of the addresses, and
/// loopback, over which everything from this host arrives.
pub fn allowed_interface_indices(only_networks: &[IpAddr]) -> Vec<u32> {
  match enumerate_interfaces() {
    Ok(ifaces) => allowed_interface_indices_inner(&ifaces, only_networks),
    Err(e) => {
      error!("Cannot enumerate local interfaces to restrict listening: {e:?}");
      Vec::new()
    }
  }
}

fn allowed_interface_indices_inner(ifaces: &[IfAddr], only_networks: &[IpAddr]) -> Vec<u32> {
  let mut indices: Vec<u32> = ifaces
    .iter()
    .filter(|ifa| ifa.is_loopback || only_networks.contains(&ifa.ip))
    .map(|ifa| ifa.index)
    .collect();
  indices.sort_unstable();
  indices.dedup();
  indices
}

/// The address to bind unicast sockets to: loopback, if the participant is
/// restricted to it, so that the kernel delivers nothing else. Any other
/// restriction has to leave room for same-host peers that send to loopback.
pub fn unicast_bind_address(only_networks: Option<&[IpAddr]>) -> Ipv4Addr {
  match only_networks {
    Some([IpAddr::V4(only)]) if only.is_loopback() => *only,
    _ => Ipv4Addr::UNSPECIFIED,
  }
}

/// OS index of the one interface, loopback aside, that a participant restricted
/// to `only_networks` sends by. `None`: no restriction, or several interfaces,
/// between which the routes choose. An address that no interface has gives an
/// index that none has, so that nothing is sent.
pub fn outgoing_interface_index(only_networks: Option<&[IpAddr]>) -> Option<u32> {
  let mut others = only_networks?.iter().filter(|ip| !ip.is_loopback());
  let (Some(only), None) = (others.next(), others.next()) else {
    return None;
  };
  let ifaces = enumerate_interfaces().unwrap_or_default();
  let found = ifaces.iter().find(|ifa| ifa.ip == *only);
  Some(found.map_or(i32::MAX.unsigned_abs(), |ifa| ifa.index))
}

/// Builds a mapping from OS interface index to an [`InterfaceSelector`].
///
/// Used to resolve the `ipi_ifindex` reported by `IP_PKTINFO`/`IPV6_PKTINFO`
/// into the interface identity our sender uses (its IP). Prefers an IPv4
/// address so the result matches the keys of the multicast sender sockets.
pub fn build_ifindex_to_interface_map() -> HashMap<u32, InterfaceSelector> {
  match enumerate_interfaces() {
    Ok(ifaces) => build_ifindex_map_inner(&ifaces),
    Err(e) => {
      error!("Cannot build interface-index map: {e:?}");
      HashMap::new()
    }
  }
}

fn build_ifindex_map_inner(ifaces: &[IfAddr]) -> HashMap<u32, InterfaceSelector> {
  let mut map: HashMap<u32, InterfaceSelector> = HashMap::new();
  for ifa in ifaces {
    if ifa.index == 0 {
      continue;
    }
    match map.get(&ifa.index) {
      // First address seen for this index.
      None => {
        map.insert(ifa.index, InterfaceSelector::Ip(ifa.ip));
      }
      // Prefer an IPv4 address over a previously stored non-IPv4 one, so the
      // result matches the (IPv4) multicast sender socket keys.
      Some(InterfaceSelector::Ip(existing)) if ifa.ip.is_ipv4() && !existing.is_ipv4() => {
        map.insert(ifa.index, InterfaceSelector::Ip(ifa.ip));
      }
      Some(_) => {}
    }
  }
  map
}

#[cfg(test)]
mod tests {
  use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};

  use super::{
    allowed_interface_indices_inner, build_ifindex_map_inner, get_local_multicast_ip_addrs_inner,
    get_local_unicast_locators_inner, initial_spdp_peer_locators, is_any_flagged_multicast_inner,
    localhost_spdp_peer_locators,
    path_mtu_payload_for_peer, unicast_bind_address, IfAddr, InterfaceSelector,
  };
  use crate::{
    network::constant::spdp_well_known_unicast_port,
    rtps::constant::FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE, structure::locator::Locator,
  };

  #[test]
  #[cfg(target_os = "linux")]
  fn loopback_is_listed_with_its_mask_and_mtu() {
    let table = super::local_interface_table();
    let lo = table.iter().find(|i| i.ip == Ipv4Addr::LOCALHOST).unwrap();
    assert!(lo.is_loopback && lo.index > 0 && lo.mtu.is_some_and(|mtu| mtu > 1500));
    assert_eq!(lo.netmask, Some(Ipv4Addr::new(255, 0, 0, 0)));
  }

  fn v4(a: u8, b: u8, c: u8, d: u8) -> IpAddr {
    IpAddr::V4(Ipv4Addr::new(a, b, c, d))
  }

  fn iface(ip: IpAddr, index: u32, is_loopback: bool, is_multicast: bool) -> IfAddr {
    IfAddr {
      ip,
      index,
      is_loopback,
      is_multicast,
      netmask: None,
      mtu: None,
    }
  }

  // Build an interface entry with an IPv4 subnet mask and MTU, for path-MTU
  // resolution tests.
  fn iface_v4(a: u8, b: u8, c: u8, d: u8, prefix: u8, mtu: u32, is_loopback: bool) -> IfAddr {
    let mask = if prefix == 0 {
      0u32
    } else {
      u32::MAX << (32 - u32::from(prefix))
    };
    IfAddr {
      ip: v4(a, b, c, d),
      index: 1,
      is_loopback,
      is_multicast: !is_loopback,
      netmask: Some(Ipv4Addr::from(mask)),
      mtu: Some(mtu),
    }
  }

  #[test]
  fn test_get_local_multicast_ip_addrs() {
    let ifaces = vec![
      // loopback: not multicast-capable
      iface(IpAddr::V4(Ipv4Addr::LOCALHOST), 0, true, false),
      iface(IpAddr::V6(Ipv6Addr::LOCALHOST), 0, true, false),
      // eth0: multicast-capable, IPv4 + IPv6
      iface(v4(192, 168, 0, 137), 1, false, true),
      iface(
        IpAddr::V6(Ipv6Addr::new(0xfd73, 0x40a2, 0x1c3e, 0, 0, 0, 0, 0)),
        1,
        false,
        true,
      ),
    ];

    let ips = get_local_multicast_ip_addrs_inner(&ifaces, None);

    // Only IPv4 is currently supported for multicast enumeration.
    assert_eq!(ips.len(), 1, "should only contain the non-loopback iface");
    assert!(ips.contains(&v4(192, 168, 0, 137)));
  }

  #[test]
  fn no_multicast() {
    let mut ifaces = Vec::new();
    for index in 0..10 {
      ifaces.push(iface(
        v4(192, 168, 0, rand::random()),
        index + 1,
        false,
        false, // no multicast support
      ));
    }

    let ips = get_local_multicast_ip_addrs_inner(&ifaces, None);
    assert!(
      ips.is_empty(),
      "we only want interfaces w/ multicast support"
    );
  }

  #[test]
  fn loopback_multicasts_without_the_flag_if_it_is_asked_for_by_name() {
    let lo = iface(v4(127, 0, 0, 1), 1, true, false);
    let lan = iface(v4(192, 168, 0, 1), 2, false, false);
    let ifaces = [lo.clone(), lan.clone()];
    let named = [lo.ip, lan.ip];
    assert_eq!(
      get_local_multicast_ip_addrs_inner(&ifaces, Some(&named)),
      vec![lo.ip]
    );
    assert!(get_local_multicast_ip_addrs_inner(&ifaces, Some(&named[1..])).is_empty());
    assert!(get_local_multicast_ip_addrs_inner(&ifaces, None).is_empty());

    let flagged = iface(v4(127, 0, 0, 1), 1, true, true);
    assert!(!is_any_flagged_multicast_inner(&[lo], &[Ipv4Addr::LOCALHOST]));
    assert!(is_any_flagged_multicast_inner(&[flagged], &[Ipv4Addr::LOCALHOST]));
  }

  #[test]
  fn empty_interfaces() {
    let ips = get_local_multicast_ip_addrs_inner(&[], None);
    assert!(
      ips.is_empty(),
      "blank iface list should result in empty list of ips"
    );
  }

  #[test]
  fn multicast_filter_respects_only_networks() {
    let ifaces = vec![
      iface(v4(192, 168, 0, 10), 1, false, true),
      iface(v4(10, 0, 0, 10), 2, false, true),
    ];

    let only_networks = [v4(10, 0, 0, 10)];
    let ips = get_local_multicast_ip_addrs_inner(&ifaces, Some(&only_networks));

    assert_eq!(ips, vec![v4(10, 0, 0, 10)]);
  }

  #[test]
  fn unicast_filter_respects_only_networks() {
    let only_networks = [v4(10, 0, 0, 10)];
    let ifaces = vec![
      iface(v4(192, 168, 0, 10), 1, false, true),
      iface(v4(10, 0, 0, 10), 2, false, true),
    ];

    let filtered = get_local_unicast_locators_inner(&ifaces, 7412, Some(&only_networks));

    assert_eq!(
      filtered,
      vec![Locator::from(SocketAddr::new(v4(10, 0, 0, 10), 7412))]
    );
  }

  // Our unicast transport is IPv4-only, so IPv6 interface addresses must never
  // be announced as unicast locators: peers (and we ourselves, via loopback
  // discovery) would send there and get EAFNOSUPPORT on every datagram.
  #[test]
  fn unicast_locators_exclude_ipv6() {
    let ifaces = vec![
      iface(v4(192, 168, 0, 10), 1, false, true),
      // link-local IPv6, as found on e.g. docker0 / veth interfaces
      iface(
        IpAddr::V6(Ipv6Addr::new(
          0xfe80, 0, 0, 0, 0xd494, 0x8fff, 0xfe08, 0x3ce3,
        )),
        1,
        false,
        true,
      ),
      iface(
        IpAddr::V6(Ipv6Addr::new(0xfd73, 0x40a2, 0x1c3e, 0, 0, 0, 0, 1)),
        1,
        false,
        true,
      ),
    ];

    let filtered = get_local_unicast_locators_inner(&ifaces, 7412, None);

    assert_eq!(
      filtered,
      vec![Locator::from(SocketAddr::new(v4(192, 168, 0, 10), 7412))]
    );
  }

  #[test]
  fn ifindex_map_prefers_ipv4_and_skips_index_zero() {
    let ifaces = vec![
      // index 0 -> skipped
      iface(IpAddr::V4(Ipv4Addr::LOCALHOST), 0, true, false),
      // index 3, IPv6 seen before IPv4: IPv4 should win
      iface(
        IpAddr::V6(Ipv6Addr::new(0xfe80, 0, 0, 0, 0, 0, 0, 1)),
        3,
        false,
        true,
      ),
      iface(v4(10, 0, 0, 7), 3, false, true),
    ];

    let map = build_ifindex_map_inner(&ifaces);
    assert!(!map.contains_key(&0), "index 0 must be skipped");
    assert_eq!(
      map.get(&3),
      Some(&InterfaceSelector::Ip(v4(10, 0, 0, 7))),
      "should prefer the IPv4 address"
    );
  }

  // A peer on the same /24 as a local interface uses that interface's MTU
  // (minus the 48-byte IPv4+UDP+RTPS header overhead).
  #[test]
  fn path_mtu_same_subnet_uses_iface_mtu() {
    let ifaces = vec![
      iface_v4(127, 0, 0, 1, 8, 16384, true),
      iface_v4(192, 168, 1, 10, 24, 1500, false),
    ];
    assert_eq!(
      path_mtu_payload_for_peer(&ifaces, v4(192, 168, 1, 55)),
      1500 - 48
    );
  }

  // A loopback peer matches the loopback interface and inherits its large MTU.
  #[test]
  fn path_mtu_loopback_peer_uses_loopback_mtu() {
    let ifaces = vec![
      iface_v4(127, 0, 0, 1, 8, 16384, true),
      iface_v4(192, 168, 1, 10, 24, 1500, false),
    ];
    assert_eq!(
      path_mtu_payload_for_peer(&ifaces, v4(127, 0, 0, 1)),
      16384 - 48
    );
  }

  // A peer not in any local subnet is assumed to be behind a router: use the
  // conservative Ethernet default.
  #[test]
  fn path_mtu_behind_router_uses_default() {
    let ifaces = vec![iface_v4(192, 168, 1, 10, 24, 1500, false)];
    assert_eq!(
      path_mtu_payload_for_peer(&ifaces, v4(10, 20, 30, 40)),
      FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE
    );
  }

  // An IPv6 peer has no IPv4 subnet to match: fall back to the default.
  #[test]
  fn path_mtu_ipv6_peer_uses_default() {
    let ifaces = vec![iface_v4(192, 168, 1, 10, 24, 9000, false)];
    let peer = IpAddr::V6(Ipv6Addr::LOCALHOST);
    assert_eq!(
      path_mtu_payload_for_peer(&ifaces, peer),
      FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE
    );
  }

  // A jumbo-frame interface yields a correspondingly large budget.
  #[test]
  fn path_mtu_jumbo_frame() {
    let ifaces = vec![iface_v4(10, 0, 0, 1, 8, 9000, false)];
    assert_eq!(
      path_mtu_payload_for_peer(&ifaces, v4(10, 1, 2, 3)),
      9000 - 48
    );
  }

  // Empty table -> default.
  #[test]
  fn path_mtu_empty_table_uses_default() {
    assert_eq!(
      path_mtu_payload_for_peer(&[], v4(192, 168, 1, 1)),
      FALLBACK_MAX_AGGREGATED_DATAGRAM_SIZE
    );
  }

  #[test]
  fn restricted_listening_covers_given_and_loopback_interfaces_only() {
    let ifaces = [
      iface(v4(127, 0, 0, 1), 1, true, false),
      iface(v4(192, 0, 2, 1), 2, false, true),
      iface(v4(198, 51, 100, 1), 3, false, true),
    ];
    let allowed = |nets: &[IpAddr]| allowed_interface_indices_inner(&ifaces, nets);
    assert_eq!(allowed(&[v4(127, 0, 0, 1)]), vec![1]);
    assert_eq!(allowed(&[v4(198, 51, 100, 1)]), vec![1, 3]);
  }

  #[test]
  fn sockets_are_bound_to_loopback_only_if_nothing_else_is_allowed() {
    let lo = v4(127, 0, 0, 1);
    assert_eq!(unicast_bind_address(Some(&[lo])), Ipv4Addr::LOCALHOST);
    assert_eq!(unicast_bind_address(None), Ipv4Addr::UNSPECIFIED);
    let both = [lo, v4(192, 0, 2, 1)];
    assert_eq!(unicast_bind_address(Some(&both)), Ipv4Addr::UNSPECIFIED);
    assert_eq!(
      unicast_bind_address(Some(&both[1..])),
      Ipv4Addr::UNSPECIFIED
    );
  }

  #[test]
  fn initial_peers_are_announced_to_on_their_well_known_ports() {
    let hosts = [Ipv4Addr::new(192, 0, 2, 1), Ipv4Addr::new(192, 0, 2, 9)];
    let addresses: Vec<String> = initial_spdp_peer_locators(&hosts, 1, 2)
      .into_iter()
      .map(|locator| SocketAddr::from(locator).to_string())
      .collect();
    let expected = ["192.0.2.1:7660", "192.0.2.1:7662", "192.0.2.9:7660", "192.0.2.9:7662"];
    assert_eq!(addresses, expected);
  }

  #[test]
  fn localhost_spdp_peers_cover_range_excluding_self() {
    let domain = 0;
    let own = 2;
    let peers = localhost_spdp_peer_locators(domain, own, 4);
    // pids 0,1,3 (not 2), all on 127.0.0.1 at the well-known SPDP unicast ports.
    let expected: Vec<Locator> = [0u16, 1, 3]
      .iter()
      .map(|pid| {
        Locator::from(SocketAddr::new(
          IpAddr::V4(Ipv4Addr::LOCALHOST),
          spdp_well_known_unicast_port(domain, *pid),
        ))
      })
      .collect();
    assert_eq!(peers, expected);
    assert!(peers
      .iter()
      .all(|l| SocketAddr::from(*l).ip().is_loopback()));
  }
}
