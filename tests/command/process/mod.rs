//! `rayreel` as a process among others: it is killed and sent signals, shares folders, meets devices and full disks, and prints
//! names that terminals would obey.

mod full;
mod inputs;
mod kills;
mod signals;
mod terminal;
