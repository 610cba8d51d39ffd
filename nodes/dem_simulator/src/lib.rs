//! The simulator node: owns the run, publishes stress and packings, obeys strain rates.
