//! Domain and discovery range from the ROS 2 environment variables, as far as RustDDS supports them.

use super::static_peers::StaticPeers;
use nix::ifaddrs::getifaddrs;
use ros2_client::Context;
use std::net::Ipv4Addr;

/// The range of discovery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// This host only, over the loopback interface. The default.
    Localhost,
    /// All hosts that multicast reaches, the default of ROS 2.
    Subnet,
}

/// Domain and range of discovery of a participant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Network {
    /// DDS domain, 0 to 232; participants of different domains do not discover each other.
    pub domain: u16,
    /// The range of discovery by multicast.
    pub reach: Reach,
    /// Hosts that are found without multicast.
    pub peers: StaticPeers,
    /// Address of the only interface, besides loopback, that is used; `None` for all of them.
    pub interface: Option<Ipv4Addr>,
}

/// Name or address of the only interface by which other hosts are reached. ROS 2 has no variable for it.
const INTERFACE: &str = "GRAINLAB_INTERFACE";

/// What to do about a full domain.
pub const CROWDING_ADVICE: &str =
    "choose another domain (ROS_DOMAIN_ID), or end the programs that fill this one";

/// Returns a sentence about the participants that discovery ignores because the domain is full, if it ignores any.
pub fn crowding(context: &Context) -> Option<String> {
    let participant = context.domain_participant();
    let (domain, refused) = (participant.domain_id(), participant.refused_participants());
    let ignored = grainlab_console::count(refused, "participant");
    (refused > 0).then(|| format!("DDS domain {domain} is full, and {ignored} of other programs are ignored"))
}

/// Greatest domain whose ports fit 16 bits with room for participants (RTPS 9.6.2.3).
pub const MAX_DOMAIN: u16 = 232;

/// A variable with an unsupported value, why it is not supported, and what to do. The process then ends with [`crate::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NetworkError(String);

impl Network {
    /// This host only, in the given domain.
    pub fn localhost(domain: u16) -> Self {
        Self { domain, reach: Reach::Localhost, peers: StaticPeers::default(), interface: None }
    }

    /// Reads `ROS_DOMAIN_ID`, `ROS_AUTOMATIC_DISCOVERY_RANGE`, `ROS_LOCALHOST_ONLY`, `ROS_STATIC_PEERS` and
    /// `GRAINLAB_INTERFACE`.
    pub fn from_env() -> Result<Self, NetworkError> {
        Self::from_variables(|name| std::env::var(name).ok())
    }

    /// Reads them from any source of variables; an empty one counts as unset.
    pub fn from_variables(lookup: impl Fn(&str) -> Option<String>) -> Result<Self, NetworkError> {
        let get =
            |variable: &'static str| lookup(variable).map(|v| v.trim().to_owned()).filter(|v| !v.is_empty());
        let refuse = |variable: &str, value: &str, reason: &str| {
            NetworkError(format!("{variable}={value:?}: {reason}"))
        };

        let domain = match get("ROS_DOMAIN_ID") {
            None => 0,
            Some(text) => match text.parse() {
                Ok(domain) if domain <= MAX_DOMAIN => domain,
                _ => return Err(refuse("ROS_DOMAIN_ID", &text, "must be a whole number from 0 to 232")),
            },
        };
        let localhost_only = get("ROS_LOCALHOST_ONLY");
        let reach = match get("ROS_AUTOMATIC_DISCOVERY_RANGE") {
            // ROS_LOCALHOST_ONLY is deprecated in ROS 2, but 1 still overrides the range.
            _ if localhost_only.as_deref() == Some("1") => Reach::Localhost,
            None => Reach::Localhost,
            Some(text) => match text.to_ascii_uppercase().as_str() {
                "LOCALHOST" => Reach::Localhost,
                "SUBNET" | "SYSTEM_DEFAULT" => Reach::Subnet,
                other => {
                    let reason = if other == "OFF" {
                        "RustDDS cannot run without discovery, and the processes of one run must find each other; use LOCALHOST"
                    } else {
                        "must be LOCALHOST, SUBNET or SYSTEM_DEFAULT"
                    };
                    return Err(refuse("ROS_AUTOMATIC_DISCOVERY_RANGE", &text, reason));
                }
            },
        };
        let peers = match get("ROS_STATIC_PEERS") {
            // ROS_LOCALHOST_ONLY=1 is stronger in ROS 2, too.
            Some(text) if localhost_only.as_deref() != Some("1") => {
                StaticPeers::read(&text).map_err(|reason| refuse("ROS_STATIC_PEERS", &text, reason))?
            }
            _ => StaticPeers::default(),
        };
        let open = Self { domain, reach, peers, interface: None };
        // An interface that is absent, such as a tunnel that is down, must not end in the use of all others.
        let interface = match get(INTERFACE) {
            Some(name) if open.exposure().is_some() => Some(address_of_interface(&name).ok_or_else(|| {
                let reason = "must be the name or the IPv4 address of an interface of this host other than loopback, with an IPv4 address";
                refuse(INTERFACE, &name, reason)
            })?),
            _ => None,
        };
        Ok(Self { interface, ..open })
    }

    /// A warning if other hosts are reached: messages are neither encrypted nor signed.
    pub fn exposure(&self) -> Option<&'static str> {
        let is_open = self.reach == Reach::Subnet || self.peers != StaticPeers::default();
        is_open.then_some(
            "other hosts are reached (ROS_AUTOMATIC_DISCOVERY_RANGE or ROS_STATIC_PEERS): everybody in that network can read the messages and \
             disturb the nodes",
        )
    }
}

/// The first IPv4 address of the interface with this name, or the address itself if an interface has it.
fn address_of_interface(name: &str) -> Option<Ipv4Addr> {
    let interfaces =
        getifaddrs().ok()?.filter_map(|i| Some((i.interface_name, i.address?.as_sockaddr_in()?.ip())));
    let mut addresses = interfaces.filter(|(_, address)| !address.is_loopback());
    addresses.find(|(interface, address)| interface == name || address.to_string() == name).map(|(_, a)| a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)]) -> Result<Network, NetworkError> {
        Network::from_variables(|name| variables.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).into()))
    }

    #[test]
    fn everything_stays_on_this_host_unless_asked() {
        assert_eq!(read(&[]), Ok(Network::localhost(0)));
        assert_eq!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "")]), Ok(Network::localhost(0)));
        assert_eq!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "subnet")]).unwrap().reach, Reach::Subnet);
        assert_eq!(
            read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT")]).unwrap().reach,
            Reach::Subnet
        );
        assert_eq!(read(&[]).unwrap().exposure(), None);
        for open in [("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"), ("ROS_STATIC_PEERS", "127.0.0.1")] {
            assert!(read(&[open]).unwrap().exposure().is_some(), "{open:?}");
        }
        let both = [("ROS_LOCALHOST_ONLY", "1"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")];
        assert_eq!(read(&both).unwrap().reach, Reach::Localhost);
        assert_eq!(read(&[("ROS_LOCALHOST_ONLY", "0")]), Ok(Network::localhost(0)));
    }

    #[test]
    fn the_domain_is_checked() {
        assert_eq!(read(&[("ROS_DOMAIN_ID", "42")]), Ok(Network::localhost(42)));
        for bad in ["-1", "233", "x", "4.0"] {
            let error = read(&[("ROS_DOMAIN_ID", bad)]).unwrap_err().to_string();
            assert!(error.contains("ROS_DOMAIN_ID") && error.contains(bad), "{error}");
        }
    }

    #[test]
    fn static_peers_are_hosts_unless_everything_stays_on_this_one() {
        let peers = ("ROS_STATIC_PEERS", "192.0.2.1;192.0.2.2");
        let network = read(&[peers]).unwrap();
        assert_eq!((network.reach, network.peers.iter().count()), (Reach::Localhost, 2));
        assert_eq!(read(&[peers, ("ROS_LOCALHOST_ONLY", "1")]), Ok(Network::localhost(0)));
        let error = read(&[("ROS_STATIC_PEERS", "192.0.2.1,192.0.2.2")]).unwrap_err().to_string();
        assert!(error.contains("ROS_STATIC_PEERS") && error.contains("semicolons"), "{error}");
    }

    #[test]
    fn an_interface_that_is_absent_is_refused_where_other_hosts_are_reached() {
        let peers = ("ROS_STATIC_PEERS", "192.0.2.1");
        for absent in ["absent0", "lo", "127.0.0.1", "192.0.2.99"] {
            let error = read(&[peers, (INTERFACE, absent)]).unwrap_err().to_string();
            assert!(error.contains(INTERFACE) && error.contains(absent), "{error}");
            assert_eq!(read(&[(INTERFACE, absent)]), Ok(Network::localhost(0)));
        }
        let ipv4 =
            |i: nix::ifaddrs::InterfaceAddress| Some((i.interface_name, i.address?.as_sockaddr_in()?.ip()));
        let mut present = getifaddrs().unwrap().filter_map(ipv4);
        if let Some((name, address)) = present.find(|(_, address)| !address.is_loopback()) {
            for named in [name, address.to_string()] {
                assert_eq!(read(&[peers, (INTERFACE, &named)]).unwrap().interface, Some(address), "{named}");
            }
        }
    }

    #[test]
    fn what_cannot_be_honoured_is_refused_with_the_reason() {
        assert!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")]).is_err());
        assert!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "NEAR")]).is_err());
    }
}
