//! Contents of a report, from the files of a run. What cannot be read is named, and the report is made of the rest.

use crate::summary_file::SummaryFile;
use crate::timeline::Timeline;
use grainlab_page::three_digits;
use grainlab_recordings::{METADATA_RECORD, Recording, SeveralRuns, input, scenes};
use grainlab_results::Inference;
use grainlab_results::read_back::{self, InvertedPacking};
use grainlab_scene::Scene;
use std::path::{Path, PathBuf};

const NO_RECORDING: &str = "No recording";

const NO_SUMMARY: &str = "No summary";

/// A run with its files.
#[derive(Debug, Default)]
pub struct Run {
    pub(crate) directory: PathBuf,
    pub(crate) summary: SummaryFile,
    /// Packings at the ends of phases, with what was inferred.
    pub(crate) states: Vec<InvertedPacking>,
    /// Inferred from data that are not about a packing of the run.
    pub(crate) of_instruments: Vec<Inference>,
    /// The recording holds several runs: there is no report of it.
    several_runs: Option<SeveralRuns>,
    pub(crate) timeline: Timeline,
    /// Text of the scene; empty if there is none.
    pub(crate) scene_text: String,
    pub(crate) scene: Option<Scene>,
    /// Launch file and arguments, as they are typed; `None` for a run that was started by hand.
    pub(crate) launched: Option<Vec<String>>,
    /// Why a launch with the scene in the directory is not known to be the same run.
    pub(crate) another: Option<String>,
    /// Program that wrote the recording, if it says so.
    pub(crate) recorded_by: Option<String>,
    /// Files whose recorder ended early, and did not count all lost messages.
    pub(crate) uncounted_files: usize,
    /// It is unknown which messages of the recording are right; the lines are in the summary or in `missing`.
    disputed: bool,
    /// Parts that could not be read, one line each.
    pub(crate) missing: Vec<String>,
}

impl Run {
    /// Why this is no run: it has no summary, no scene and no packing.
    pub fn nothing(&self) -> Option<&str> {
        let summary = !self.missing.iter().any(|line| line.starts_with(NO_SUMMARY));
        let found = summary || !self.scene_text.is_empty() || !self.states.is_empty();
        let reason = self.missing.iter().find(|line| line.starts_with(NO_RECORDING));
        (!found).then(|| reason.map_or("it has no summary, no scene and no packing", String::as_str))
    }

    /// True if something could not be read.
    pub fn is_incomplete(&self) -> bool {
        !self.missing.is_empty()
    }

    /// Returns true if the run ended without an error, and all of it can be read.
    pub(crate) fn is_complete(&self) -> bool {
        self.summary.exit == Some(0) && !self.is_incomplete()
    }

    /// True if it is unknown which messages of the recording are right.
    pub fn is_disputed(&self) -> bool {
        self.disputed
    }

    /// Reads the files of a run: a run directory, or a recording.
    pub fn read(path: &Path) -> Self {
        let directory = if path.is_dir() { path } else { path.parent().unwrap_or(path) };
        let mut run = Self {
            directory: path.to_owned(),
            launched: launched(&directory.join("launch.json")),
            ..Self::default()
        };
        run.read_summary(&directory.join("summary.json"));
        let recording = Recording::open(path);
        run.read_scene(recording.as_ref().ok(), &directory.join("scene.toml"));
        match recording {
            Ok(recording) => run.read_recording(&recording),
            Err(error) => run.missing.push(format!("{NO_RECORDING}: {error}")),
        }
        run
    }

    fn read_summary(&mut self, path: &Path) {
        let found = input::text(path, input::TEXT)
            .map_err(|e| e.to_string())
            .and_then(|text| serde_json::from_str(&text).map_err(|e| e.to_string()));
        match found {
            Ok(summary) => self.summary = summary,
            Err(error) => self.missing.push(format!(
                "{NO_SUMMARY}: summary.json: {error}. How the run ended, and the messages that it lost, are not known"
            )),
        }
    }

    /// The scene: that stored in the recording, else the file beside it.
    fn read_scene(&mut self, recording: Option<&Recording>, path: &Path) {
        let stored = recording.and_then(|r| r.stored_files().into_iter().find(|f| f.name == "scene.toml"));
        let is_stored = stored.is_some();
        match (stored, input::text(path, input::SETTINGS)) {
            (Some(file), _) => self.scene_text = String::from_utf8_lossy(&file.bytes).into_owned(),
            (None, Ok(text)) => self.scene_text = text,
            (None, Err(error)) => self.missing.push(format!("No scene: scene.toml: {error}")),
        }
        self.scene = Scene::parse(&self.scene_text).ok();
        self.another = match scenes::read(&path.to_string_lossy(), &[], self.seed()) {
            _ if !is_stored => {
                Some("the recording has no scene that shows whether this is the same run".to_owned())
            }
            Err(error) => Some(format!("this does not run: {error}")),
            Ok(scene) if scene.text != self.scene_text => {
                Some("another run: scene.toml is not the scene that the recording began with".to_owned())
            }
            Ok(_) => None,
        };
    }

    /// Names a seed of the summary that is not the one of the recorded scene.
    fn check_seed(&mut self) {
        if let (Some(scene), Some(seed)) = (&self.scene, self.summary.seed)
            && scene.seed != seed
        {
            self.missing.push(format!(
                "summary.json states the seed {seed}, and the recorded scene the seed {}: the page has the recorded one",
                scene.seed
            ));
        }
    }

    fn read_recording(&mut self, recording: &Recording) {
        self.recorded_by = Some(recording.info().library).filter(|by| !by.is_empty());
        self.leave_out_another_summary(recording);
        self.check_seed();
        self.uncounted_files = recording.unaccounted().len() + recording.ended_early().iter().len();
        let back = read_back::read(recording);
        if back.several_runs.is_some() {
            return self.refuse(back.several_runs);
        }
        (self.states, self.of_instruments) = (back.states, back.of_instruments);
        self.disputed = back.disputed;
        // The launcher writes these lines to the summary, too.
        let known = |line: &String| self.summary.warnings.contains(line);
        self.missing.extend(back.complaints.into_iter().filter(|line| !known(line)));
        let phases = self.scene.as_ref().map_or(1, |s| s.phases.len());
        match Timeline::read(recording, phases) {
            Ok(timeline) if timeline.several_runs.is_some() => {
                let sign = timeline.several_runs;
                let path = recording.path().to_owned();
                return self.refuse(sign.map(|sign| SeveralRuns { path, sign }));
            }
            Ok(timeline) => {
                self.timeline = timeline;
                // The scene has the names of all phases.
                let phases = self.scene.iter().flat_map(|s| &s.phases).zip(self.timeline.first_phase()..);
                phases.for_each(|(phase, n)| self.timeline.name(n, &phase.name));
            }
            Err(error) => self.missing.push(format!("Nothing against time: {error}")),
        }
        // Some damage is found only where the messages are.
        for warning in recording.warnings().iter().map(ToString::to_string) {
            if !self.missing.contains(&warning) && !self.summary.warnings.contains(&warning) {
                self.missing.push(warning);
            }
        }
        if self.timeline.unreadable > 0 {
            self.missing.push(format!(
                "{} could not be read",
                grainlab_console::count(self.timeline.unreadable, "message")
            ));
        }
    }

    /// Leaves out a summary of another run. A file of a killed recorder does not name its run.
    fn leave_out_another_summary(&mut self, recording: &Recording) {
        let of_recording = recording.metadata(METADATA_RECORD).and_then(|mut record| record.remove("run"));
        let Some(id) = of_recording.filter(|_| recording.unaccounted().is_empty()) else { return };
        if self.summary.run.is_empty() || self.summary.run == id {
            return;
        }
        self.missing.push(format!(
            "summary.json is of run {}, and the recording of run {id}: the summary was left out",
            self.summary.run
        ));
        self.summary = SummaryFile::default();
    }

    /// Leaves out all that was joined.
    fn refuse(&mut self, why: Option<SeveralRuns>) {
        (self.states, self.of_instruments) = (Vec::new(), Vec::new());
        self.missing.extend(why.as_ref().map(ToString::to_string));
        self.several_runs = why;
    }

    /// Why the recording is not of one run.
    pub fn several_runs(&self) -> Option<&SeveralRuns> {
        self.several_runs.as_ref()
    }

    /// This run for a table: without series and packings, which are large.
    #[must_use]
    pub fn without_series(self) -> Self {
        Self { timeline: Timeline::default(), ..self }
    }

    /// True for a run of the same scene and seed with the same packings at the ends of its phases.
    pub fn repeats(&self, other: &Self) -> bool {
        let reports = |run: &Self| run.states.iter().map(|s| s.packing.report.clone()).collect::<Vec<_>>();
        self.scene_text == other.scene_text && !self.states.is_empty() && reports(self) == reports(other)
    }

    /// Name of the directory.
    pub(crate) fn name(&self) -> String {
        let resolved = self.directory.canonicalize().unwrap_or_else(|_| self.directory.clone());
        resolved.file_name().map_or_else(|| "run".to_owned(), |n| n.to_string_lossy().into_owned())
    }

    pub(crate) fn scene_name(&self) -> String {
        match (&self.scene, self.summary.scene.as_str()) {
            (Some(scene), "") => scene.name.clone(),
            (None, "") => "unknown scene".to_owned(),
            (_, name) => name.to_owned(),
        }
    }

    pub(crate) fn seed(&self) -> Option<u64> {
        self.scene.as_ref().map(|scene| scene.seed).or(self.summary.seed)
    }

    /// The last packing at the end of a phase.
    pub(crate) fn last(&self) -> Option<&InvertedPacking> {
        self.states.last()
    }
}

/// Returns the pressures of these states, kPa: one number, or a range.
pub(crate) fn pressure_range<'a>(
    states: impl IntoIterator<Item = &'a InvertedPacking>,
    decimals: usize,
) -> String {
    let pressures = states.into_iter().map(|state| state.packing.report.pressure() / 1e3);
    let ends = pressures.fold([f64::INFINITY, 0.0], |[low, high], p| [p.min(low), p.max(high)]);
    let [low, high] = ends.map(|p| three_digits(p, decimals));
    if low == high { low } else { format!("{low} to {high}") }
}

/// The words after `grainlab launch` in a file that it wrote.
fn launched(path: &Path) -> Option<Vec<String>> {
    let text = input::text(path, input::SETTINGS).ok()?;
    let mut launched: serde_json::Value = serde_json::from_str(&text).ok()?;
    serde_json::from_value(launched.get_mut("words")?.take()).ok()
}
