//! The exchange of the lockstep against a bare ros2-client one.

use super::{Role, claim};

/// Prints both; a measurement, so it is run by hand: `cargo test --release -p node_kit --test process -- --ignored
/// --exact latency::our_exchange_beside_a_bare_one --nocapture`.
#[test]
#[ignore = "a measurement for a quiet machine"]
fn our_exchange_beside_a_bare_one() {
    let line = |text: &str, start: &str| {
        text.lines()
            .find_map(|l| l.find(start).map(|at| l[at..].to_owned()))
            .unwrap_or_else(|| panic!("{text}"))
    };
    for round in 0..3 {
        let claimed = claim();
        let network = claimed.network();
        let (pong, ping) = (Role::start("their_pong", network), Role::start("their_ping", network));
        println!("{round} {}", line(&ping.end().1, "bare:"));
        drop(pong);

        let claimed = claim();
        let network = claimed.network();
        let (pong, ping) = (Role::start("our_pong", network), Role::start("our_ping", network));
        println!("{round} alone    {}", line(&ping.end().1, "ours:"));
        drop(pong);

        let claimed = claim();
        let network = claimed.network();
        let (listener, pong) = (Role::start("our_listener", network), Role::start("our_pong", network));
        let ping = Role::start("our_ping", network);
        println!("{round} recorded {}", line(&ping.end().1, "ours:"));
        drop(pong);
        println!("{round} {}", line(&listener.end().1, "listener:"));
    }
}
