//! One run of LAMMPS as an engine.

use crate::coulomb::Coulomb;
use crate::exchange::{Exchange, FIRST_STEP, HOLD, OBSERVED};
use crate::files::{CONTACT_COLUMNS, Dumps, GRAIN_COLUMNS, data_file};
use crate::folder::Folder;
use crate::frame::{Affine, Frame};
use crate::law::{MOST_FRICTION, check_law, check_settings, pair_coeff};
use crate::program::Program;
use crate::refusal::refused;
use crate::survey::{Load, Survey};
use grainlab_core::EngineProgram;
use grainlab_core::stress::Stress;
use grainlab_core::{Cell, Mat3, Packing, SymTensor, Vec3, min_contacts};
use grainlab_engine::{EngineError, EngineSettings, Observables, ParticleEngine};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The state of an engine beside a packing and its restart file.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Saved {
    version: u32,
    spin: [f64; 3],
    stress: [f64; 6],
    asymmetry: f64,
    unbalanced: f64,
    speed: f64,
    tangent: Option<[f64; 6]>,
    survey: Survey,
}

/// Version of a saved state. From 2 on its restart file has the forces of the last step.
const VERSION: u32 = 2;

/// The commands that read a restart file. A style that is named again evaluates the reach of its forces anew.
fn read_restart(path: &Path) -> String {
    format!("read_restart \"{}\"\npair_style granular\n{HOLD}", path.display())
}

/// A running LAMMPS and the state that it is in. Between two exchanges its velocities are those relative to the affine motion.
#[derive(Debug)]
pub(crate) struct Running {
    link: Mutex<Link>,
    about: EngineProgram,
    folder: Folder,
    settings: EngineSettings,
    rate: [f64; 6],
    /// The grains, with cell, step, time and time step as they are now; positions, velocities and contacts of the start.
    known: Packing,
    frame: Frame,
    /// Angular velocity of the affine motion that spins contain, 1/s.
    spin: Vec3,
    /// The friction of the last steps: a phase that ends is recorded after the next one has begun.
    coulomb: Coulomb,
    survey: Survey,
    seen: Observables,
    kept: Mutex<Kept>,
}

/// Readings of the present state: reading it again has other rounding errors.
#[derive(Debug, Default)]
struct Kept {
    packing: Option<Packing>,
    own_state: Option<Vec<u8>>,
}

/// The program, which reading a state moves, too.
#[derive(Debug)]
struct Link {
    program: Program,
    /// Number of the present step in LAMMPS.
    at: u64,
}

impl Running {
    /// The program started by a command, with a time limit of its answers, with the grains of a packing.
    pub(crate) fn begun(
        with: (&str, Duration),
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
    ) -> Result<Self, EngineError> {
        let mut engine = Self::new(with, packing, settings, rate)?;
        // The step of a gas is a mean free time.
        engine.known.time_step = engine.known.time_step.min(engine.survey.time_step);
        engine.load(packing)?;
        Ok(engine)
    }

    pub(crate) fn resumed(
        with: (&str, Duration),
        packing: &Packing,
        own_state: &[u8],
        settings: &EngineSettings,
        rate: &[f64; 6],
    ) -> Result<Self, EngineError> {
        let mut engine = Self::new(with, packing, settings, rate)?;
        engine.read_restart(own_state)?;
        Ok(engine)
    }

    /// The program without grains.
    fn new(
        (command, limit): (&str, Duration),
        packing: &Packing,
        settings: &EngineSettings,
        rate: &[f64; 6],
    ) -> Result<Self, EngineError> {
        check_law(&packing.law)?;
        check_settings(settings)?;
        let (survey, seen) = Survey::of(packing, settings)?;
        let time_step = if packing.time_step > 0.0 { packing.time_step } else { survey.time_step };
        let folder = Folder::new()?;
        let (program, about) = Program::start(command, limit, &folder)?;
        log::info!("the engine is {about}");
        Ok(Self {
            link: Mutex::new(Link { program, at: FIRST_STEP }),
            about,
            folder,
            settings: *settings,
            rate: *rate,
            known: Packing { time_step, friction: settings.friction, ..packing.clone() },
            frame: Frame::of(&packing.cell),
            spin: Vec3::zeros(),
            coulomb: Coulomb::of_steps(settings, &Mat3::zeros()),
            survey,
            seen,
            kept: Mutex::default(),
        })
    }

    fn link(&self) -> MutexGuard<'_, Link> {
        self.link.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read_packing(&self) -> Result<Packing, EngineError> {
        let (grains, contacts) = (self.folder.file("grains.dump"), self.folder.file("contacts.dump"));
        let mut link = self.link();
        let observe = Exchange::observe(&Mat3::zeros(), self.known.time_step, link.at);
        let (elastic, own) = self.laws()?;
        let commands = format!(
            "{observe}pair_coeff * * {elastic}\nrun 0 post no\nwrite_dump all custom \"{}\" {GRAIN_COLUMNS} modify format float %.17g\n\
             write_dump all local \"{}\" {CONTACT_COLUMNS} modify format float %.17g\npair_coeff * * {own}\n",
            grains.display(),
            contacts.display()
        );
        link.program.tell(&commands)?;
        link.program.ask([])?;
        let (frame, spin, coulomb) = (self.frame, self.spin, self.coulomb);
        let dumps = Dumps { grains: &grains, contacts: &contacts, frame, spin, coulomb };
        dumps.read(&self.known)
    }

    /// Loads the grains of a packing, with empty springs.
    fn load(&mut self, packing: &Packing) -> Result<(), EngineError> {
        self.frame = self.checked_frame(&packing.cell)?;
        self.spin = Vec3::zeros();
        let path = self.folder.write("start.data", data_file(packing, &self.frame).as_bytes())?;
        let read = format!("atom_style sphere\nread_data \"{}\"\npair_style granular\n", path.display());
        self.set_up(&read)?;
        // Velocities half a step before the positions become those at the positions.
        let (half, frictional) = (0.5 * self.known.time_step, self.settings.friction > 0.0);
        let mut commands = "run 0 post no\n".to_owned();
        for axis in ["x", "y", "z"] {
            commands += &format!("variable v{axis} atom v{axis}+f{axis}*({half:e})/mass\n");
        }
        commands += "velocity all set v_vx v_vy v_vz units box\n";
        if frictional {
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let torque = format!("c_spins[{}]*({half:e})/(0.4*mass*radius^2)", k + 4);
                commands += &format!("variable w{axis} atom c_spins[{}]+{torque}\n", k + 1);
            }
            commands += "set group all omega v_wx v_wy v_wz\n";
        }
        self.link().program.tell(&commands)?;
        self.observe()?;
        self.link().program.tell(&format!("run 0 post no\n{HOLD}"))
    }

    fn read_restart(&mut self, own_state: &[u8]) -> Result<(), EngineError> {
        let at = own_state.iter().position(|b| *b == b'\n').unwrap_or(own_state.len());
        let saved =
            serde_json::from_slice::<Saved>(&own_state[..at]).ok().filter(|saved| saved.version == VERSION);
        let Some(saved) = saved else {
            return refused("the saved state is damaged, or of another version");
        };
        let path = self.folder.write("present.restart", own_state.get(at + 1..).unwrap_or_default())?;
        self.spin = saved.spin.into();
        let expected = self.seen;
        self.set_up(&read_restart(&path))?;
        let [found, wanted] = [&self.seen, &expected].map(|seen| (seen.contacts, seen.stress.tensor.mean()));
        if found.0 != wanted.0 || (found.1 - wanted.1).abs() > 1e-6 * wanted.1.abs() {
            return refused(format!(
                "the restart file is not of this packing: {} contacts and a pressure of {:e} Pa, {} and {:e} expected",
                found.0, found.1, wanted.0, wanted.1
            ));
        }
        // To the last digit, so that requests are repeated with the same bytes.
        self.seen = Observables {
            stress: Stress { tensor: SymTensor::from_voigt(saved.stress), asymmetry: saved.asymmetry },
            unbalanced: saved.unbalanced,
            speed: saved.speed,
            tangent: saved.tangent,
            ..self.seen
        };
        self.survey = saved.survey;
        Ok(())
    }

    /// Begins anew with the grains that the commands `read` have, and evaluates forces.
    fn set_up(&mut self, read: &str) -> Result<(), EngineError> {
        let commands = self.commands(read)?;
        let mut link = self.link();
        link.at = FIRST_STEP;
        link.program.tell(&commands)?;
        drop(link);
        self.observe()
    }

    /// The commands from the first to the computes, with the grains that the commands `read` have.
    fn commands(&self, read: &str) -> Result<String, EngineError> {
        let law = pair_coeff(&self.known.material, &self.settings)?;
        let frictional = self.settings.friction > 0.0;
        let (integrator, spins) = if frictional {
            ("nve/sphere", "compute spins all property/atom omegax omegay omegaz tqx tqy tqz\n")
        } else {
            ("nve", "")
        };
        Ok(format!(
            "clear\nunits si\nnewton on\n{read}reset_timestep {FIRST_STEP}\ncomm_modify vel yes\npair_coeff * * {law}\nneighbor {:e} bin\n\
             neigh_modify delay 0 every 1 check yes\ntimestep {:e}\nfix move all {integrator}\n{spins}{}",
            self.settings.skin,
            self.known.time_step,
            Exchange::computes(min_contacts(self.settings.friction), frictional),
        ))
    }

    fn checked_frame(&self, cell: &Cell) -> Result<Frame, EngineError> {
        let frame = Frame::of(cell);
        if frame.tilt() > 0.5 {
            return refused(format!(
                "the cell is tilted by {:.2} of an edge; LAMMPS has cells up to 0.5: end the shear before that",
                frame.tilt()
            ));
        }
        Ok(frame)
    }

    /// Evaluates forces at the present state, and observes it.
    fn observe(&mut self) -> Result<(), EngineError> {
        let (elastic, own) = self.laws()?;
        let mut link = self.link();
        let observe = Exchange::observe(&Mat3::zeros(), self.known.time_step, link.at);
        link.program.tell(&format!("{observe}pair_coeff * * {elastic}\nrun 0 post no\n"))?;
        drop(link);
        self.take_observables(&format!("pair_coeff * * {own}\n"))
    }

    /// The law for a look at a state, and that of the run. LAMMPS cuts tangential springs at the Coulomb limit also where no step
    /// is made, by the velocities of that moment. Without a limit and dashpots a look changes nothing, and finds elastic forces.
    fn laws(&self) -> Result<(String, String), EngineError> {
        let friction = if self.settings.friction > 0.0 { MOST_FRICTION } else { 0.0 };
        let elastic = EngineSettings { damping: 0.0, friction, ..self.settings };
        let law = |settings| pair_coeff(&self.known.material, settings);
        Ok((law(&elastic)?, law(&self.settings)?))
    }

    /// Reads what was observed at the last step, and sends the commands after it.
    fn take_observables(&mut self, after: &str) -> Result<(), EngineError> {
        let names: [String; OBSERVED] = std::array::from_fn(|k| format!("f_seen[{}]", k + 1));
        let mut link = self.link();
        let values = link.program.ask(names.each_ref().map(String::as_str))?;
        link.program.tell(after)?;
        drop(link);
        let [xx, yy, zz, xy, xz, yz, touching, net, backbone, ux, uy, uz, vx, vy, vz, tx, ty, tz] = values;
        let torque = Vec3::new(tx, ty, tz);
        let (n, dt) = (self.known.grains() as f64, self.known.time_step);
        let smallest = self.known.radii.iter().fold(f64::INFINITY, |a, r| a.min(*r));
        let (squares, speed) = (ux + uy + uz, vx.max(vy).max(vz));
        if !(values.iter().all(|v| v.is_finite()) && speed <= 0.1 * smallest / dt) {
            return refused(format!(
                "unstable at step {}: a grain moves at {speed:e} m/s, more than a tenth of its radius in one step of {dt:e} s; lower \
                 the time step (in a scene: numerics.time_step_safety) or the strain rates",
                self.known.step
            ));
        }
        let contacts = 0.5 * touching;
        let load = Load { contacts, virial: (xx + yy + zz) * self.known.cell.volume() };
        // LAMMPS sums r_x F_y, but not r_y F_x: their difference is the sum of torques.
        let turned = torque / self.known.cell.volume();
        let in_lammps = Mat3::new(xx, xy, xz, xy + turned.z, yy, yz, xz - turned.y, yz + turned.x, zz);
        let unbalanced = net / backbone / self.survey.mean_force(&load);
        self.seen = Observables {
            stress: Stress { tensor: self.frame.tensor(&in_lammps), asymmetry: turned.amax() },
            cell: self.known.cell,
            unbalanced: if unbalanced.is_finite() { unbalanced } else { 1.0 },
            speed: (squares / n).sqrt(),
            contacts: contacts.round() as u32,
            tangent: Some(self.survey.tangent(&load)),
            solid_fraction: Some(self.known.solid_fraction()),
        };
        if self.survey.is_stale(self.known.step, &load) {
            self.survey()?;
        }
        Ok(())
    }

    /// Chooses the time step anew from the present contacts.
    fn survey(&mut self) -> Result<(), EngineError> {
        let (survey, seen) = Survey::of(&self.read_packing()?, &self.settings)?;
        self.survey = survey;
        self.known.time_step = survey.time_step;
        self.seen.tangent = seen.tangent;
        self.link().program.tell(&format!("timestep {:e}\n", survey.time_step))
    }
}

impl ParticleEngine for Running {
    fn settings(&self) -> &EngineSettings {
        &self.settings
    }

    fn begin_phase(&mut self, settings: &EngineSettings) -> Result<(), EngineError> {
        check_settings(settings)?;
        let law = pair_coeff(&self.known.material, settings)?;
        let was_frictional = self.settings.friction > 0.0;
        let packing = self.read_packing()?;
        *self.kept() = Kept::default();
        (self.settings, self.known.friction) = (*settings, settings.friction);
        if was_frictional != (settings.friction > 0.0) {
            // The springs of the new law begin without a force.
            let mut packing = Packing { friction: settings.friction, ..packing };
            packing.spins.fill(Vec3::zeros());
            packing.contacts.iter_mut().for_each(|c| c.tangential_force = Vec3::zeros());
            self.load(&packing)?;
        } else {
            let commands = format!("pair_coeff * * {law}\nneighbor {:e} bin\n", settings.skin);
            self.link().program.tell(&commands)?;
        }
        self.survey()?;
        self.observe()?;
        self.link().program.tell(&format!("run 0 post no\nunfix held\n{HOLD}"))
    }

    fn set_rate(&mut self, rate: &[f64; 6]) -> Result<(), EngineError> {
        if let Some(c) = rate.iter().position(|r| !r.is_finite()) {
            let component = SymTensor::COMPONENTS[c];
            return Err(EngineError::Rate { component, value: rate[c] });
        }
        self.rate = *rate;
        Ok(())
    }

    fn rate(&self) -> [f64; 6] {
        self.rate
    }

    fn run(&mut self, steps: u32) -> Result<(Mat3, Observables), EngineError> {
        *self.kept() = Kept::default();
        let rate = SymTensor::from_voigt(self.rate).matrix();
        self.coulomb = Coulomb::of_steps(&self.settings, &rate);
        let mut total = Mat3::identity();
        let mut left = steps;
        while left > 0 {
            let count = left.min(Exchange::longest(&self.settings, self.known.time_step));
            let dt = self.known.time_step;
            let step = Mat3::identity() + rate * dt;
            let deformation = step.pow(count);
            let Some(cell) = self.known.cell.deformed(&deformation) else {
                return Err(EngineError::Cell { step: self.known.step });
            };
            let frame = self.checked_frame(&cell)?;
            let time = f64::from(count) * dt;
            let affine = Affine::between(&self.frame.edges, &frame.edges, time);
            let mut link = self.link();
            let exchange = Exchange {
                steps: count,
                dt,
                affine,
                settings: &self.settings,
                spin: self.spin,
                from: &self.frame,
                to: &frame,
                at: link.at,
            };
            let (commands, after, spin) = exchange.commands();
            link.program.tell(&commands)?;
            link.at += u64::from(count);
            drop(link);
            (self.known.cell, self.frame, self.spin) = (cell, frame, spin);
            self.known.step += u64::from(count);
            self.known.time += time;
            self.take_observables(&after)?;
            total = deformation * total;
            left -= count;
        }
        Ok((total, self.seen))
    }

    fn steps(&self) -> u64 {
        self.known.step
    }

    fn time(&self) -> f64 {
        self.known.time
    }

    fn time_step(&self) -> f64 {
        self.known.time_step
    }

    fn observables(&self) -> Result<Observables, EngineError> {
        Ok(self.seen)
    }

    fn packing(&self, deformation: Mat3) -> Result<Packing, EngineError> {
        let mut kept = self.kept();
        let packing = match kept.packing.take() {
            Some(packing) => packing,
            None => self.read_packing()?,
        };
        Ok(Packing { deformation, ..kept.packing.insert(packing).clone() })
    }

    fn program(&self) -> Option<&EngineProgram> {
        Some(&self.about)
    }

    fn own_state(&self) -> Result<Vec<u8>, EngineError> {
        if let Some(bytes) = &self.kept().own_state {
            return Ok(bytes.clone());
        }
        let path = self.folder.file("present.restart");
        let mut link = self.link();
        // LAMMPS goes on from the file, too: a run that is resumed from it then has the same rounding errors.
        let (again, (elastic, own)) = (self.commands(&read_restart(&path))?, self.laws()?);
        let observe = Exchange::observe(&Mat3::zeros(), self.known.time_step, FIRST_STEP);
        link.program.tell(&format!(
            "write_restart \"{}\"\n{again}{observe}pair_coeff * * {elastic}\nrun 0 post no\npair_coeff * * {own}\n",
            path.display()
        ))?;
        link.program.ask([])?;
        link.at = FIRST_STEP;
        let restart = std::fs::read(&path).or_else(|e| refused(format!("{}: {e}", path.display())))?;
        let seen = &self.seen;
        let saved = Saved {
            version: VERSION,
            spin: self.spin.into(),
            stress: seen.stress.tensor.voigt(),
            asymmetry: seen.stress.asymmetry,
            unbalanced: seen.unbalanced,
            speed: seen.speed,
            tangent: seen.tangent,
            survey: self.survey,
        };
        let mut bytes = serde_json::to_vec(&saved).unwrap_or_default();
        bytes.push(b'\n');
        bytes.extend(restart);
        self.kept().own_state = Some(bytes.clone());
        Ok(bytes)
    }

    fn left_out(&self) -> String {
        let frictional = self.settings.friction > 0.0;
        let law =
            if frictional { "with the whole contact law" } else { "without spins and tangential springs" };
        let cores = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
        let crowded = if self.about.ranks as usize > cores {
            format!(" (more than the {cores} cores of this machine: very slow if all are here)")
        } else {
            String::new()
        };
        format!("{law}, by {}{crowded}", self.about)
    }
}
