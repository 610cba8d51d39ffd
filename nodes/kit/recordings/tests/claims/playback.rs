//! The player sends the right message at the right time.

use std::time::Duration;

use grainlab_recordings::{Play, PlayOptions, Player, Recording};

use crate::support::{of_bytes, run_in};

const MS: Duration = Duration::from_millis(1);

fn recording() -> Recording {
    let root = tempfile::tempdir().unwrap();
    let (_, bytes) = run_in(&root, 500);
    of_bytes(&bytes)
}

/// Plays to the end, sleeping exactly as requested; returns topic, sequence and time of each message.
fn play(player: &mut Player<'_>) -> Vec<(String, u32, Duration)> {
    let (mut now, mut sent) = (Duration::from_secs(1000), Vec::new());
    let start = now;
    loop {
        match player.poll(now) {
            Play::Send(m) => sent.push((m.channel.topic.clone(), m.sequence, now - start)),
            Play::Wait(time) => now += time,
            Play::Done => return sent,
            Play::Paused => panic!("nobody paused"),
        }
    }
}

#[test]
fn messages_come_at_their_recorded_distances() {
    let recording = recording();
    let options = PlayOptions { topics: Some(vec!["stress".into()]), ..PlayOptions::default() };
    for (rate, step) in [(1.0, 1.0), (4.0, 0.25)] {
        let mut player = Player::new(&recording, &PlayOptions { rate, ..options.clone() }).unwrap();
        let sent = play(&mut player);
        assert_eq!(sent.len(), 500);
        for (k, (_, sequence, time)) in sent.iter().enumerate() {
            assert_eq!(*sequence, k as u32 + 1);
            // Waits are whole nanoseconds.
            assert!((time.as_secs_f64() * 1e3 - k as f64 * step).abs() < 1e-3, "{sequence} at {time:?}");
        }
        assert_eq!(player.slipped(), Duration::ZERO);
    }
}

#[test]
fn a_start_in_the_middle_sends_the_latched_state_first() {
    let recording = recording();
    let options = PlayOptions {
        start_offset: 300 * MS,
        duration: Some(10 * MS),
        exclude: vec!["/clock".into()],
        ..PlayOptions::default()
    };
    let sent = play(&mut Player::new(&recording, &options).unwrap());
    assert_eq!((sent[0].0.as_str(), sent[0].2), ("/packing", Duration::ZERO));
    let stresses: Vec<u32> = sent[1..].iter().map(|s| s.1).collect();
    assert_eq!(stresses, (301..311).collect::<Vec<_>>());
}

#[test]
fn a_late_caller_delays_all_topics_alike() {
    let recording = recording();
    let mut player = Player::new(&recording, &PlayOptions::default()).unwrap();
    assert!(matches!(player.poll(Duration::ZERO), Play::Send(_)));
    // 150 ms pass instead of 1 ms: the next message is sent at once, the one after it 1 ms later.
    assert!(matches!(player.poll(150 * MS), Play::Send(m) if m.sequence == 2));
    assert!(matches!(player.poll(150 * MS), Play::Wait(time) if time == MS));
    assert_eq!(player.slipped(), 149 * MS);
}

#[test]
fn pause_stops_the_schedule_and_resume_goes_on_where_it_was() {
    let recording = recording();
    let options = PlayOptions { topics: Some(vec!["/stress".into()]), ..PlayOptions::default() };
    let mut player = Player::new(&recording, &options).unwrap();
    assert!(matches!(player.poll(Duration::ZERO), Play::Send(_)));
    player.pause(MS / 2);
    assert!(player.is_paused());
    assert!(matches!(player.poll(500 * MS), Play::Paused));
    player.resume(1000 * MS);
    assert!(matches!(player.poll(1000 * MS), Play::Wait(time) if time == MS / 2));
    player.set_rate(1000 * MS, 0.5).unwrap();
    assert!(matches!(player.poll(1000 * MS), Play::Wait(time) if time == MS));
    assert_eq!(player.slipped(), Duration::ZERO);
}

#[test]
fn an_infinite_rate_never_waits() {
    let recording = recording();
    let mut player =
        Player::new(&recording, &PlayOptions { rate: f64::INFINITY, ..Default::default() }).unwrap();
    let sent = play(&mut player);
    assert_eq!((sent.len(), sent.last().unwrap().2), (551, Duration::ZERO));
}

#[test]
fn what_cannot_be_played_is_refused() {
    let recording = recording();
    let error = |options: PlayOptions| Player::new(&recording, &options).err().unwrap();
    for rate in [0.0, -1.0, f64::NAN] {
        assert!(error(PlayOptions { rate, ..Default::default() }).to_string().starts_with("rate "));
    }
    let late = error(PlayOptions { start_offset: Duration::from_secs(9), ..Default::default() });
    assert!(late.to_string().contains("beyond the end"), "{late}");
    let missing =
        error(PlayOptions { topics: Some(vec!["nothing".into()]), ..Default::default() }).to_string();
    assert!(missing.contains("nothing") && missing.contains("/stress"), "{missing}");
}

#[test]
fn a_stopped_schedule_sends_one_message_per_step_and_continues_from_there() {
    let recording = recording();
    let options = PlayOptions { topics: Some(vec!["stress".into()]), ..PlayOptions::default() };
    let mut player = Player::new(&recording, &options).unwrap();
    let now = Duration::from_secs(1000);
    player.pause(now);
    assert!(matches!(player.poll(now), Play::Paused));
    for expected in 1..=3 {
        player.step(now);
        assert!(matches!(player.poll(now), Play::Send(m) if m.sequence == expected), "{expected}");
        assert!(matches!(player.poll(now + 50 * MS), Play::Paused));
    }
    player.resume(now);
    assert!(matches!(player.poll(now), Play::Wait(time) if time == MS), "the fourth is 1 ms after the third");
    for _ in 4..=500 {
        player.step(now);
        assert!(matches!(player.poll(now), Play::Send(_)));
    }
    player.step(now);
    assert!(matches!(player.poll(now), Play::Done));
}
