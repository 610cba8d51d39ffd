//! Every key of the format. The parser uses this table, and the reference is written from it.

use crate::key::{DefaultValue, Domain, Interval, Key};
use DefaultValue::{Required, Words};
use grainlab_core::Material;
use grainlab_core::contact::{LawParameter, RollingResistance, SpringLaw};
use std::ops::Bound::{Excluded, Included};
use std::sync::LazyLock;

/// Declares a constant for each key, and `FIXED` with all of them in this order.
macro_rules! keys {
    ($($id:ident = $key:expr;)*) => {
        $(pub(crate) static $id: Key = $key;)*
        static FIXED: &[&Key] = &[$(&$id),*];
    };
}

const GLASS: Material = Material::GLASS;

/// The kinds of entries of a path, and their titles in the reference.
pub(crate) const KINDS: [(&str, &str); 5] = [
    (
        "gas",
        "`kind = \"gas\"`: grains placed at random and agitated, compressed isotropically; the first phase, and no other",
    ),
    ("strain", "`kind = \"strain\"`: an imposed strain rate"),
    ("servo", "`kind = \"servo\"`: on each component a stress target, a strain rate, or nothing"),
    ("cycle", "`kind = \"cycle\"`: phases to repeat"),
    ("relax", "`kind = \"relax\"`: a fixed cell; it has no other keys"),
];

/// Largest number of grains of a run. A million take 6.5 GB of memory through the whole laboratory.
pub const MOST_GRAINS: u64 = 10_000_000;

const GAS: &[&str] = &["gas"];
const STRAIN: &[&str] = &["strain"];
const SERVO: &[&str] = &["servo"];
const CYCLE: &[&str] = &["cycle"];
const STEPS: &[&str] = &["gas", "relax", "strain", "servo"];

const SIX: Domain = Domain::Form("six numbers in 1/s, order xx, yy, zz, yz, xz, xy");
const BY_COMPONENT: Domain = Domain::Form("a table of xx, yy, zz, yz, xz, xy, each a finite number");
const NONE: DefaultValue = Words("no condition");

keys! {
    BASE = text("base", Words("none"), "scene that this one changes: a built-in one by name, or a file by its path from this file");
    REMOVE = form("remove", "names of phases of the base, as in [\"unload\", \"reload\"]", Words("none"), "phases of the base to leave out; only with base");
    APPEND = form("append", "tables like those of phase, with or without after = \"NAME\"", Words("none"), "phases to add behind the last one of the base, or behind the one named by after; only with base");
    NAME = text("name", Required, "name, also of the runs; lower case letters, digits, _ and -");
    DESCRIPTION = text("description", DefaultValue::Text(""), "description in one line");
    SEED = whole("seed", 0, u64::MAX >> 1, DefaultValue::Whole(1), "seed of every random choice");
    FRICTION = number("friction", "", Interval::FROM_ZERO_TO_INFINITY, Words("none"), "friction coefficient of every phase that does not set it, except a gas");
    PRESSURE = number("pressure", "Pa", Interval::POSITIVE, Words("none"), "stress at which the path is held: target of every normal component that has one, all equal before; bounds of until that equal them follow, others above 1 % are refused");

    START = form("start", "a table with the packing to start from", Words("none: the path begins with a gas"), "[start]: a packing to start from");
    START_PACKING = text("start.packing", Required, "file with the packing, by its path from this file: a recording, CSV, LAMMPS or YADE; excludes [grains] and a gas");
    START_CONTACT_FORCES = text("start.contact_forces", Words("those in the file of the packing"), "LAMMPS `dump local` with the contact forces of the packing, a dump with one step, by its path from this file");
    START_CONTACT_COLUMNS = form("start.contact_columns", "an array of five or eight names, as [\"patom1\", \"patom2\", \"fx\", \"fy\", \"fz\", \"p1\", \"p2\", \"p3\"]", Words("found by their names"), "columns of contact_forces: ids, normal force, tangential force; or ids and the whole force");
    START_COPIES = whole("start.copies", 1, 100, DefaultValue::Whole(1), "copies of the packing along each edge of its cell: the run has the cube of it times the grains, at most 10000000");
    START_STEP = whole("start.step", 0, u64::MAX >> 1, Words("the last one"), "solver step of the packing in a recording or a dump");

    GRAINS = form("grains", "a table with count and diameter", Words("required, but with start"), "[grains]: number and sizes");
    GRAIN_COUNT = whole("grains.count", 1, MOST_GRAINS, Words("required, but with counts in diameter"), "number of grains");
    DIAMETER = Key { unit: "m", ..form("grains.diameter", "a length above 0, { min, max }, { median, spread } or [{ diameter, share }, ...] or [{ diameter, count }, ...]", Required, "of every grain, or a law: uniform, lognormal (spread: standard deviation of the logarithm, cut at 3), or several sizes") };

    SHEAR_MODULUS = number("material.shear_modulus", "Pa", Interval::POSITIVE, DefaultValue::Number(GLASS.shear_modulus), "shear modulus of the grains");
    POISSON_RATIO = number("material.poisson_ratio", "", Interval::from_to(0.0, 0.5), DefaultValue::Number(GLASS.poisson_ratio), "Poisson ratio of the grains");
    DENSITY = number("material.density", "kg/m3", Interval::POSITIVE, DefaultValue::Number(GLASS.density), "density of the grains");

    CONTACT_LAW = choice("contact.law", &SpringLaw::NAMES, "hertz_mindlin", "spring law of the contacts: that of Hertz and Mindlin follows from the material, others have keys of their own");

    TIME_STEP_SAFETY = number("numerics.time_step_safety", "", OVER_ZERO_TO_ONE, DefaultValue::Number(0.8), "time step over its stability bound");
    SKIN = number("numerics.skin", "", OVER_ZERO_TO_ONE, DefaultValue::Number(0.05), "Verlet skin over grain diameter");
    ENERGY_BALANCE = flag("numerics.energy_balance", "whether the energy balance of each phase is summed, which makes steps several times slower");
    TANGENTIAL = choice("numerics.tangential", &["rescaled", "incremental"], "rescaled", "tangential force on unloading: scaled down with the tangential stiffness, so that no closed cycle creates energy, or kept, as in LAMMPS's mindlin/force");

    PHASE = form("phase", "an array of tables, one per phase", Required, "phases of the path, in order: [[phase]]; over a base, [phase.NAME] changes the phase of that name");
    KIND = Key { kinds: &[], ..form("phase.kind", "\"gas\", \"relax\", \"strain\", \"servo\" or \"cycle\"", Required, "what drives the cell: grains placed at random and compressed, a fixed cell, an imposed strain rate, stress targets, or phases to repeat") };
    PHASE_NAME = text("phase.name", Words("its kind"), "name of the phase; in a cycle it carries its round, as in unload#2");
    PHASE_FRICTION = Key { kinds: STEPS, ..number("phase.friction", "", Interval::FROM_ZERO_TO_INFINITY, Words("friction of the scene; 0 for a gas"), "friction coefficient; 0 switches spins and tangential springs off, inf the Coulomb check") };
    DAMPING = Key { kinds: STEPS, ..number("phase.damping", "", Interval::from_to(0.0, 1.0), Words("0.3; 0.002 for a soft gas, 0 for an event-driven one"), "contact damping, share of critical") };
    DRAG = Key { kinds: STEPS, ..number("phase.drag", "1/s", Interval::FROM_ZERO, DefaultValue::Number(0.0), "drag on velocities relative to the affine motion") };
    SPIN_DRAG = Key { kinds: STEPS, ..number("phase.spin_drag", "1/s", Interval::FROM_ZERO, Words("sqrt(G/density)/(1000 diameter) for relax and servo, else 0"), "drag on spins; no contact resists the spin of a grain that two contacts hold") };
    CONTROL_PERIOD = Key { kinds: STEPS, ..whole("phase.control_period", 1, 100_000, Words("10; 20 for an event-driven gas, 200 for a soft one"), "solver steps between two exchanges with the servo; a step of an event-driven gas is a mean free time") };
    REFERENCE = Key { kinds: STEPS, ..flag("phase.reference", "whether the state at the end is the reference of strains from then on; before, they count from the first step of the run") };
    PUBLISH = Key { kinds: STEPS, ..flag("phase.publish", "whether the packing at the end is published") };

    RECORD = Key { kinds: STEPS, ..form("phase.record", "a table with one of every_steps, every_strain and every_time", Words("none"), "how often a packing within the phase is published; publish = true adds the one that ends it; the run is the same with and without") };
    EVERY_STEPS = Key { kinds: STEPS, ..whole("phase.record.every_steps", 1, 1_000_000_000_000, Words("none"), "at the first exchange after each multiple of this number of solver steps of the run") };
    EVERY_STRAIN = Key { kinds: STEPS, ..number("phase.record.every_strain", "", Interval::POSITIVE, Words("none"), "at the first exchange after each multiple of this strain: the largest component of the rate, without sign, over the time of the phase") };
    EVERY_TIME = Key { kinds: STEPS, ..number("phase.record.every_time", "s", Interval::POSITIVE, Words("none"), "at the first exchange after each multiple of this simulated time in the phase") };

    METHOD = Key { kinds: GAS, ..choice("phase.method", &["event_driven", "soft"], "event_driven", "how the grains collide: as hard, elastic, frictionless spheres, or by the contact law") };
    INITIAL_SOLID_FRACTION = Key { kinds: GAS, ..number("phase.initial_solid_fraction", "", Interval::from_to(0.001, 0.35), DefaultValue::Number(0.3), "solid fraction at which the grains are placed") };
    SPEED = Key { kinds: GAS, ..number("phase.speed", "m/s", Interval::POSITIVE, DefaultValue::Number(1.0), "root mean square speed of the grains, an upper bound during the phase") };
    GAS_RATE = Key { kinds: GAS, ..number("phase.rate", "1/s", Interval::NEGATIVE, Required, "strain rate of each axis, negative in compression") };

    STRAIN_RATE = Key { kinds: STRAIN, unit: "1/s", domain: SIX, ..form("phase.rate", "", Required, "strain rate, tensor components, positive in extension") };

    CONTROL = Key { kinds: SERVO, ..form("phase.control", "a table of xx, yy, zz, yz, xz, xy, each { stress = Pa }, { rate = 1/s } or \"held\"", Required, "what is imposed on each component, held if not set; an override replaces the value of a component whole") };
    RATE_LIMIT = Key { kinds: SERVO, ..number("phase.rate_limit", "1/s", Interval::POSITIVE, DefaultValue::Number(4.0), "largest magnitude of a component of the strain rate") };
    LAW = Key { kinds: SERVO, ..form("phase.law", "\"normalised\", \"scaled\" or \"integral\"", Words("normalised; scaled with a response_time"), "control law") };
    GAIN_SHARE = Key { kinds: SERVO, ..number("phase.gain_share", "", Interval { low: Excluded(0.0), high: Excluded(1.0) }, DefaultValue::Number(0.3), "gain over its critical value; law normalised") };
    RESPONSE_TIME = Key { kinds: SERVO, ..number("phase.response_time", "s", Interval::POSITIVE, Required, "time in which an error is corrected; law scaled") };
    GAIN = Key { kinds: SERVO, ..number("phase.gain", "1/(Pa s)", Interval::POSITIVE, Required, "gain of the law integral") };
    LEAK = Key { kinds: SERVO, ..number("phase.leak", "", Interval::from_to(0.0, 1.0), Words("0.01; 0 for the law integral"), "fraction by which the strain rate decays at each exchange, so that the stress does not swing about its target; laws normalised and integral") };

    TIMES = Key { kinds: CYCLE, ..whole("phase.times", 1, 10_000, Required, "rounds of the cycle") };
    CYCLE_PHASES = Key { kinds: CYCLE, ..form("phase.phase", "an array of tables, one per phase", Required, "phases of the cycle: [[phase.phase]]") };

    UNTIL = Key { kinds: STEPS, ..form("phase.until", "a table of conditions", Required, "conditions that end the phase once all of them hold; at least one") };
    UNTIL_SOLID_FRACTION = Key { domain: Domain::Number(Interval { low: Excluded(0.0), high: Excluded(1.0) }), ..condition("phase.until.solid_fraction", "", "solid fraction at or above it") };
    UNTIL_ELAPSED = from_zero("phase.until.elapsed", "s", "simulated time in the phase at or above it; below timeout");
    UNTIL_UNBALANCED = from_zero("phase.until.unbalanced", "", "mean net force of non-rattlers over mean contact force at or below it");
    UNTIL_SPEED = from_zero("phase.until.speed", "m/s", "root mean square speed relative to the affine motion at or below it");
    UNTIL_PRESSURE_BELOW = from_zero("phase.until.pressure_below", "Pa", "mean stress at or below it");
    UNTIL_PRESSURE_ABOVE = condition("phase.until.pressure_above", "Pa", "mean stress at or above it");
    UNTIL_DEVIATOR_ABOVE = condition("phase.until.deviator_above", "Pa", "stress zz less the mean of xx and yy at or above it");
    UNTIL_DEVIATOR_BELOW = condition("phase.until.deviator_below", "Pa", "stress zz less the mean of xx and yy at or below it");
    UNTIL_STRAIN = Key { domain: BY_COMPONENT, ..condition("phase.until.strain", "", "logarithmic strain since the phase began, positive in extension, at or beyond these values, seen from 0") };
    UNTIL_STRESS_ABOVE = Key { domain: BY_COMPONENT, ..condition("phase.until.stress_above", "Pa", "stress components at or above these values, positive in compression") };
    UNTIL_STRESS_BELOW = Key { domain: BY_COMPONENT, ..condition("phase.until.stress_below", "Pa", "stress components at or below these values") };
    UNTIL_ON_TARGET = Key { kinds: SERVO, ..from_zero("phase.until.on_target", "", "error of every stress component that has a target, over the mean target, at or below it") };
    HOLD = Key { kinds: STEPS, ..number("phase.until.hold", "s", Interval::FROM_ZERO, DefaultValue::Number(0.0), "simulated time for which all conditions must hold; below timeout") };
    TIMEOUT = Key { kinds: STEPS, ..number("phase.until.timeout", "s", Interval::POSITIVE, DefaultValue::Number(1.0), "simulated time after which the phase, and with it the run, has failed") };
}

/// Keys of a phase with contacts, which an event-driven gas lacks.
pub(crate) static CONTACT_KEYS: [&Key; 4] = [&PHASE_FRICTION, &DAMPING, &DRAG, &SPIN_DRAG];

/// Every key of the format, in the order of the reference.
pub static KEYS: LazyLock<Vec<&'static Key>> = LazyLock::new(|| {
    let laws = LAW_KEYS.iter().flat_map(|(_, keys)| keys).chain(ROLLING_KEYS.iter());
    let (before, after) =
        FIXED.split_at(FIXED.iter().take_while(|k| k.path != TIME_STEP_SAFETY.path).count());
    before.iter().copied().chain(laws).chain(after.iter().copied()).collect()
});

pub(crate) static LAW_KEYS: LazyLock<Vec<(&'static str, Vec<Key>)>> = LazyLock::new(|| {
    let of = |springs: &SpringLaw| {
        let keys = springs.parameter_list().iter().map(|p| law_key(p, &format!("law {}", springs.name())));
        (springs.name(), keys.collect())
    };
    SpringLaw::EXAMPLES.iter().map(of).collect()
});

pub(crate) static ROLLING_KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
    let of = |p: &LawParameter| {
        let key = law_key(p, "any law");
        let default = if p.default.is_none() { Words("none: no resistance to rolling") } else { key.default };
        Key { default, ..key }
    };
    RollingResistance::PARAMETERS.iter().map(of).collect()
});

/// Its text is `'static`, like the text of every key.
fn law_key(p: &LawParameter, whose: &str) -> Key {
    let path = String::leak(format!("contact.{}", p.key));
    let range = Interval { low: p.range.0, high: p.range.1 };
    let default = p.default.map_or(Required, DefaultValue::Number);
    number(path, p.unit, range, default, String::leak(format!("{}; {whose}", p.meaning)))
}

const OVER_ZERO_TO_ONE: Interval = Interval { low: Excluded(0.0), high: Included(1.0) };

const fn key(path: &'static str, domain: Domain, default: DefaultValue, meaning: &'static str) -> Key {
    Key { path, kinds: &[], unit: "", domain, default, meaning }
}

const fn number(
    path: &'static str,
    unit: &'static str,
    range: Interval,
    default: DefaultValue,
    meaning: &'static str,
) -> Key {
    Key { unit, ..key(path, Domain::Number(range), default, meaning) }
}

const fn condition(path: &'static str, unit: &'static str, meaning: &'static str) -> Key {
    Key { kinds: STEPS, ..number(path, unit, Interval::FINITE, NONE, meaning) }
}

const fn from_zero(path: &'static str, unit: &'static str, meaning: &'static str) -> Key {
    Key { domain: Domain::Number(Interval::FROM_ZERO), ..condition(path, unit, meaning) }
}

const fn whole(path: &'static str, min: u64, max: u64, default: DefaultValue, meaning: &'static str) -> Key {
    key(path, Domain::Whole(min, max), default, meaning)
}

const fn flag(path: &'static str, meaning: &'static str) -> Key {
    key(path, Domain::Flag, DefaultValue::Flag(false), meaning)
}

const fn text(path: &'static str, default: DefaultValue, meaning: &'static str) -> Key {
    key(path, Domain::Text, default, meaning)
}

const fn choice(
    path: &'static str,
    words: &'static [&'static str],
    default: &'static str,
    meaning: &'static str,
) -> Key {
    key(path, Domain::Choice(words), DefaultValue::Text(default), meaning)
}

const fn form(path: &'static str, form: &'static str, default: DefaultValue, meaning: &'static str) -> Key {
    key(path, Domain::Form(form), default, meaning)
}
