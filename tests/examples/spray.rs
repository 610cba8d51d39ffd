//! Another host that sends a number of datagrams (first argument) to the ports of DDS domain 0 on 192.0.2.1 and to the multicast
//! group: announcements of participants that do not exist, samples, fragments of samples of 2 GB, and garbage.

use std::net::UdpSocket;
use std::time::Duration;

fn main() -> std::io::Result<()> {
    let datagrams: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(8);
    let socket = UdpSocket::bind("192.0.2.2:0")?;
    let packets = |i: u64| {
        let prefix = [&i.to_le_bytes()[..], &[9; 4]].concat();
        let start = [&b"RTPS\x02\x04\x01\x12"[..], &prefix].concat();
        let submessage = |kind: u8, flags: u8, body: &[u8]| {
            [&start[..], &[kind, flags], &(body.len() as u16).to_le_bytes(), body].concat()
        };
        let announcement = {
            let parameter = |id: u8, value: &[u8]| [&[id, 0, value.len() as u8, 0][..], value].concat();
            let guid = [&prefix[..], &[0, 0, 1, 0xc1]].concat();
            let payload = [
                &[0, 3, 0, 0][..],
                &parameter(0x15, &[2, 4, 0, 0]),
                &parameter(0x16, &[1, 0x12, 0, 0]),
                &parameter(0x50, &guid),
                &parameter(0x02, &[0xff, 0xff, 0xff, 0x7f, 0, 0, 0, 0]),
                &parameter(0x58, &[0x3f, 0x0c, 0, 0]),
                &[1, 0, 0, 0],
            ]
            .concat();
            let ids = [0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0];
            submessage(0x15, 5, &[&ids[..], &payload].concat())
        };
        let sample = {
            let ids = [0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 1, 0xc3, 0, 0, 0, 0, 1, 0, 0, 0];
            submessage(0x15, 5, &[&ids[..], &[0, 1, 0, 0, 1, 2, 3, 4]].concat())
        };
        let fragment = {
            let ids = [0, 0, 28, 0, 0, 0, 0, 0, 0, 0, 1, 0xc3, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
            let sizes = [1, 0, 0, 1, 0, 0, 0, 0x80];
            submessage(0x16, 1, &[&ids[..], &sizes, &[0; 256]].concat())
        };
        [announcement, sample, fragment, vec![0x5a; 200]]
    };
    for i in 0..datagrams / 8 {
        // The well-known ports more often than the others.
        let port =
            if i % 2 == 0 { 7400 + [0, 1, 10, 11][i as usize / 2 % 4] } else { 7400 + (i / 2 % 250) as u16 };
        for packet in packets(i) {
            for host in ["192.0.2.1", "239.255.0.1"] {
                // Errors of earlier sends are reported here.
                let _ = socket.send_to(&packet, (host, port));
            }
        }
        if i % 20 == 0 {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
    Ok(())
}
