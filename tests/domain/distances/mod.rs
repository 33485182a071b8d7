//! The distance metrics: against brute force, against numbers worked out elsewhere, and at the edges.

mod brute_force;
mod edges;
mod fixture;
mod golden;
mod golden_values;
mod kinematics;
mod large_scene;
mod scenes;
mod siap;
mod t_gospa;
mod volumes;
mod wholes;
