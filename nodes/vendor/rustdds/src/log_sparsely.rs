// Logging of what anybody on the network can cause as often as they like: the
// first time, and then at powers of two, so that a flood cannot fill a disk.

/// `warn!` at the 1st, 2nd, 4th, 8th, ... time the line is reached.
macro_rules! warn_sparsely {
  ($($arg:tt)+) => {{
    static COUNT: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);
    let times = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
    if times.is_power_of_two() {
      log::warn!("{} (time {times})", format_args!($($arg)+));
    }
  }};
}

#[test]
fn a_line_is_logged_at_powers_of_two() {
  log::set_max_level(log::LevelFilter::Warn);
  let mut logged = 0;
  let mut log = || logged += 1;
  for _ in 0..1000 {
    warn_sparsely!("{:?}", log());
  }
  // None at all if another test has set the level meanwhile.
  assert!(logged <= 10);
}
