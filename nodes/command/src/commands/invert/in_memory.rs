//! A table in memory, inverted by one model.

use super::answer::Answer;
use super::columns::Row;
use super::rows::Rows;
use super::{Args, drawn, prior};
use clap::Parser;
use grainlab_console::Failure;
use grainlab_emt::Draws;
use grainlab_node_kit::Exit;
use grainlab_results::Inference;

/// The flags of a table.
#[derive(Debug, Parser)]
#[command(name = "invert")]
struct Flags {
    #[command(flatten)]
    args: Args,
}

/// The answers of a table.
#[derive(Debug)]
pub struct Inverted {
    /// Sample and answer of each row.
    pub rows: Vec<(Option<String>, Inference)>,
    /// Draws from the posterior of the first row, if asked for.
    pub draws: Option<Draws>,
}

/// Inverts each row of `table`, text of the form of `grainlab invert --table`, by one model, on all cores. `flags` are those of the
/// command, and `prior` is the text of a file of a prior. With `draws`, a number and a seed, the first row is drawn from.
///
/// # Errors
/// Wrong flags, columns or priors; draws of a row that has no answer.
pub fn invert(
    flags: &[String],
    table: Vec<u8>,
    prior: Option<&str>,
    draws: Option<(usize, u64)>,
) -> Result<Inverted, Failure> {
    let words = ["invert", "--table", "-"].iter().map(|&word| word.to_owned()).chain(flags.iter().cloned());
    let Flags { args } = Flags::try_parse_from(words).map_err(|e| Failure::usage(e.to_string().trim()))?;
    let mut cases = args.cases()?;
    if let Some(text) = prior {
        prior::apply_text("prior", text, &mut cases)?;
    }
    let [case] = &cases[..] else { return Err(Failure::usage("name one model, one calibration and one gamma")) };
    let mut rows = Rows::of_text(table, args.defaults()?)?;
    let (mut found, mut drawn) = (Vec::new(), None);
    let answer = |number, row| match row {
        Ok(Row { state, .. }) => Answer::of(state, Some(number), &cases),
        Err(bad) => Answer::of_bad_row(bad, number),
    };
    while let Some(answers) = rows.next(answer)? {
        for answer in answers {
            if let (Some((count, seed)), None, Ok(state)) = (draws, &drawn, &answer.state) {
                let of_row = drawn::drawn(state, case, count, seed);
                drawn = Some(of_row.map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?.0);
            }
            let sample = answer.sample().map(str::to_owned);
            found.extend(answer.inferences(&cases).into_iter().map(|inference| (sample.clone(), inference)));
        }
    }
    Ok(Inverted { rows: found, draws: drawn })
}
