//! Keys of the metadata records.

/// Name of the metadata record of the laboratory: the caller's keys, and [`LEDGER_KEY`].
pub const METADATA_RECORD: &str = "grainlab";

/// Name of the metadata record of a copy: how it was made, and from which recordings.
pub const COPY_RECORD: &str = "grainlab_copy";

/// Key of the ledger, as JSON, in the metadata record [`METADATA_RECORD`].
pub const LEDGER_KEY: &str = "ledger";

/// Key of the recorder's session in the metadata record [`METADATA_RECORD`]. The ledger of the last file of a session
/// covers its earlier files, too.
pub const SESSION_KEY: &str = "session";

/// Key in [`METADATA_RECORD`] of a recovered file: the parts that could not be read, as a JSON list of warnings.
pub(crate) const RECOVERED_KEY: &str = "recovered_without";

/// Key in the metadata record [`METADATA_RECORD`] of a file whose recorder had to end, as on a full disk: the reason.
pub(crate) const ENDED_BY_KEY: &str = "ended_by";
