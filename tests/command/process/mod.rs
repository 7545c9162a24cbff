//! Tests of `rayreel` as a process: kills and signals, shared folders, devices and full disks, and names with terminal control sequences.

#[cfg(target_os = "linux")]
mod file_systems;
mod full;
mod inputs;
mod kills;
mod movies;
mod signals;
mod terminal;
