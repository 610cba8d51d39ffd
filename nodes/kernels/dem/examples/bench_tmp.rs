use dem::*;
use std::alloc::*;
struct Al;
unsafe impl GlobalAlloc for Al {
    unsafe fn alloc(&self, l: Layout) -> *mut u8 {
        unsafe { System.alloc(if l.size() >= 512 { l.align_to(64).unwrap() } else { l }) }
    }
    unsafe fn dealloc(&self, p: *mut u8, l: Layout) {
        unsafe { System.dealloc(p, l) }
    }
}
#[global_allocator]
static AL: Al = Al;

use grains::*;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/self/schedstat").unwrap();
    s.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let rep: usize = a[1].parse().unwrap();
    let steps: usize = a[2].parse().unwrap();
    let simd: Simd = a[3].parse().unwrap();
    let threads: usize = a[4].parse().unwrap();
    let mu: f64 = a[5].parse().unwrap();
    let look = a[6] == "look";
    let text = std::fs::read_to_string("/work/shared/anchors/peers/packing_2000.data").unwrap();
    let mut lo = [0.0; 3];
    let mut hi = [0.0; 3];
    let mut x = vec![];
    let mut on = false;
    for l in text.lines() {
        let w: Vec<&str> = l.split_whitespace().collect();
        if w.len() >= 4 && w[2].ends_with("lo") {
            let k = match w[2] {
                "xlo" => 0,
                "ylo" => 1,
                _ => 2,
            };
            lo[k] = w[0].parse::<f64>().unwrap();
            hi[k] = w[1].parse::<f64>().unwrap();
        }
        if l.starts_with("Atoms") {
            on = true;
            continue;
        }
        if l.starts_with("Velocities") {
            on = false;
        }
        if on && w.len() == 10 {
            let im = |k: usize| w[7 + k].parse::<f64>().unwrap() * 0.0;
            x.push(Vec3::from_fn(|k, _| w[4 + k].parse::<f64>().unwrap() + im(k)));
        }
    }
    let l: Vec<f64> = (0..3).map(|k| hi[k] - lo[k]).collect();
    let mut all = vec![];
    for i in 0..rep {
        for j in 0..rep {
            for k in 0..rep {
                for p in &x {
                    all.push(p + Vec3::new(i as f64 * l[0], j as f64 * l[1], k as f64 * l[2]));
                }
            }
        }
    }
    let cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(l[0], l[1], l[2]) * rep as f64))).unwrap();
    let mut cell = cell;
    if let Ok(f) = std::env::var("FCC") {
        let m: usize = f.parse().unwrap();
        let a = 2e-4 * 2f64.sqrt() * 0.9999;
        all.clear();
        for i in 0..m { for j in 0..m { for k in 0..m { for b in [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]] {
            let q = |s: f64| ((i * 73 + j * 31 + k * 17) as f64 * 12.9898 + s).sin() * 1e-9;
            all.push(Vec3::new((i as f64 + b[0]) * a + q(1.0 + b[0]), (j as f64 + b[1]) * a + q(2.0 + b[1]), (k as f64 + b[2]) * a + q(3.0 + b[2])));
        }}}}
        cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(a, a, a) * m as f64))).unwrap();
    }
    let n = all.len();
    let setting = Setting {
        friction: mu,
        damping: 0.3,
        drag: 0.0,
        spin_drag: 0.0,
        tangential: scene::Tangential::Rescaled,
        time_step: TimeStep::Fixed(3e-8),
        skin: 2e-6,
        speed_cap: None,
    };
    let mut e = Engine::new(cell, Material::GLASS, vec![1e-4; n], &all, setting);
    e.set_compute(Compute::new(simd, threads).unwrap());
    if a.len() > 7 {
        e.sort();
    }
    e.prepare().unwrap();
    let compute = e.compute().clone();
    for _ in 0..steps / 10 {
        e.step().unwrap();
    }
    let (t, c) = (std::time::Instant::now(), cpu());
    let mut s = SymTensor::isotropic(0.0);
    let period: u32 = std::env::var("PERIOD").map_or(20, |p| p.parse().unwrap());
    compute.within(|| {
        for _ in 0..steps / period as usize {
            if look {
                e.run_measured(period, |x| s = x).unwrap();
            } else {
                e.run(period).unwrap();
            }
        }
    });
    let (t, c) = (t.elapsed().as_secs_f64(), cpu() - c);
    let snap = e.snapshot().unwrap();
    println!(
        "n {n} {simd} threads {threads} mu {mu} look {look}: wall {:.2} cpu {:.2} M/s, ns/contact {:.2}, z {:.3} p {:.6e} {:e} unb {:.2e}",
        (n * steps) as f64 / t / 1e6,
        (n * steps) as f64 / c / 1e6,
        c * 1e9 / (steps as f64 * snap.contacts as f64),
        snap.coordination,
        snap.stress.tensor.xx,
        s.xx,
        snap.unbalanced
    );
}
