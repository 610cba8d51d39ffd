//! Sends mutated and forged datagrams to all processes in a domain on the loopback of this host.
//!
//! `cargo run --release -p grainlab_node_kit --example attack -- DOMAIN [COUNT]`, next to
//! `ROS_DOMAIN_ID=DOMAIN grainlab launch`. The mutated half needs the right to capture packets (root).

#[path = "../tests/process/flood.rs"]
mod flood;
#[path = "../tests/process/rtps.rs"]
#[allow(dead_code)]
mod rtps;

use std::time::Duration;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let number =
        |text: Option<String>, otherwise: &str| text.unwrap_or(otherwise.to_owned()).parse::<usize>();
    let (Ok(domain), Ok(count)) = (number(arguments.next(), ""), number(arguments.next(), "100000")) else {
        eprintln!("usage: attack DOMAIN [COUNT]");
        std::process::exit(2);
    };
    let domain = domain as u16;
    let sniffer = rtps::sniffer(flood::ports(domain));
    std::thread::sleep(Duration::from_secs(2));
    let originals = flood::overheard(sniffer.as_ref(), domain);
    let (readers, writers) = flood::learn(domain);
    println!("{} datagrams heard, {} readers, {} writers", originals.len(), readers.len(), writers.len());
    flood::flood(domain, count, &originals, &readers, &writers);
    println!("{count} datagrams sent");
}
