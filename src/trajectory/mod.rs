//! Files of particles, read frame by frame.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::DVec3;

/// The format of a file of particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values with a header.
    Csv,
}

/// An error in a file of particles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrajectoryError(String);

impl fmt::Display for TrajectoryError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for TrajectoryError {}

/// A file of particles: an index of its frames, which are read on demand.
#[derive(Debug)]
pub struct Trajectory {
    path: PathBuf,
    frames: usize,
}

/// The particles of one frame, in columns of equal length.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// The number of particles.
    pub count: usize,
    /// The columns.
    pub columns: Vec<Column>,
    /// The periodic cell.
    pub cell: Option<Cell>,
    /// Pairs of particles, by index.
    pub bonds: Vec<[u32; 2]>,
    /// The time that the file states for this frame, in the file's unit.
    pub time: Option<f64>,
}

/// A column.
#[derive(Clone, Debug)]
pub struct Column {
    /// The name.
    pub name: String,
    /// The values.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug)]
pub enum Values {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Labels, as indices of names.
    Labels {
        /// The index of each particle's label.
        labels: Vec<u32>,
        /// The names.
        names: Vec<String>,
    },
}

/// A periodic cell: three edges from an origin.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// The origin.
    pub origin: DVec3,
    /// The edges.
    pub edges: [DVec3; 3],
    /// The directions in which the cell repeats.
    pub periodic: [bool; 3],
}

impl Trajectory {
    /// Opens a file and finds its frames.
    pub fn open(path: &Path, _format: Option<Format>) -> Result<Self, TrajectoryError> {
        let frames = texts(path)?.len();
        Ok(Self { path: path.to_owned(), frames })
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the number of frames.
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Reads a frame.
    pub fn read(&self, frame: usize) -> Result<Snapshot, TrajectoryError> {
        let text = texts(&self.path)?.swap_remove(frame);
        let (header, rows) = text.split_once('\n').unwrap_or((&text, ""));
        let mut cell = None;
        let names: Vec<String> = match header.split_once("Properties=") {
            Some((before, properties)) => {
                if let Some(lattice) = before.split('"').nth(1) {
                    let edges: Vec<f64> = lattice.split(' ').filter_map(|edge| edge.parse().ok()).collect();
                    let edges = [0, 3, 6].map(|at| DVec3::new(edges[at], edges[at + 1], edges[at + 2]));
                    cell = Some(Cell { origin: DVec3::ZERO, edges, periodic: [true; 3] });
                }
                let parts: Vec<&str> =
                    properties.split_whitespace().next().unwrap_or_default().split(':').collect();
                let names = parts.chunks(3).flat_map(|part| match part[0] {
                    "species" => vec!["element".to_owned()],
                    "pos" => ["x", "y", "z"].map(str::to_owned).to_vec(),
                    name => vec![name.to_owned()],
                });
                names.collect()
            }
            None => header.split(',').map(str::to_owned).collect(),
        };
        let is_break = |letter: char| letter == ',' || letter == ' ';
        let rows: Vec<Vec<&str>> = rows.lines().map(|line| line.split(is_break).collect()).collect();
        let columns = names.iter().enumerate().map(|(at, name)| {
            let numbers: Option<Vec<f64>> = rows.iter().map(|row| row.get(at)?.parse().ok()).collect();
            let values = numbers.map_or_else(
                || {
                    let mut names: Vec<String> = Vec::new();
                    let labels = rows.iter().map(|row| {
                        let name = row.get(at).copied().unwrap_or_default();
                        let known = names.iter().position(|known| known == name);
                        let known = known.unwrap_or_else(|| {
                            names.push(name.to_owned());
                            names.len() - 1
                        });
                        u32::try_from(known).unwrap_or(0)
                    });
                    let labels = labels.collect();
                    Values::Labels { labels, names }
                },
                Values::Numbers,
            );
            Column { name: name.clone(), values }
        });
        let columns = columns.collect();
        Ok(Snapshot { count: rows.len(), columns, cell, ..Snapshot::default() })
    }
}

fn texts(path: &Path) -> Result<Vec<String>, TrajectoryError> {
    let text = read(path)?;
    if path.extension().is_some_and(|extension| extension == "csv") {
        return Ok(vec![text]);
    }
    let mut lines = text.lines();
    let mut frames = Vec::new();
    while let Some(count) = lines.next().and_then(|line| line.trim().parse::<usize>().ok()) {
        let frame: Vec<&str> = lines.by_ref().take(count + 1).collect();
        frames.push(frame.join("\n"));
    }
    Ok(frames)
}

fn read(path: &Path) -> Result<String, TrajectoryError> {
    std::fs::read_to_string(path).map_err(|error| TrajectoryError(format!("{}: {error}", path.display())))
}

impl Snapshot {
    /// Returns the columns of the coordinates.
    pub fn positions(&self) -> Result<[&[f64]; 3], TrajectoryError> {
        let axis = |name: &str| match self.column(name) {
            Some(Values::Numbers(axis)) => Ok(axis.as_slice()),
            _ => Err(TrajectoryError(format!("there is no column {name}"))),
        };
        Ok([axis("x")?, axis("y")?, axis("z")?])
    }

    /// Returns a column.
    pub fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }
}
