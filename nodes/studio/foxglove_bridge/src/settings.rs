//! Settings of the bridge.

use grainlab_node_kit::{Exit, NodeError, ParameterSpec, Parameters, Range, parameters};
use grainlab_recordings::Definitions;
use std::net::IpAddr;
use std::path::PathBuf;

/// The port of the bridge of ROS 2, which viewers try first.
const PORT: i64 = 8765;

/// Settings of the bridge.
#[derive(Clone, Debug)]
pub struct BridgeSettings {
    /// Address to listen on.
    pub address: IpAddr,
    /// Port to listen on; 0 is any free one.
    pub port: u16,
    /// Source of the definitions of message types.
    pub definitions: Definitions,
}

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    parameters! {
        "port" PORT, Range::Integer { min: 0, max: u16::MAX as i64 }, "TCP port to listen on; 0: any free one";
        "address" "127.0.0.1", Range::Any, "address to listen on; 0.0.0.0: every one, so that other hosts can read all topics";
        "msg_path" Vec::<String>::new(), Range::Any, "folders with package/msg/Type.msg, for types that grainlab does not have";
    }
}

impl BridgeSettings {
    /// From the parameters of [`parameters()`].
    ///
    /// # Errors
    /// If the address is none, or a folder does not exist.
    pub fn of(parameters: &Parameters) -> Result<Self, NodeError> {
        let wrong = |problem: String| NodeError::new(Exit::Usage, problem);
        let address: String = parameters.get("address");
        let example = "such as 127.0.0.1, 0.0.0.0 or ::1";
        let folders: Vec<String> = parameters.get("msg_path");
        if let Some(missing) = folders.iter().find(|f| !PathBuf::from(f).is_dir()) {
            return Err(wrong(format!("msg_path: there is no folder {missing}")));
        }
        let folders: Vec<PathBuf> = folders.into_iter().map(PathBuf::from).collect();
        Ok(Self {
            address: address
                .parse()
                .map_err(|_| wrong(format!("address: {address:?} is not an IP address, {example}")))?,
            port: u16::try_from(parameters.get::<i64>("port")).unwrap_or_default(),
            definitions: Definitions::with_folders(&folders),
        })
    }
}
