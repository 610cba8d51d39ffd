//! `grainlab invert`: moduli in, microstructure out.
//!
//! - [`args`]: the flags; [`state`]: the data of one state; [`case`]: a model, its calibration and its γ/Δ; [`answer`]: the results
//! - [`inputs`]: the inputs of a state; [`columns`], [`rows`]: a table, read in pieces, each row a
//!   state; [`slips`]: columns whose names are almost those of inputs
//! - [`table`], [`mod@print`]: results in order, as text
//! - [`explain`]: contributions of the data to the uncertainty
//! - [`prior`]: priors; [`drawn`], [`evidence`], [`predictive`]: draws from the posterior, marginal likelihoods, and the data
//!   against their prediction
//! - [`speed_table`]: measured wave speeds; [`series`]: what they say with an unknown contact; [`speeds`]: the moduli that fit them
//! - `plan`: speeds before they are measured
//! - [`judge`]: results against the truth in a table
//! - [`calibrations`]: by name
//! - [`in_memory`]: a table in memory

mod answer;
mod args;
mod calibrations;
mod case;
mod columns;
mod contact;
mod drawn;
mod evidence;
mod explain;
pub(crate) mod in_memory;
mod inputs;
mod judge;
mod plan;
mod predictive;
mod print;
mod prior;
mod rows;
mod series;
mod slips;
mod speed_table;
mod speeds;
mod state;
mod table;

use answer::{Answer, More};
pub(crate) use args::Args;
use args::refuse;
use case::cases;
#[cfg(feature = "studio")]
pub(super) use columns::{BadRow, Row};
use contact::Contact;
use grainlab_console::{Failure, Format, json, print, say};
use grainlab_node_kit::Exit;
use print::Printer;
pub(super) use rows::Rows;
use speed_table::SpeedLine;
pub(super) use speed_table::{COLUMNS as SPEED_COLUMNS, checked_header, not_a_number, row as speed_row};
#[cfg(feature = "studio")]
pub(super) use state::State;
use std::path::Path;

#[cfg(feature = "studio")]
fn plot_file(args: &Args) -> Option<&Path> {
    args.plot.as_deref()
}

#[cfg(not(feature = "studio"))]
fn plot_file(_: &Args) -> Option<&Path> {
    None
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let of_series = args.contact.unwrap_or(if args.speeds.is_some() || args.plan.is_some() {
        Contact::Free
    } else {
        Contact::Hertz
    });
    if args.print_prior && of_series != Contact::Hertz {
        print(&series::prior(args.prior.as_deref())?.to_toml())?;
        return Ok(Exit::Done);
    }
    if let Some(path) = &args.plan {
        let prior = of_series.of(&series::prior(args.prior.as_deref())?);
        args.check_series()?;
        let in_file = [("--error", args.error.is_some()), ("--plot", plot_file(args).is_some())];
        refuse(&in_file, "is not for --plan: the file has the errors, and the answer no figure")?;
        plan::run(path, args, &prior, of_series.text(), args.format)?;
        return Ok(Exit::Done);
    }
    let speeds = args.speeds.as_deref().map(speed_table::read).transpose()?;
    if let Some((name, lines)) = &speeds {
        if of_series != Contact::Hertz || lines.iter().any(|l| l.pressure_pa.is_some()) {
            return infer_series(args, name, lines, of_series);
        }
    } else if of_series != Contact::Hertz {
        return Err(Failure::usage("--contact other than hertz is for --speeds: give the speeds"));
    }
    let mut cases = cases(&args.models(), &args.calibration, args.gamma.as_deref())?;
    if cases.iter().any(|case| case.model == grainlab_emt::free_contact()) {
        let of_others = [
            ("--prior", args.prior.is_some()),
            ("--print-prior", args.print_prior),
            ("--draws", args.draws.is_some()),
            ("--evidence", args.evidence),
            ("--explain", args.explain),
        ];
        refuse(
            &of_others,
            "is not for model free-contact, whose prior is that of --print-prior --contact free",
        )?;
    }
    if let Some(path) = &args.prior {
        prior::apply(path, &mut cases)?;
    }
    if args.print_prior {
        let texts = cases.iter().map(prior::text).collect::<Result<Vec<_>, _>>()?;
        print(&texts.join("\n"))?;
        return Ok(Exit::Done);
    }
    let defaults = args.defaults()?;
    let verbose = args.verbose || !args.model.is_empty() && cases.len() > 1;
    let printer = Printer { cases: &cases, verbose };
    if let Some(path) = &args.table {
        let of_one_state = [
            ("--pressure-sigma", args.pressure_sigma != 0.0),
            ("--stress-ratio-sigma", args.stress_ratio_sigma != 0.0),
            ("--density", args.density.is_some()),
            ("--density-sigma", args.density_sigma != 0.0),
        ];
        refuse(&of_one_state, "is of one state: in a --table it is a column, or of no use")?;
        let rows = Rows::open(path, &[&args.by], defaults)?;
        if args.judge {
            return judge::run(rows, &args.by, &cases, plot_file(args), args.format);
        }
        refuse(&[("--plot", plot_file(args).is_some())], "of a table is that of --judge: add it")?;
        return table::run(rows, &printer, args.format);
    }
    // With an exclusion, the parser of the command line does not enforce a required flag.
    let of_table = [
        ("--plot", plot_file(args).is_some()),
        ("--judge", args.judge),
        ("--by", !args.by.is_empty()),
        ("--gamma", args.gamma.is_some()),
    ];
    refuse(&of_table, "is for --table")?;
    let state = args.state(defaults, speeds)?;
    if let Some(path) = &args.draws {
        let (chains, per_chain) = (args.chains as usize, args.draws_per_chain as usize);
        drawn::write(&state, &cases, drawn::Number { chains, per_chain, seed: args.seed }, path)?;
    }
    let evidence = args.evidence.then(|| evidence::of_ways(&state, &cases, &args.prior_odds, args.seed));
    let mut answer = Answer::of(state, None, &cases);
    let state = answer.state.as_ref().ok().filter(|_| args.explain);
    let predictive = state.map(|state| predictive::of_ways(state, &mut answer.outcomes, &cases));
    for fault in answer.faults(&cases) {
        say!("grainlab: {fault}");
    }
    let more = More {
        explained: args.explain.then(|| explain::explained(&answer.outcomes, &cases)),
        evidence: evidence.transpose()?,
        predictive,
    };
    print(&match args.format {
        Format::Json => json(&answer.view(&cases, more))?,
        Format::Csv if args.explain || args.evidence => {
            return Err(Failure::usage("--explain and --evidence are printed as a table or as JSON"));
        }
        Format::Csv => Printer::csv_header() + &printer.csv(&answer),
        Format::Table => printer.state(&answer, &more),
    })?;
    Ok(answer.exit(&cases))
}

/// Infers the samples of a file of speeds, whose contacts are not known.
fn infer_series(args: &Args, name: &str, lines: &[SpeedLine], contact: Contact) -> Result<Exit, Failure> {
    if contact == Contact::Hertz && !args.model.is_empty() {
        return Err(Failure::usage(
            "contact hertz takes one pressure: drop the column pressure_pa and give pressure, in Pa",
        ));
    }
    args.check_series()?;
    args.refuse_flags_in_columns(lines)?;
    let prior = series::prior(args.prior.as_deref())?;
    series::run(name, lines, args, contact, &prior, (args.format, plot_file(args)))
}
