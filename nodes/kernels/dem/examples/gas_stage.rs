use std::time::Instant;
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let (n, rate, k) = (a[0] as u32, a[1], a[2]);
    let gas = dem::gas::place(n, 2e-4, 0.3, 1.0, 1).unwrap();
    let mut h = dem::event_driven::HardSpheres::new(gas.cell, vec![1e-4; n as usize], gas.positions, gas.velocities).unwrap();
    let begin = Instant::now();
    let (mut count, mut slices, mut t) = (0, 0, 0.0);
    while h.solid_fraction() < 0.607 {
        let dt = k * dem::event_driven::mean_free_time(h.solid_fraction(), 2e-4, 1.0);
        let (_, c) = h.advance(rate, dt).unwrap();
        h.limit_speed(1.0);
        count += c.count; slices += 1; t += dt;
        if slices % 20 == 0 { println!("{slices} phi {:.4} Z {:.2} collisions a grain {:.2}", h.solid_fraction(), c.compressibility, 2.0 * c.count as f64 / n as f64); }
    }
    let s = begin.elapsed().as_secs_f64();
    println!("{n} grains: {s:.3} s, {slices} slices, {count} collisions, {:.3} M/s, {:.0} a grain, t {t:.4}", count as f64 / s / 1e6, 2.0 * count as f64 / f64::from(n));
}
