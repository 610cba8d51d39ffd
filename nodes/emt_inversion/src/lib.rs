//! The inversion node: turns moduli into microstructure.
