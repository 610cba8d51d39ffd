//! Every method on one packing.

use super::args::{Args, CONVERGED, Method};
use super::report::{Error, Row};
use crate::cpu_time::thread_seconds;
use crate::numbers::median;
use grainlab_console::{Failure, say};
use grainlab_core::results::NotJammed;
use grainlab_core::{Packing, Stiffness};
use grainlab_micromechanics::PackingView;
use grainlab_micromechanics::network::{
    Solver, SpringNetwork, Springs, relaxed_stiffness, uniform_rotation_stiffness,
};
use grainlab_micromechanics::probe::{StrainProbe, strain_probe};
use grainlab_node_kit::Exit;

/// Residual of the direct solve: the factorisation alone almost reaches it.
const DIRECT: f64 = 1e-12;

/// A stiffness, Pa, and the number of iterations or steps.
type Found = Result<(Stiffness, Option<u32>), String>;

/// Rows of the packing, in the order of increasing time.
pub(super) fn rows(packing: &Packing, replicated: bool, args: &Args) -> Result<Vec<Row>, Failure> {
    say!("grainlab: {} grains, {} contacts", packing.grains(), packing.contacts.len());
    let springs = if args.frictionless { Springs::Normal } else { Springs::NormalAndTangential };
    let view = PackingView::new(packing).map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
    let bench = Bench { view, springs };
    let direct = packing.grains() as u64 <= args.direct_up_to;
    let (converged, against) = bench.converged(direct)?;
    let coordination = 2.0 * packing.contacts.len() as f64 / packing.grains() as f64;
    let row = |method, value, (seconds, found): (f64, Found)| {
        let error = |found: &Stiffness| (found.0 - converged.0).amax() / converged.0[(0, 0)];
        let (found, failure) = found.map_or_else(|why| (None, Some(why)), |found| (Some(found), None));
        Row {
            method,
            value,
            grains: packing.grains(),
            replicated,
            coordination,
            seconds,
            iterations: found.as_ref().and_then(|f| f.1),
            error: Error { stiffness: found.map(|f| error(&f.0)), against },
            failure,
        }
    };
    let many = args.repetitions;
    let mut rows = vec![row(Method::Affine, None, timed(many, || bench.affine())?)];
    rows.push(row(Method::MeanSpin, None, timed(many, || bench.mean_spin())?));
    for tolerance in &args.tolerances {
        let solve = || bench.solved(Solver::Iterative, *tolerance);
        rows.push(row(Method::Cg, Some(*tolerance), timed(many, solve)?));
    }
    if direct {
        let solve = || bench.solved(Solver::Direct, DIRECT);
        rows.push(row(Method::Direct, Some(DIRECT), timed(many, solve)?));
    }
    if packing.grains() as u64 <= args.probe_up_to {
        for amplitude in args.amplitudes() {
            rows.push(row(Method::Probe, Some(amplitude), timed(1, || bench.probed(amplitude))?));
        }
    }
    Ok(rows)
}

struct Bench<'a> {
    view: PackingView<'a>,
    springs: Springs,
}

impl Bench<'_> {
    fn network(&self) -> Result<SpringNetwork, String> {
        SpringNetwork::new(&self.view, self.springs).map_err(|e| e.to_string())
    }

    fn affine(&self) -> Found {
        Ok((self.network()?.affine_stiffness(), None))
    }

    fn mean_spin(&self) -> Found {
        let network = self.network()?;
        Ok((uniform_rotation_stiffness(&network, &network.affine_stiffness()), None))
    }

    fn solved(&self, solver: Solver, tolerance: f64) -> Found {
        let most = grainlab_micromechanics::Settings::default().max_iterations;
        let network = self.network()?;
        let found = relaxed_stiffness(&network, solver, tolerance, most).map_err(|e| e.to_string())?;
        let found = found.ok_or_else(|| NotJammed::Floppy { contacts: network.contacts() }.to_string())?;
        Ok((found.relaxed, Some(found.iterations)))
    }

    /// The reference for errors, with its name: near isostaticity only the factorisation converges that far.
    fn converged(&self, direct: bool) -> Result<(Stiffness, &'static str), Failure> {
        let by = |solver, name| self.solved(solver, CONVERGED).map(|found| (found.0, name));
        let iterated = by(Solver::Iterative, "frozen network by cg at 1e-13");
        let found = if direct {
            iterated.or_else(|_| by(Solver::Direct, "frozen network directly at 1e-13"))
        } else {
            iterated
        };
        found.map_err(|why| Failure::new(Exit::PhysicsInvalid, why))
    }

    fn probed(&self, amplitude: f64) -> Found {
        let friction = Some(if self.springs == Springs::Normal { 0.0 } else { f64::INFINITY });
        let settings = StrainProbe { amplitude, friction, ..StrainProbe::default() };
        let found = strain_probe(self.view.packing, &settings).map_err(|e| e.to_string())?;
        Ok((found.stiffness, Some(found.steps())))
    }
}

/// Median CPU time of several repetitions, s, and the result.
fn timed(repetitions: u32, work: impl Fn() -> Found) -> Result<(f64, Found), Failure> {
    let mut times = Vec::new();
    loop {
        let begin = thread_seconds()?;
        let result = work();
        times.push(thread_seconds()? - begin);
        if times.len() as u32 >= repetitions || result.is_err() {
            return Ok((median(times), result));
        }
    }
}
