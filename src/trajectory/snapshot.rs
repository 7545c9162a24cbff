//! The particles of one frame.

use glam::DVec3;

/// The particles of one frame, in columns of equal length.
///
/// Numbers are the correctly rounded 64-bit values of the file's text; whole numbers above 2^53 are rounded, too. Missing numbers are NaN.
/// Lengths and times are in the file's units: ångström in PDB files, nanometres and picoseconds in XTC files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Number of particles.
    pub count: usize,
    /// Columns, in file order. The names `x`, `y`, `z` (Cartesian coordinates), `vx`, `vy`, `vz`, `id`, `type`, `element`, `name`,
    /// `residue` and `chain` have the same meaning in all formats; other names are those of the file.
    pub columns: Vec<Column>,
    /// Cell, if the file has one.
    pub cell: Option<Cell>,
    /// Pairs of particles that are bonded, by index (PDB CONECT), each pair once, with the smaller index first.
    pub bonds: Vec<[u32; 2]>,
    /// Time of the frame in the file's unit; the timestep in LAMMPS dumps that have no time.
    pub time: Option<f64>,
}

/// A value for each particle.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Values.
    pub values: Values,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers. Logical values are 0 and 1.
    Numbers(Vec<f64>),
    /// Texts.
    Labels {
        /// Indices into `names`, one for each particle.
        labels: Vec<u32>,
        /// The different texts, in the order of their first use.
        names: Vec<String>,
    },
}

/// A periodic cell: three edges from an origin.
///
/// Edges of directions that are not periodic may be zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Corner from which the edges start.
    pub origin: DVec3,
    /// Edges.
    pub edges: [DVec3; 3],
    /// Periodicity along each edge.
    pub periodic: [bool; 3],
}

/// A column that a frame lacks, or whose values are of another kind.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("{cause}; the columns are {}", list(.columns))]
pub struct ColumnError {
    cause: String,
    columns: Vec<String>,
}

debug_as_message!(ColumnError);

/// Returns names as a list of limited length.
fn list(names: &[String]) -> String {
    const MOST: usize = 20;
    let mut text = names.iter().take(MOST).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    if names.len() > MOST {
        text.push_str(&format!(" and {} more", names.len() - MOST));
    }
    if names.is_empty() { "none".to_owned() } else { text }
}

impl Snapshot {
    /// Returns the values of the first column of this name, which is case-sensitive.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Values> {
        self.columns.iter().find(|column| column.name == name).map(|column| &column.values)
    }

    /// Returns the numbers of a column.
    ///
    /// # Errors
    ///
    /// Returns an error if there is no such column, or if it holds labels.
    pub fn numbers(&self, name: &str) -> Result<&[f64], ColumnError> {
        let cause = match self.column(name) {
            Some(Values::Numbers(numbers)) => return Ok(numbers),
            Some(Values::Labels { .. }) => format!("column `{name}` holds texts, expected numbers"),
            None => format!("there is no column `{name}`"),
        };
        Err(ColumnError { cause, columns: self.columns.iter().map(|column| column.name.clone()).collect() })
    }

    /// Returns the columns `x`, `y` and `z`.
    ///
    /// # Errors
    ///
    /// Returns an error if one of them is missing or holds labels.
    pub fn positions(&self) -> Result<[&[f64]; 3], ColumnError> {
        Ok([self.numbers("x")?, self.numbers("y")?, self.numbers("z")?])
    }

    /// Adds a column.
    pub(super) fn push(&mut self, name: impl Into<String>, values: Values) {
        self.columns.push(Column { name: name.into(), values });
    }
}

impl Values {
    /// Returns the number of values.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Labels { labels, .. } => labels.len(),
        }
    }

    /// Returns `true` if there are no values.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Cell {
    /// Returns the cell of edge lengths and angles in degrees: the first edge along x, the second in the plane of x and y. `None` if there
    /// is no such cell.
    #[must_use]
    pub fn from_lengths_and_angles(lengths: [f64; 3], angles: [f64; 3]) -> Option<Self> {
        // A right angle is exact, and so are the cells that have no other.
        let cosine = |angle: f64| if angle == 90.0 { 0.0 } else { libm::cos(angle.to_radians()) };
        let [a, b, c] = lengths;
        let [alpha, beta, gamma] = angles.map(cosine);
        let sine = if angles[2] == 90.0 { 1.0 } else { libm::sin(angles[2].to_radians()) };
        let y = (alpha - beta * gamma) / sine;
        let z = (1.0 - beta * beta - y * y).sqrt();
        let edges = [
            DVec3::new(a, 0.0, 0.0),
            DVec3::new(b * gamma, b * sine, 0.0),
            DVec3::new(c * beta, c * y, c * z),
        ];
        let cell = Self { origin: DVec3::ZERO, edges, periodic: [true; 3] };
        let is_cell = lengths.iter().all(|length| *length > 0.0)
            && angles.iter().all(|angle| *angle > 0.0 && *angle < 180.0)
            && cell.is_valid();
        is_cell.then_some(cell)
    }

    /// Returns `true` if all edges are finite, and those of the periodic directions are independent.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let finite = self.origin.is_finite() && self.edges.iter().all(|edge| edge.is_finite());
        let directions = self.edges.iter().zip(self.periodic).filter(|(_, periodic)| *periodic);
        let directions: Vec<DVec3> = directions.map(|(edge, _)| edge.normalize_or_zero()).collect();
        // Rounding of parallel unit vectors is below this; no cell is this flat.
        const FLAT: f64 = 1e-9;
        let independent = match directions[..] {
            [] => true,
            [a] => a != DVec3::ZERO,
            [a, b] => a.cross(b).length() > FLAT,
            [a, b, c, ..] => a.cross(b).dot(c).abs() > FLAT,
        };
        finite && independent
    }

    /// Returns the position of fractions of the edges.
    pub(super) fn position(&self, fractions: DVec3) -> DVec3 {
        let [a, b, c] = self.edges;
        self.origin + a * fractions.x + b * fractions.y + c * fractions.z
    }
}
