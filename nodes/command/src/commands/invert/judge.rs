//! Estimates against the truth in a table, model by model.
//!
//! - [`score`]: statistics of the errors of one quantity; [`plot`]: estimates against the truth, plotted

#[cfg(feature = "studio")]
mod plot;
mod score;

use super::answer::Answer;
use super::columns::BadRow;
use super::rows::Rows;
use super::state::State;
use super::table::Tally;
use super::way::Way;
use grainlab_console::{Failure, Format, Table, count, exact, fixed, say};
use grainlab_core::results::InferredQuantity;
use grainlab_node_kit::Exit;
use score::Score;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;

/// The result of one way for one quantity of one group of rows.
#[derive(Debug, Serialize)]
struct Judged {
    /// Cells of the columns grouped by.
    group: Vec<String>,
    model: &'static str,
    calibration: String,
    /// The γ/Δ that the model used, or `none`.
    gamma_over_delta_source: &'static str,
    quantity: &'static str,
    /// The quantity that it is compared with.
    truth: &'static str,
    #[serde(flatten)]
    score: Score,
}

/// The result of one way for one row: whether there is an estimate, the γ/Δ used, and the error of each quantity whose truth is known.
struct Verdict {
    solved: bool,
    gamma: &'static str,
    errors: [Option<score::Error>; grainlab_core::results::InferredQuantity::COUNT],
    /// True and inferred contact anisotropy.
    anisotropy: Option<[f64; 2]>,
}

/// Inverts every row, and prints the errors against the truth; `plot` is the file of the plot, if one is
/// drawn.
pub(super) fn run(
    mut rows: Rows,
    by: &[String],
    ways: &[Way],
    plot: Option<&Path>,
    format: Format,
) -> Result<Exit, Failure> {
    if !rows.columns.has_truth() {
        let needed = InferredQuantity::ALL.map(InferredQuantity::name).join(", ");
        return Err(Failure::usage(format!("{}: no column to judge by ({needed})", rows.name())));
    }
    let mut tally = Tally::new();
    let mut board = Board::default();
    let mut points = vec![Vec::new(); ways.len()];
    let mut unsolved = Vec::new();
    loop {
        let piece = rows.next(|number, row| {
            let row = row.map_err(|bad| (number, bad))?;
            let verdicts: Vec<_> = ways.iter().map(|way| Verdict::of(&row.state, way)).collect();
            let unsolved = verdicts.iter().all(|v| !v.solved).then(|| {
                let answer = Answer::of(row.state, Some(number), ways);
                (answer.exit(ways), answer.complaint(ways))
            });
            Ok::<_, (u64, BadRow)>((row.group, verdicts, unsolved))
        })?;
        let Some(piece) = piece else { break };
        for row in piece {
            match row {
                Ok((group, verdicts, reason)) => {
                    tally.add(Exit::Done, "");
                    unsolved.extend(reason);
                    for (points, verdict) in points.iter_mut().zip(&verdicts) {
                        points.extend(verdict.anisotropy);
                    }
                    board.enter(group, &verdicts);
                }
                // A missing estimate is part of the statistics. An invalid row is an error.
                Err((number, bad)) => {
                    let answer = Answer::of_bad_row(bad, number);
                    let exit = answer.refusal();
                    // A contradiction is an answer, which counts as any other.
                    let complaint = if exit == Exit::Done { String::new() } else { answer.complaint(ways) };
                    tally.add(exit, &complaint);
                }
            }
        }
    }
    let judged = board.judged(ways);
    format.print(&judged, || csv(&judged, by), || people(&judged, by))?;
    if let Some(path) = plot.filter(|_| points.iter().all(Vec::is_empty)) {
        tally.end(&rows)?;
        return Err(Failure::usage(format!(
            "{} is not written: no row of {} has eps, and a model that infers it",
            path.display(),
            rows.name()
        )));
    }
    #[cfg(feature = "studio")]
    if let Some(path) = plot {
        grainlab_console::write_whole(path, plot::svg(ways, points))
            .map_err(|e| Failure::failed(format!("{}: {e}", path.display())))?;
    }
    if let Some((exit, complaint)) = unsolved.first() {
        say!("{complaint}\ngrainlab: {} without an estimate, this the first", count(unsolved.len(), "row"));
        tally.unsolved(unsolved.len(), *exit);
    }
    tally.end(&rows)
}

impl Verdict {
    fn of(state: &State, way: &Way) -> Self {
        let estimate = state.infer(way).ok();
        let errors = InferredQuantity::ALL.map(|quantity| {
            let truth = state.truth.get(against(quantity, way))?;
            Some(score::Error::of(estimate.as_ref(), quantity, truth))
        });
        let found = estimate.as_ref().and_then(|e| e.structure.eps);
        let anisotropy = state.truth.eps.zip(found).map(<[f64; 2]>::from);
        Self { solved: estimate.is_some(), gamma: state.gamma_source(way), errors, anisotropy }
    }
}

/// The quantity for comparison: k̂ is not a property of a packing, so that the coordination number of its
/// calibration is used.
fn against(quantity: InferredQuantity, way: &Way) -> InferredQuantity {
    match quantity {
        InferredQuantity::KHat => way.calibration.isotropic().coordination_kind,
        other => other,
    }
}

/// Group, way, and γ/Δ.
type Place = (usize, usize, &'static str);

/// Scores by group, way and γ/Δ, each in the order of its first row.
#[derive(Default)]
struct Board {
    groups: Vec<Vec<String>>,
    index: HashMap<Vec<String>, usize>,
    scores: Vec<(Place, [Score; grainlab_core::results::InferredQuantity::COUNT])>,
    places: HashMap<Place, usize>,
}

impl Board {
    fn enter(&mut self, group: Vec<String>, verdicts: &[Verdict]) {
        let group = match self.index.get(&group) {
            Some(known) => *known,
            None => {
                self.groups.push(group.clone());
                self.index.insert(group, self.groups.len() - 1);
                self.groups.len() - 1
            }
        };
        for (way, verdict) in verdicts.iter().enumerate() {
            let key = (group, way, verdict.gamma);
            let place = *self.places.entry(key).or_insert_with(|| {
                self.scores.push((key, Default::default()));
                self.scores.len() - 1
            });
            for (score, error) in self.scores[place].1.iter_mut().zip(&verdict.errors) {
                if let Some(error) = error {
                    score.add(error);
                }
            }
        }
    }

    /// For each quantity of the model whose truth is known.
    fn judged(mut self, ways: &[Way]) -> Vec<Judged> {
        self.scores.sort_by_key(|((group, way, _), _)| (*group, *way));
        let groups = self.groups;
        let of = |((group, way, gamma), scores): (
            Place,
            [Score; grainlab_core::results::InferredQuantity::COUNT],
        )| {
            let (group, way) = (groups[group].clone(), &ways[way]);
            let domain = way.model.domain(&way.calibration);
            let relevant = move |(q, score): &(InferredQuantity, Score)| {
                score.rows > 0 && (score.solved > 0 || domain.structure[*q as usize].is_some())
            };
            InferredQuantity::ALL.into_iter().zip(scores).filter(relevant).map(move |(quantity, score)| {
                Judged {
                    group: group.clone(),
                    model: way.model.name(),
                    calibration: way.calibration.name().to_owned(),
                    gamma_over_delta_source: gamma,
                    quantity: quantity.name(),
                    truth: against(quantity, way).name(),
                    score,
                }
            })
        };
        self.scores.into_iter().flat_map(of).collect()
    }
}

fn people(judged: &[Judged], by: &[String]) -> String {
    let columns =
        ["model", "calibration", "gamma/Delta", "inferred", "truth", "rows", "solved", "bias", "scatter"];
    let columns = columns.into_iter().chain(["rms", "mean |error|", "in 95 %"]);
    let mut t = Table::new(by.iter().map(String::as_str).chain(columns));
    for j in judged {
        let digits = if j.quantity.starts_with("eps") { 4 } else { 3 };
        let s = &j.score;
        // Removes the sign of a rounded zero.
        let number = |value: Option<f64>| {
            let text = fixed(value, digits);
            let is_zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
            if value.is_some() && is_zero { text.replace('-', "") } else { text }
        };
        let covered = s.coverage().map_or_else(|| "-".to_owned(), |c| format!("{:.1} %", 100.0 * c));
        let cells =
            [j.model, &j.calibration, j.gamma_over_delta_source, j.quantity, j.truth].map(str::to_owned);
        let numbers =
            [number(s.bias()), number(s.scatter()), number(s.rms()), number(s.mean_absolute()), covered];
        let counts = [s.rows.to_string(), s.solved.to_string()];
        t.row(j.group.iter().cloned().chain(cells).chain(counts).chain(numbers));
    }
    t.without_empty_columns().text() + &overconfident(judged)
}

/// One line for each quantity whose intervals hold the truth far less often than stated.
fn overconfident(judged: &[Judged]) -> String {
    let line = |j: &Judged| {
        format!(
            "{}{}: its 95 % intervals hold {} in {} of {} rows: these packings are unlike those of calibration {}, or {} was \
             counted in another way\n",
            j.group.iter().map(|cell| format!("{cell} ")).collect::<String>(),
            j.model,
            j.truth,
            j.score.covered(),
            j.score.intervals,
            j.calibration,
            j.truth,
        )
    };
    judged.iter().filter(|j| j.score.is_overconfident()).map(line).collect()
}

fn csv(judged: &[Judged], by: &[String]) -> String {
    let columns = ["model", "calibration", "gamma_over_delta_source", "quantity", "truth", "rows", "solved"];
    let columns = columns.into_iter().chain(["extrapolated", "bias", "scatter", "rms", "mean_absolute"]);
    let columns = columns.chain(["intervals", "covered"]);
    let mut t = Table::new(by.iter().map(String::as_str).chain(columns));
    for j in judged {
        let s = &j.score;
        let cells =
            [j.model, &j.calibration, j.gamma_over_delta_source, j.quantity, j.truth].map(str::to_owned);
        let counts = [s.rows, s.solved, s.extrapolated].map(|n| n.to_string());
        let numbers = [s.bias(), s.scatter(), s.rms(), s.mean_absolute()].map(exact);
        let covered = [s.intervals.to_string(), exact(s.coverage())];
        t.row(j.group.iter().cloned().chain(cells).chain(counts).chain(numbers).chain(covered));
    }
    t.csv()
}
