//! Round trips between two processes by RustDDS, and who receives from whom, with and without DDS Security.
//!
//! `dds_security echo DIR DOMAIN...`, `dds_security ping DIR BYTES ROUNDS DOMAIN...`, `dds_security chat DIR NUMBER SECONDS DOMAIN`.
//! A participant of domain 0, or with the DIR `-`, has no security.

use futures::{StreamExt, executor::block_on};
use rustdds::dds::CreateResult;
use rustdds::no_key::{DataReaderCdr, DataWriterCdr};
use rustdds::{DomainParticipant, DomainParticipantBuilder, QosPolicyBuilder, TopicKind, policy};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// A sample as `sample.idl` defines it. Words, because CDR passes each element through serde.
#[derive(Serialize, Deserialize, Clone, Debug)]
struct Sample {
    words: Vec<u64>,
}

fn participant(dir: &str, domain: u16) -> DomainParticipant {
    let builder = DomainParticipantBuilder::new(domain);
    #[cfg(feature = "security")]
    let builder = if dir == "-" || domain == 0 {
        builder
    } else {
        let files = rustdds::DomainParticipantSecurityConfigFiles::with_ros_default_names(dir, String::new());
        builder.builtin_security(files)
    };
    assert!(cfg!(feature = "security") || dir == "-");
    builder.build().unwrap_or_else(|e| stop(&format!("no participant: {e}")))
}

fn stop(reason: &str) -> ! {
    println!("refused: {reason}");
    std::process::exit(0)
}

/// A writer of topic `to` and a reader of topic `from`.
fn ends(
    participant: &DomainParticipant,
    to: &str,
    from: &str,
) -> (CreateResult<DataWriterCdr<Sample>>, DataReaderCdr<Sample>) {
    let max_blocking_time = rustdds::Duration::from_secs(1);
    let qos = QosPolicyBuilder::new()
        .reliability(policy::Reliability::Reliable { max_blocking_time })
        .history(policy::History::KeepLast { depth: 16 })
        .build();
    let topic = |name: &str| {
        let topic = participant.create_topic(name.to_owned(), "Sample".to_owned(), &qos, TopicKind::NoKey);
        topic.unwrap_or_else(|e| stop(&format!("no topic {name}: {e}")))
    };
    let (publisher, subscriber) = (participant.create_publisher(&qos), participant.create_subscriber(&qos));
    let writer = publisher.unwrap().create_datawriter_no_key_cdr(&topic(to), None);
    let reader = subscriber.unwrap().create_datareader_no_key_cdr(&topic(from), None);
    (writer, reader.unwrap_or_else(|e| stop(&format!("no reader: {e}"))))
}

fn echo(dir: &str, domains: &[u16]) {
    std::thread::scope(|scope| {
        for &domain in domains {
            scope.spawn(move || {
                let participant = participant(dir, domain);
                let (writer, reader) = ends(&participant, "pong", "ping");
                let writer = writer.unwrap();
                let mut samples = reader.async_sample_stream();
                while let Some(sample) = block_on(samples.next()) {
                    writer.write(sample.unwrap().into_value(), None).unwrap();
                }
            });
        }
    });
}

/// Round trips of all domains in turn, so that whatever else the machine does slows all of them alike.
fn ping(dir: &str, bytes: usize, rounds: usize, domains: &[u16]) {
    let sample = Sample { words: vec![1; bytes / 8] };
    let participants: Vec<_> = domains.iter().map(|&domain| participant(dir, domain)).collect();
    let both = |(writer, reader): (CreateResult<_>, _)| (writer.unwrap(), reader);
    let mut ends: Vec<_> = participants.iter().map(|p| both(ends(p, "ping", "pong"))).collect();
    for (writer, reader) in &mut ends {
        while reader.take_next_sample().unwrap().is_none() {
            writer.write(sample.clone(), None).unwrap();
            std::thread::sleep(Duration::from_millis(200));
        }
        std::thread::sleep(Duration::from_secs(1));
        while reader.take_next_sample().unwrap().is_some() {}
    }
    let (writers, readers): (Vec<_>, Vec<_>) = ends.into_iter().unzip();
    let mut streams: Vec<_> = readers.into_iter().map(DataReaderCdr::async_sample_stream).collect();
    let mut times = vec![Vec::new(); domains.len()];
    for round in 2..rounds as u64 + 2 {
        for ((writer, samples), times) in writers.iter().zip(&mut streams).zip(&mut times) {
            let mut sample = sample.clone();
            sample.words[0] = round;
            let start = Instant::now();
            writer.write(sample, None).unwrap();
            // An answer may be one to a sample of the start.
            while block_on(samples.next()).unwrap().unwrap().into_value().words[0] != round {}
            times.push(start.elapsed().as_micros());
        }
    }
    for (domain, times) in domains.iter().zip(&mut times) {
        times.sort_unstable();
        let at = |part: usize| times[times.len() * part / 100];
        println!(
            "domain {domain}, {bytes} bytes, {rounds} round trips: median {} µs, 90 % {} µs",
            at(50),
            at(90)
        );
    }
}

fn chat(dir: &str, number: u64, seconds: u64, domain: u16) {
    let participant = participant(dir, domain);
    let (writer, mut reader) = ends(&participant, "chat", "chat");
    let (start, mut heard) = (Instant::now(), BTreeMap::new());
    while start.elapsed() < Duration::from_secs(seconds) {
        if let Ok(writer) = &writer {
            writer.write(Sample { words: vec![number] }, None).unwrap();
        }
        while let Ok(Some(sample)) = reader.take_next_sample() {
            *heard.entry(sample.value().words[0]).or_insert(0) += 1;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    heard.remove(&number);
    println!("{}heard {heard:?}", if writer.is_ok() { "" } else { "may not write, " });
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let numbers = |from: usize| args[from..].iter().map(|a| a.parse().unwrap()).collect::<Vec<u16>>();
    match args[0].as_str() {
        "echo" => echo(&args[1], &numbers(2)),
        "ping" => ping(&args[1], args[2].parse().unwrap(), args[3].parse().unwrap(), &numbers(4)),
        _ => chat(&args[1], args[2].parse().unwrap(), args[3].parse().unwrap(), numbers(4)[0]),
    }
}
