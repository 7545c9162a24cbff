//! Files of other programs, against the values that independent readers have for them.
//!
//! `files/write.py` wrote the files, with ASE, GROMACS's library in MDAnalysis, LAMMPS, Open Babel, OVITO, NumPy and pandas, and then the
//! table `files/expected.tsv`, from readers of ASE, MDAnalysis, NumPy and pandas: file, frame, number of frames and of particles, a column,
//! and its values, in the shortest form of the same bits.

use std::path::Path;

use crate::texts;
use rayreel::trajectory::Trajectory;

#[test]
fn files_of_other_programs_are_read_to_the_last_digit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trajectory/files");
    let table = std::fs::read_to_string(folder.join("expected.tsv")).unwrap();
    let mut columns = 0;
    for row in table.lines().filter(|row| !row.starts_with('#')) {
        let [file, frame, frames, count, name, values] = row.split('\t').collect::<Vec<_>>()[..] else {
            panic!("{row}")
        };
        let trajectory = Trajectory::open(&folder.join(file), None).unwrap();
        let snapshot = trajectory.read(frame.parse().unwrap()).unwrap();
        assert_eq!(trajectory.frames().to_string(), frames, "{file}");
        assert_eq!(snapshot.count.to_string(), count, "{file}");
        let values: Vec<&str> = values.split(' ').collect();
        let found = match name {
            "cell" => {
                let cell = snapshot.cell.unwrap();
                cell.edges.iter().flat_map(glam::DVec3::to_array).map(|value| format!("{value:?}")).collect()
            }
            "bonds" => snapshot.bonds.iter().map(|[a, b]| format!("{a}-{b}")).collect(),
            "time" => vec![format!("{:?}", snapshot.time.unwrap())],
            name => texts(&snapshot, name),
        };
        assert_eq!(found, values, "{file}, frame {frame}, {name}");
        columns += 1;
    }
    assert!(columns > 60, "{columns}");
}
