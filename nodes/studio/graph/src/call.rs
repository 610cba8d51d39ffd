//! One call of a parameter service.

use crate::graph::Graph;
use crate::observer::Observer;
use grainlab_console::Failure;
use ros2_client::qos::{History, WhenFull};
use ros2_client::{Client, Message, Name, QosProfile, ServiceMapping, ServiceTypeName};
use std::time::{Duration, Instant};

const POLL_PERIOD: Duration = Duration::from_millis(2);

/// Time after which a request is sent again: the server may have discovered this process's reader after its request.
const REPEAT_PERIOD: Duration = Duration::from_millis(500);

const TIME_LIMIT: Duration = Duration::from_secs(10);

/// Sends a request to the service, of the type `kind` of `rcl_interfaces`, until its answer arrives.
/// Errors if there is no such service or more than one, or none answers within 10 s.
pub(crate) fn call<Req: Message + Clone + 'static, Resp: Message + 'static>(
    observer: &mut Observer,
    graph: &Graph,
    service: &str,
    kind: &str,
    request: &Req,
) -> Result<Resp, Failure> {
    let services = graph.services();
    let server = match services.get(service).map(Vec::as_slice) {
        Some([server]) => server,
        Some(several) => {
            return Err(Failure::failed(format!(
                "{service} has {} servers: which one answers is undefined. See grainlab doctor",
                several.len()
            )));
        }
        None => return Err(Failure::failed(format!("no service {service} in this domain (ROS_DOMAIN_ID)"))),
    };
    // A server of rmw_cyclonedds expects the identity of a request in the payload.
    let mapping = if server.is_cyclone() { ServiceMapping::Cyclone } else { ServiceMapping::Enhanced };
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .history(History::KeepLast { depth: 10 });
    let name = Name::parse(service).map_err(|e| Failure::failed(format!("{service}: {e:?}")))?;
    let kind = ServiceTypeName::new("rcl_interfaces", kind);
    let client: Client<Req, Resp> =
        observer.node.create_client(mapping, &name, &kind, qos.clone(), qos).map_err(Failure::failed)?;
    let start = Instant::now();
    let mut asked = Vec::new();
    while start.elapsed() < TIME_LIMIT {
        let id =
            client.send_request(request.clone()).map_err(|e| Failure::failed(format!("{service}: {e:?}")))?;
        // Any of the requests may be the one that is answered.
        asked.push(id);
        let sent = Instant::now();
        while sent.elapsed() < REPEAT_PERIOD {
            match client.receive_response() {
                Ok(Some((of, response))) if asked.contains(&of) => return Ok(response),
                Ok(_) => std::thread::sleep(POLL_PERIOD),
                Err(error) => {
                    return Err(Failure::failed(format!("{service}: the answer does not decode: {error:?}")));
                }
            }
        }
    }
    Err(Failure::failed(format!("{service} did not answer within {} s", TIME_LIMIT.as_secs())))
}
