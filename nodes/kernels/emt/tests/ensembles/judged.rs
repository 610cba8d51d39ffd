//! Packings of recipes that teach nothing: every model is judged by them.
use crate::csv;
use crate::left_out::truth;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Calibration, CalibrationSample, Modulus, Observation, Status, StrainRatioSource, Warning, models,
};

fn name(s: &CalibrationSample) -> String {
    format!(
        "{} {:.3} s {:.2} q {:.2} nu {:.2} z {:.2}",
        s.packing,
        s.pressure / s.material.effective_young() * 1e6,
        s.size_spread,
        s.stress_ratio,
        s.material.poisson_ratio,
        s.z
    )
}

#[test]
fn explore() {
    let all = csv::samples("judged.csv");
    for calibration in ["paper", "grainlab"] {
        let c = Calibration::builtin(calibration).unwrap();
        for m in models() {
            let sources = if m.uses_gamma() {
                vec![
                    StrainRatioSource::Zero,
                    StrainRatioSource::Total,
                    StrainRatioSource::Elastic,
                    StrainRatioSource::Contact,
                ]
            } else {
                vec![StrainRatioSource::Zero]
            };
            for g in sources {
                let mut count = std::collections::BTreeMap::new();
                let mut pulls: Vec<Vec<f64>> = vec![Vec::new(); 5];
                let mut sig: Vec<Vec<f64>> = vec![Vec::new(); 5];
                for s in &all {
                    if s.preparation == "smooth" {
                        continue;
                    }
                    let r = m.infer(&s.observation(g), c);
                    *count.entry(format!("{:?}", Status::of(&r))).or_insert(0) += 1;
                    let Ok(e) = r else { continue };
                    if e.status != Status::Ok {
                        continue;
                    }
                    for (i, q) in InferredQuantity::ALL.into_iter().enumerate() {
                        if q == InferredQuantity::KHat {
                            continue;
                        }
                        if let (Some(v), Some(d)) = (e.structure.get(q), e.stddev(q)) {
                            let p = (v - truth(s, q)) / d;
                            pulls[i].push(p);
                            sig[i].push(d);
                            if m.name() == "relaxed" && p.abs() > 2.7 {
                                eprintln!("   {q} {p:.2} {}", name(s));
                            }
                        }
                    }
                }
                eprint!("{calibration} {} {:?} {:?}:", m.name(), g, count);
                for (i, q) in InferredQuantity::ALL.into_iter().enumerate() {
                    let p = &pulls[i];
                    if p.is_empty() {
                        continue;
                    }
                    let n = p.len() as f64;
                    let mean = p.iter().sum::<f64>() / n;
                    let rms = (p.iter().map(|p| p * p).sum::<f64>() / n).sqrt();
                    let mut s = sig[i].clone();
                    s.sort_by(f64::total_cmp);
                    eprint!(
                        "  {q}: n {n} mean {mean:.2} rms {rms:.2} >3 {} in95 {:.3} sig {:.4}",
                        p.iter().filter(|p| p.abs() > 3.0).count(),
                        p.iter().filter(|p| p.abs() < 1.96).count() as f64 / n,
                        s[s.len() / 2]
                    );
                }
                eprintln!();
            }
        }
    }
}
