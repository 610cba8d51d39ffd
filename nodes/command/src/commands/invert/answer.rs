//! The results of the models for one state.

use super::case::Case;
use super::columns::BadRow;
use super::evidence::OfModel;
use super::explain::Explained;
use super::predictive::Predictive;
use super::state::State;
use grainlab_console::worse;
use grainlab_core::notes::{Note, Status, texts};
use grainlab_core::results::Estimate;
use grainlab_emt::{EmtError, Inversion, recommended};
use grainlab_node_kit::Exit;
use grainlab_results::Inference;
use serde::Serialize;

#[derive(Debug)]
pub(super) struct Answer {
    pub(super) line: Option<u64>,
    pub(super) state: Result<State, BadRow>,
    /// One per case; empty without a state.
    pub(super) outcomes: Vec<Result<Inversion, EmtError>>,
}

#[derive(Debug, Serialize)]
pub(super) struct View<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u64>,
    inputs: Option<&'a State>,
    results: Vec<Inference>,
    #[serde(flatten)]
    more: More,
}

#[derive(Debug, Default, Serialize)]
pub(super) struct More {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) explained: Option<Vec<Explained>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) predictive: Option<Vec<Predictive>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) evidence: Option<Vec<OfModel>>,
}

impl Answer {
    pub(super) fn of(state: State, line: Option<u64>, cases: &[Case]) -> Self {
        let outcomes = cases.iter().map(|case| state.infer(case)).collect();
        Self { line, state: Ok(state), outcomes }
    }

    pub(super) fn of_bad_row(row: BadRow, line: u64) -> Self {
        Self { line: Some(line), state: Err(row), outcomes: Vec::new() }
    }

    pub(super) fn sample(&self) -> Option<&str> {
        match &self.state {
            Ok(state) => state.sample.as_deref(),
            Err(row) => row.sample.as_deref(),
        }
    }

    pub(super) fn inferences(&self, cases: &[Case]) -> Vec<Inference> {
        let one = |(i, case): (usize, &Case)| self.inference(case, self.outcomes.get(i));
        cases.iter().enumerate().map(one).collect()
    }

    fn inference(&self, case: &Case, outcome: Option<&Result<Inversion, EmtError>>) -> Inference {
        let name = case.calibration.name();
        match (&self.state, outcome) {
            (Ok(state), Some(outcome)) => {
                let mut inference = Inference::new(case.model.name(), name, outcome);
                inference.estimate.add_notes(&state.notes);
                inference
            }
            (Err(row), _) => {
                let fault = Note::no_answer(row.fault.clone());
                Estimate::unknown(case.model.name(), name, vec![fault]).into()
            }
            (Ok(_), None) => Estimate::unknown(case.model.name(), name, Vec::new()).into(),
        }
    }

    pub(super) fn view(&self, cases: &[Case], more: More) -> View<'_> {
        let inputs = self.state.as_ref().ok();
        View { line: self.line, inputs, results: self.inferences(cases), more }
    }

    /// The exit code of a command with only this result. Invalid moduli are wrong usage, moduli that no
    /// packing has are invalid physics, and so is an answer of the recommended model that contradicts them, or
    /// none at all. A model that lacks an input is not an error, unless no model has a result.
    pub(super) fn exit(&self, cases: &[Case]) -> Exit {
        let Ok(state) = &self.state else { return Exit::Usage };
        let statuses: Vec<(&str, Status)> =
            cases.iter().zip(&self.outcomes).map(|(case, o)| (case.model.name(), status(state, o))).collect();
        if statuses.iter().all(|(_, status)| *status == Status::Unknown) {
            let lacking = self.outcomes.iter().all(|o| o.as_ref().err().is_some_and(is_lacking));
            let alone = if lacking { Exit::Usage } else { Exit::PhysicsInvalid };
            return worse(alone, self.worst_error());
        }
        let best = recommended(statuses.iter().copied());
        let mut of_best = statuses.iter().filter(|(model, _)| Some(*model) == best).peekable();
        let contradicts = of_best.peek().is_some() && of_best.all(|(_, s)| *s == Status::Contradictory);
        worse(self.worst_error(), if contradicts { Exit::PhysicsInvalid } else { Exit::Done })
    }

    fn worst_error(&self) -> Exit {
        self.errors().filter(|e| !is_lacking(e)).fold(Exit::Done, |exit, e| {
            worse(exit, if e.is_input_error() { Exit::Usage } else { Exit::PhysicsInvalid })
        })
    }

    /// The errors and contradictions, each once with its models; empty if [`Answer::exit`] is `Done`.
    pub(super) fn faults(&self, cases: &[Case]) -> Vec<String> {
        let state = match &self.state {
            Ok(state) => state,
            Err(row) => return vec![row.fault.clone()],
        };
        if self.exit(cases) == Exit::Done {
            return Vec::new();
        }
        let nothing = self.outcomes.iter().all(|o| o.as_ref().err().is_some_and(is_lacking));
        let mut faults: Vec<(String, Vec<&str>)> = Vec::new();
        for (outcome, case) in self.outcomes.iter().zip(cases) {
            let texts = match outcome {
                Err(error) if is_lacking(error) && !nothing => continue,
                Err(error) => vec![error.to_string()],
                Ok(estimate) => contradictions(state, estimate),
            };
            let model = case.model.name();
            for text in texts {
                match faults.iter_mut().find(|(known, _)| *known == text) {
                    Some((_, models)) if models.contains(&model) => {}
                    Some((_, models)) => models.push(model),
                    None => faults.push((text, vec![model])),
                }
            }
        }
        faults.into_iter().map(|(text, models)| format!("{}: {text}", models.join(", "))).collect()
    }

    /// Why an estimate is contradictory, or determines nothing; empty for others.
    pub(super) fn contradictions(&self) -> Vec<String> {
        let Ok(state) = &self.state else { return Vec::new() };
        let of_outcome = |outcome: &Result<Inversion, EmtError>| {
            outcome.as_ref().map_or(Vec::new(), |estimate| contradictions(state, estimate))
        };
        self.outcomes.iter().flat_map(of_outcome).collect()
    }

    /// The faults as lines for stderr, each with the number of the row.
    pub(super) fn complaint(&self, cases: &[Case]) -> String {
        let line = self.line.map_or_else(String::new, |l| format!("line {l}"));
        let place = match self.sample() {
            Some(sample) => format!("{line} ({sample})"),
            None => line,
        };
        let lines: Vec<String> =
            self.faults(cases).iter().map(|f| format!("grainlab: {place}: {f}")).collect();
        lines.join("\n")
    }

    fn errors(&self) -> impl Iterator<Item = &EmtError> {
        self.outcomes.iter().filter_map(|o| o.as_ref().err())
    }
}

/// True if a model lacked an input, or an error to weigh a prior against.
fn is_lacking(error: &EmtError) -> bool {
    matches!(error, EmtError::Missing { .. } | EmtError::NotCalibrated { .. } | EmtError::NoLikelihood { .. })
}

/// Returns the status of an outcome: the worse one of model and data.
fn status(state: &State, outcome: &Result<Inversion, EmtError>) -> Status {
    outcome.as_ref().map_or(Status::Unknown, Inversion::status).max(Status::of(&state.notes))
}

/// Returns the contradictions of data and model, or the reasons why nothing is determined.
fn contradictions(state: &State, inversion: &Inversion) -> Vec<String> {
    let is_reason =
        |note: &&Note| note.severity() >= Status::Contradictory || inversion.status() == Status::Unknown;
    texts(state.notes.iter().chain(&inversion.notes).filter(is_reason))
}
