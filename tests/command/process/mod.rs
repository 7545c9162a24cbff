//! `rayreel` as a process among others: it is killed and sent signals, shares folders, meets devices and full disks, and prints
//! names that terminals would obey.

#[cfg(target_os = "linux")]
mod file_systems;
mod full;
mod inputs;
mod kills;
mod movies;
mod signals;
mod terminal;
