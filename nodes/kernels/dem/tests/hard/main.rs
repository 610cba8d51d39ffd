//! Hard cases, each with its expected outcome, and the traps that other codes fell into.

mod affine;
mod checkpoints;
mod few_grains;
mod history;
mod idle;
mod isostatic;
mod limits;
mod lists;
mod refusals;
mod sheared;
mod sizes;
mod targets;
mod time_step;
