//! The bus of a tool.

use crate::args::RosArgs;
use crate::dds::{DdsBus, Network};
use crate::identity::{Identity, Scope};
use crate::logging::Logger;
use crate::names::Names;
use grainlab_console::{Failure, Signals};

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
    bus_named(domain, Names::new(name).map_err(Failure::usage)?, Identity::from_env(Scope::Everyone))
}

/// Joins a domain with these names of topics and this identity.
pub fn bus_named(domain: u16, names: Names, identity: Identity) -> Result<DdsBus, Failure> {
    let quiet = RosArgs { log_level: log::LevelFilter::Warn, rosout: false, ..RosArgs::default() };
    Logger::install(names.node(), &quiet);
    let network = Network { domain, ..Network::from_env().map_err(Failure::usage)? };
    DdsBus::join(network, names, identity).map_err(Failure::failed)
}
