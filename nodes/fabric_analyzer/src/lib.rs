//! The analyzer node: turns packings into fabric and moduli.
