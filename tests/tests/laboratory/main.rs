//! Claims about the whole laboratory, in one binary: each module is what a user does, or what happens meanwhile.

mod acoustic;
mod bad_input;
mod bag_tools;
mod campaigns;
mod crashes;
mod disturbed;
mod exports;
mod graph;
mod hosts;
mod lammps;
mod launch;
mod other_dds;
mod pages;
mod paper;
mod python;
mod replay;
mod resume;
mod ros_launch;
mod strangers;
mod tables;
