//! Flags for data that files lack.

use grainlab_console::Failure;
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Mat3, Vec3};
use grainlab_msgs::topics;
use grainlab_recordings::import::{Frames, ImportOptions};
use std::path::PathBuf;

pub(crate) const FORMATS: &str = "\
A file that cannot be read is reported and the others are measured; the exit code is the worst of all files. Ctrl-C prints
the finished results and ends with 130. Formats are recognised by content: a recording, CSV (p,id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz and
c,i,j,nx,ny,nz,delta,fn,ftx,fty,ftz; NAME.json beside NAME.csv has cell and material), LAMMPS dump or data file
(atom_style sphere), extended XYZ (pos, radius), YADE export.text or textExt (x_y_z_r, x_y_z_r_matId, id_x_y_z_r_matId, x_y_z_r_attrs; the cell from a
comment: textExt(..., comment='cell ' + str(O.cell.hSize)), or from --cell). If a file lists no contacts, they are found
from positions, with the normal forces of their law and without tangential ones. A flag replaces what a file says, which is noted. The contact forces of a LAMMPS dump or data file need these lines,
all of them with friction (fx fy fz of granular pair styles is only the normal force):
  compute pl all property/local patom1 patom2
  compute pf all pair/local dist fx fy fz p1 p2 p3
  dump forces all local 1 forces.dump c_pl[*] c_pf[*]
  dump_modify forces format float %.17g
Columns are found by these names, by those of dump_modify colname (patom1 patom2 fx fy fz p1 p2 p3), or by
--contact-columns.";

/// A flag replaces what a file or its sidecar says, which is noted.
#[derive(Debug, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Args {
    /// Shear modulus of the grains, Pa
    #[arg(long, value_name = "PA")]
    shear_modulus: Option<f64>,
    /// Poisson ratio of the grains
    #[arg(long, value_name = "NU")]
    poisson: Option<f64>,
    /// Density of the grains, kg/m3
    #[arg(long, value_name = "KG_PER_M3")]
    density: Option<f64>,
    /// Friction coefficient; inf is allowed
    #[arg(long, value_name = "MU")]
    friction: Option<f64>,
    /// Contact law with its parameters: hertz_mindlin, linear:KN,RATIO with k_n in N/m and k_t/k_n, or rough:SQ,FACTOR with the
    /// roughness S_q in m and k_t/k_n over that of Mindlin; with resistance to rolling also KR,CR,MUR (hertz_mindlin:KR,CR,MUR):
    /// rolling stiffness in N/m, damping in N s/m, friction
    #[arg(long, value_name = "LAW")]
    contact_law: Option<ContactLaw>,
    /// Radius of every grain, m
    #[arg(long, value_name = "M")]
    radius: Option<f64>,
    /// Periodic cell, m: three edge lengths, or nine numbers row by row with the edge vectors as columns
    #[arg(long, value_name = "LX,LY,LZ", value_delimiter = ',')]
    cell: Vec<f64>,
    /// Topic of the packings of recordings
    #[arg(long, value_name = "NAME", default_value = "packing")]
    pub(crate) topic: String,
    /// LAMMPS `dump local` with the contact forces of a data file or a dump at the same steps, also as .gz, of normal and
    /// tangential force (see `grainlab analyze --help`)
    #[arg(long, value_name = "FILE")]
    contact_forces: Option<PathBuf>,
    /// Columns of the contact forces, if they differ: ids, normal force, tangential force (or ids and the whole force)
    #[arg(long, value_name = "ID,ID,FX,FY,FZ,P1,P2,P3", value_delimiter = ',', requires = "contact_forces")]
    contact_columns: Vec<String>,
}

impl Args {
    /// Refuses a topic where no file is a recording, which has topics.
    pub(crate) fn topic_has_use(&self, files: &[PathBuf]) -> Result<(), Failure> {
        let is_recording = |file: &PathBuf| file.is_dir() || file.to_string_lossy().contains(".mcap");
        if self.topic == topics::PACKING.name || files.iter().any(is_recording) {
            return Ok(());
        }
        Err(Failure::usage(format!("--topic {} is for recordings, and no file is one", self.topic)))
    }

    pub(crate) fn options(&self) -> Result<ImportOptions, Failure> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        in_range("shear-modulus", self.shear_modulus, "a modulus in Pa, more than 0", positive)?;
        in_range("poisson", self.poisson, "from 0 to 0.5", |v| (0.0..=0.5).contains(&v))?;
        in_range("density", self.density, "a density in kg/m3, more than 0", positive)?;
        in_range("friction", self.friction, "0 or more", |v| v >= 0.0)?;
        in_range("radius", self.radius, "a length in m, more than 0", positive)?;
        let cell = match self.cell.as_slice() {
            [] => None,
            [x, y, z] => Some(Mat3::from_diagonal(&Vec3::new(*x, *y, *z))),
            nine if nine.len() == 9 => Some(Mat3::from_row_slice(nine)),
            other => {
                return Err(Failure::usage(format!("--cell has {} numbers; it takes 3 or 9", other.len())));
            }
        };
        let contact_forces = match &self.contact_forces {
            Some(path) => {
                let text = grainlab_recordings::import::text(path);
                Some(text.map_err(|e| Failure::failed(e.to_string()))?)
            }
            None => None,
        };
        Ok(ImportOptions {
            cell,
            shear_modulus: self.shear_modulus,
            poisson_ratio: self.poisson,
            density: self.density,
            friction: self.friction,
            law: self.contact_law,
            default_law: None,
            radius: self.radius,
            // The default name means the packings of the recording, whatever their topic is called.
            topic: Some(self.topic.clone())
                .filter(|topic| !topic.is_empty() && topic != topics::PACKING.name),
            contact_forces,
            contact_columns: self.contact_columns.clone(),
            frames: Frames::All,
        })
    }
}

/// Refuses a flag whose value is out of range, by its name.
pub(crate) fn in_range(
    flag: &str,
    value: Option<f64>,
    requirement: &str,
    accept: fn(f64) -> bool,
) -> Result<(), Failure> {
    match value.filter(|v| !accept(*v)) {
        Some(v) => Err(Failure::usage(format!("--{flag} {v} is out of range: {requirement}"))),
        None => Ok(()),
    }
}
