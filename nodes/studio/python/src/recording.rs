//! Recordings: their packings and messages, read one by one.

use crate::error;
use crate::files::warn;
use crate::packing::PyPacking;
use crate::values;
use grainlab_any_message::Schema;
use grainlab_recordings::import::recording::packing;
use grainlab_recordings::{ChannelInfo, Messages, Recording, Selection, Warning, WarningKind, input};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use self_cell::self_cell;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

self_cell!(
    /// Messages, with the recording that they are read from.
    struct Stream {
        owner: Arc<Recording>,
        #[not_covariant]
        dependent: Messages,
    }
);

impl Stream {
    fn of(recording: &Arc<Recording>, topics: Option<Vec<String>>) -> PyResult<Self> {
        let selection = Selection { topics, ..Selection::default() };
        Self::try_new(recording.clone(), |recording| recording.messages(&selection)).map_err(error::file)
    }

    /// Returns the next message, and damage by which messages may be missing as the last item.
    fn next(&mut self) -> PyResult<Option<grainlab_recordings::Message>> {
        match self.with_dependent_mut(|_, messages| messages.next()) {
            None => self.whole().map(|()| None),
            message => Ok(message),
        }
    }

    /// Raises FileError if damage was met, by which the number of a message is not its place in the recording.
    fn whole(&self) -> PyResult<()> {
        match self.with_dependent(|_, messages| messages.damage().map(ToString::to_string)) {
            Some(damage) => Err(error::file(format!("messages may be missing: {damage}"))),
            None => Ok(()),
        }
    }
}

/// Opens a recording: an MCAP file or a run directory. Its values are in SI units. Raises FileError.
///
/// >>> recording = grainlab.open("recordings/runs/demo-1-1")
#[pyfunction]
pub(crate) fn open(py: Python<'_>, path: PathBuf) -> PyResult<PyRecording> {
    let recording = py.detach(|| Recording::open(&path)).map_err(error::file)?;
    for warning in recording.warnings() {
        warn(py, &warning.to_string())?;
    }
    Ok(PyRecording { recording: Arc::new(recording) })
}
/// An opened recording: its packings, and its messages of any type. SI units. Made by :func:`open`, which raises FileError.
///
/// >>> recording = grainlab.open("recordings/runs/demo-1-1")
/// >>> recording.topics["/packing"]["messages"]
#[pyclass(name = "Recording", module = "grainlab", frozen)]
pub(crate) struct PyRecording {
    recording: Arc<Recording>,
}

#[pymethods]
impl PyRecording {
    fn __repr__(&self) -> String {
        let info = self.recording.info();
        let messages: u64 = info.topics.iter().map(|t| t.messages).sum();
        let (path, topics) = (self.recording.path().display(), info.topics.len());
        format!("<grainlab.Recording {path}: {messages} messages on {topics} topics>")
    }

    /// The path that it was opened by.
    #[getter]
    fn path(&self) -> PathBuf {
        self.recording.path().to_owned()
    }

    /// By topic: type, messages, published, lost (None where no recorder counted them).
    #[getter]
    fn topics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for topic in self.recording.info().topics {
            let entry = PyDict::new(py);
            entry.set_item("type", topic.ros_type)?;
            entry.set_item("messages", topic.messages)?;
            entry.set_item("published", topic.published)?;
            entry.set_item("lost", topic.lost)?;
            dict.set_item(topic.name, entry)?;
        }
        Ok(dict)
    }

    /// Parts that could not be read so far.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.recording.warnings().iter().map(ToString::to_string).collect()
    }

    /// Summary of a launched run: states with measurements and estimates, topics, messages lost, exit code. Raises FileError for others.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let path = self.recording.path().join("summary.json");
        let text =
            input::text(&path, input::TEXT).map_err(|e| error::file(format!("{}: {e}", path.display())))?;
        py.import("json")?.call_method1("loads", (text,))
    }

    fn __fspath__(&self) -> &OsStr {
        self.recording.path().as_os_str()
    }

    /// Text of the scene.
    #[getter]
    fn scene(&self) -> Option<String> {
        let files = self.recording.stored_files();
        let scene = files.into_iter().find(|f| f.name == "scene.toml")?;
        Some(String::from_utf8_lossy(&scene.bytes).into_owned())
    }

    /// Packings: a sequence, read as they are asked for. Raises FileError for a topic that it does not have.
    #[pyo3(signature = (topic="packing"))]
    fn packings<'py>(slf: Bound<'py, Self>, topic: &str) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("grainlab.recordings")?.getattr("Packings")?.call1((slf, topic))
    }

    /// The packings, one by one.
    fn _packings(&self, topic: &str) -> PyResult<PackingIterator> {
        Ok(PackingIterator(Mutex::new(Stream::of(&self.recording, Some(vec![topic.to_owned()]))?)))
    }

    /// Last packing of the topic. Raises IndexError if it has none, and FileError for damage.
    #[pyo3(signature = (topic="packing"))]
    fn last_packing(&self, py: Python<'_>, topic: &str) -> PyResult<PyPacking> {
        let message = py.detach(|| self.recording.last(topic)).map_err(error::file)?;
        let hides = |w: &Warning| {
            matches!(
                w.kind,
                WarningKind::DamagedChunk
                    | WarningKind::DamagedRecord
                    | WarningKind::Orphans
                    | WarningKind::AfterEnd
            )
        };
        if let Some(damage) = self.recording.warnings().iter().find(|w| hides(w)) {
            return Err(error::file(format!("later packings may be missing: {damage}")));
        }
        let message = message.ok_or_else(|| PyIndexError::new_err("the recording has no packing"))?;
        Ok(packing(&message).map_err(error::file)?.into())
    }

    /// (topic, time of arrival in ns since 1970, fields) of the messages of these topics, or of all, of any type. Raises FileError.
    #[pyo3(signature = (*topics))]
    fn messages(&self, topics: Vec<String>) -> PyResult<MessageIterator> {
        let topics = (!topics.is_empty()).then_some(topics);
        let stream = Stream::of(&self.recording, topics)?;
        Ok(MessageIterator(Mutex::new(Decoder { stream, schemas: BTreeMap::new() })))
    }
}

#[pyclass(module = "grainlab", frozen)]
pub(crate) struct PackingIterator(Mutex<Stream>);

#[pymethods]
impl PackingIterator {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    /// The packing after the next ``passed`` ones, which are not decoded. Raises FileError for damage before it, which would shift its
    /// number, and if there is none.
    fn after(&self, py: Python<'_>, passed: usize) -> PyResult<PyPacking> {
        let message = py.detach(|| {
            let mut stream = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            for _ in 0..passed {
                stream.next()?;
            }
            let message = stream.next()?;
            stream.whole().map(|()| message)
        })?;
        let missing = || error::file("the recording holds fewer packings than it states");
        Ok(packing(&message.ok_or_else(missing)?).map_err(error::file)?.into())
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<PyPacking>> {
        let next = || self.0.lock().unwrap_or_else(PoisonError::into_inner).next();
        let message = py.detach(next)?;
        Ok(message.map(|m| packing(&m)).transpose().map_err(error::file)?.map(PyPacking::from))
    }
}

struct Decoder {
    stream: Stream,
    schemas: BTreeMap<String, Arc<Schema>>,
}

impl Decoder {
    fn next(&mut self) -> PyResult<Option<(grainlab_recordings::Message, Arc<Schema>)>> {
        let Some(message) = self.stream.next()? else { return Ok(None) };
        let schema = match self.schemas.get(&message.channel.topic) {
            Some(schema) => schema.clone(),
            None => {
                let schema = Arc::new(schema(&message.channel)?);
                self.schemas.insert(message.channel.topic.clone(), schema.clone());
                schema
            }
        };
        Ok(Some((message, schema)))
    }
}

fn schema(channel: &ChannelInfo) -> PyResult<Schema> {
    let fail = |why: &dyn std::fmt::Display| error::file(format!("{}: {why}", channel.topic));
    if (channel.schema_encoding.as_str(), channel.message_encoding.as_str()) != ("ros2msg", "cdr") {
        let (schema, messages) = (&channel.schema_encoding, &channel.message_encoding);
        return Err(fail(&format!(
            "schema {schema:?} with messages {messages:?} cannot be decoded: ros2msg with cdr can"
        )));
    }
    Schema::parse(&channel.ros_type, &channel.definition).map_err(|e| fail(&e))
}

#[pyclass(module = "grainlab", frozen)]
pub(crate) struct MessageIterator(Mutex<Decoder>);

#[pymethods]
impl MessageIterator {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<(String, u64, Bound<'py, PyDict>)>> {
        let next = || self.0.lock().unwrap_or_else(PoisonError::into_inner).next();
        let Some((message, schema)) = py.detach(next)? else { return Ok(None) };
        let topic = message.channel.topic.clone();
        let fields = schema.decode(&message.payload).map_err(|e| error::file(format!("{topic}: {e}")))?;
        Ok(Some((topic, message.log_time, values::message(py, &fields)?)))
    }
}
