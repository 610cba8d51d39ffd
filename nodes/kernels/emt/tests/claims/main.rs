//! What the crate claims, one file a subject.

mod faults;
mod inversion;
mod propagation;
mod quadrature;
mod table3;
