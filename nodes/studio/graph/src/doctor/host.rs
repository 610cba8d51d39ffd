//! Network and environment of this host.

use super::finding::Finding;
use super::processes::first_port;
use grainlab_node_kit::processes::udp_sockets;
use grainlab_node_kit::{Network, Reach};
use socket2::{Domain, Protocol, Socket, Type};
use std::collections::BTreeSet;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::time::Duration;

/// The group of discovery (RTPS 9.6.1.4.1).
const GROUP: Ipv4Addr = Ipv4Addr::new(239, 255, 0, 1);

/// Time limit for a datagram to this host.
const ARRIVES: Duration = Duration::from_millis(300);

/// Receive buffer below which packings are sent more than once, bytes.
const BUFFER: u64 = 1 << 20;

/// Greatest domain whose ports do not overlap with the ephemeral ports of Linux.
const SAFE_DOMAIN: u16 = 101;

/// Variables that have no effect, or that contradict each other.
pub(super) fn environment(get: impl Fn(&str) -> Option<String>) -> Vec<Finding> {
    let mut found = Vec::new();
    if let Err(error) = Network::from_variables(&get) {
        found.push(Finding::error(
            "environment",
            error.to_string(),
            "correct or unset the variable; no node starts with it",
        ));
    }
    let set = |name: &str| get(name).filter(|v| !v.is_empty());
    if set("ROS_LOCALHOST_ONLY").as_deref() == Some("1")
        && set("ROS_AUTOMATIC_DISCOVERY_RANGE").is_some_and(|v| v.eq_ignore_ascii_case("SUBNET"))
    {
        found.push(Finding::warning(
            "environment_conflict",
            "ROS_LOCALHOST_ONLY=1 overrides ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET: this host only".into(),
            "unset ROS_LOCALHOST_ONLY, which ROS 2 has replaced",
        ));
    }
    if let Some(rmw) = set("RMW_IMPLEMENTATION").filter(|v| v.contains("zenoh")) {
        found.push(Finding::error(
            "environment_rmw",
            format!(
                "RMW_IMPLEMENTATION={rmw}: nodes of ROS 2 started here use Zenoh, which DDS does not reach"
            ),
            "start them with rmw_fastrtps_cpp or rmw_cyclonedds_cpp",
        ));
    }
    found
}

pub(super) fn network(network: Network) -> Vec<Finding> {
    let advice =
        "keep it if that network is trusted, or put WireGuard between the hosts and set GRAINLAB_INTERFACE";
    let exposed = network.exposure().map(|text| Finding::note("exposed", text.to_owned(), advice));
    let mut found: Vec<Finding> = exposed.into_iter().collect();
    let interface = match network.reach {
        Reach::Localhost => Ipv4Addr::LOCALHOST,
        Reach::Subnet => Ipv4Addr::UNSPECIFIED,
    };
    if let Err(reason) = arrives_by_multicast(interface) {
        found.push(Finding::error(
            "no_multicast",
            format!("multicast to {GROUP} does not arrive ({reason}): nodes find each other by fixed ports only, or not at all"),
            "check that the interface is up (ip link set lo up) and passes multicast (ip link set lo multicast on), and the rules of the \
             firewall",
        ));
    }
    let blocked: Vec<u16> = sample_ports(network.domain).filter(|port| !arrives(*port)).collect();
    if !blocked.is_empty() {
        let ports: Vec<String> = blocked.iter().map(u16::to_string).collect();
        let (from, to) = (first_port(network.domain), first_port(network.domain).saturating_add(249));
        found.push(Finding::error(
            "blocked_ports",
            format!("datagrams to UDP port {} of this host do not arrive", ports.join(", ")),
            format!(
                "check that loopback is up (ip link set lo up), and let the firewall pass UDP {from} to {to}, the ports of domain {}",
                network.domain
            ),
        ));
    }
    if network.domain > SAFE_DOMAIN {
        found.push(Finding::warning(
            "domain_ports",
            format!("the ports of domain {} overlap with the ephemeral ports of Linux", network.domain),
            format!("use a domain from 0 to {SAFE_DOMAIN}"),
        ));
    }
    if let Some(limit) = receive_limit().filter(|limit| *limit < BUFFER) {
        found.push(Finding::warning(
            "receive_buffer",
            format!("net.core.rmem_max is {limit} bytes: bursts of large messages are lost and sent again"),
            format!("sysctl -w net.core.rmem_max={}", 4 * BUFFER),
        ));
    }
    let others = domains_in_use().into_iter().filter(|d| *d != network.domain);
    let others: Vec<String> = others.map(|d| d.to_string()).collect();
    if !others.is_empty() {
        found.push(Finding::note(
            "domains_in_use",
            format!("other domains with participants on this host: {}", others.join(", ")),
            "set ROS_DOMAIN_ID to see another one",
        ));
    }
    found
}

fn arrives_by_multicast(interface: Ipv4Addr) -> Result<(), String> {
    let text = |e: std::io::Error| e.to_string();
    let receiver = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).map_err(text)?;
    receiver.join_multicast_v4(&GROUP, &interface).map_err(text)?;
    receiver.set_read_timeout(Some(ARRIVES)).map_err(text)?;
    let sender = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP)).map_err(text)?;
    sender.set_multicast_if_v4(&interface).map_err(text)?;
    sender.set_multicast_loop_v4(true).map_err(text)?;
    let port = receiver.local_addr().map_err(text)?.port();
    let word = word();
    sender.send_to(&word, &SocketAddr::new(IpAddr::V4(GROUP), port).into()).map_err(text)?;
    if received(&receiver, &word) {
        Ok(())
    } else {
        Err(format!("nothing within {} ms", ARRIVES.as_millis()))
    }
}

/// True if a datagram to this port of this host arrives. A port in use is not checked: its owner receives.
fn arrives(port: u16) -> bool {
    let Ok(receiver) = UdpSocket::bind((Ipv4Addr::LOCALHOST, port)) else { return true };
    let word = word();
    let sent = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))
        .and_then(|sender| sender.send_to(&word, (Ipv4Addr::LOCALHOST, port)));
    receiver.set_read_timeout(Some(ARRIVES)).is_ok() && sent.is_ok() && received(&receiver, &word)
}

/// Content that no other program sends.
fn word() -> Vec<u8> {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
    format!("grainlab doctor {} {now}", std::process::id()).into_bytes()
}

fn received(socket: &UdpSocket, word: &[u8]) -> bool {
    let mut buffer = [0; 256];
    // Others may send to the port, too.
    (0..16).any(|_| matches!(socket.recv(&mut buffer), Ok(n) if &buffer[..n] == word))
}

/// Ports of the domain that only its last possible participants would use.
fn sample_ports(domain: u16) -> impl Iterator<Item = u16> {
    [240, 241].into_iter().filter_map(move |offset| first_port(domain).checked_add(offset))
}

fn receive_limit() -> Option<u64> {
    std::fs::read_to_string("/proc/sys/net/core/rmem_max").ok()?.trim().parse().ok()
}

/// Domains in which a UDP port of discovery is in use on this host.
fn domains_in_use() -> BTreeSet<u16> {
    // The first port of a domain is that of multicast discovery, which every participant opens.
    let above = udp_sockets().into_iter().filter_map(|socket| socket.port.checked_sub(first_port(0)));
    above.filter(|above| above % 250 == 0).map(|above| above / 250).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(variables: &[(&str, &str)]) -> Vec<&'static str> {
        let get = |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned());
        environment(get).into_iter().map(|f| f.kind).collect()
    }

    #[test]
    fn variables_that_stop_nodes_or_contradict_each_other_are_named() {
        assert!(kinds(&[("ROS_DOMAIN_ID", "7")]).is_empty());
        assert_eq!(kinds(&[("ROS_DOMAIN_ID", "seven")]), ["environment"]);
        assert_eq!(kinds(&[("RMW_IMPLEMENTATION", "rmw_zenoh_cpp")]), ["environment_rmw"]);
        let both = [("ROS_LOCALHOST_ONLY", "1"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")];
        assert_eq!(kinds(&both), ["environment_conflict"]);
    }

    #[test]
    fn a_datagram_to_this_host_arrives() {
        let free = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap().port();
        assert!(arrives(free));
    }
}
