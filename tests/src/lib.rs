//! Tests of the whole laboratory: real processes, recordings, interoperation, physics.
