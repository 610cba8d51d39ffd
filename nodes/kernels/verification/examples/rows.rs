//! Prints the rows.
fn main() {
    let all = [grainlab_verification::lammps_pairs::rows(), grainlab_verification::chung_ooi::rows(),
    grainlab_verification::mercury::rows(), grainlab_verification::ondem::rows(), grainlab_verification::grainlearning::rows()];
    for r in all.into_iter().flat_map(Result::unwrap) {
        let w = r.worst();
        if std::env::args().nth(1).is_some_and(|a| r.name.contains(&a)) { for p in &r.points { println!("    {p:?}"); } }
        println!("{:<62} {:?} {:.2e} <= {:.0e}  unexplained {:?}  {:?}", r.name, r.verdict(), r.difference().unwrap_or(-1.0), r.tolerance, r.unexplained(), w);
    }
}
