//! Random particles, written by simple writers and read back with the same bits.

use glam::DVec3;
use proptest::prelude::*;

use crate::writers::{Frame, csv, dump, flat, npy, pdb, xtc, xyz};
use crate::{open, texts};
use rayreel::trajectory::Snapshot;

/// Returns any finite number, subnormal ones included.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![any::<f64>().prop_filter("finite", |number| number.is_finite()), -1e3..1e3, Just(-0.0)]
}

fn frames(label: &'static str) -> impl Strategy<Value = Vec<Frame>> {
    let particle = ([number(), number(), number()], label);
    let frame = prop::collection::vec(particle, 1..40).prop_map(|particles| {
        let (positions, labels) = particles.into_iter().unzip();
        Frame { positions, labels }
    });
    prop::collection::vec(frame, 1..5)
}

/// Checks positions to the last bit.
fn check(snapshot: &Snapshot, positions: &[[f64; 3]]) {
    assert_eq!(snapshot.count, positions.len());
    for (axis, column) in snapshot.positions().unwrap().into_iter().enumerate() {
        let bits: Vec<u64> = column.iter().map(|value| value.to_bits()).collect();
        let expected: Vec<u64> = positions.iter().map(|position| position[axis].to_bits()).collect();
        assert_eq!(bits, expected);
    }
}

proptest! {
    #[test]
    fn csv_files_hold_what_was_written(
        frames in frames("[p-s][ -~]{0,8}"),
        separator in prop::sample::select(&[',', ';', '\t'][..]),
        end in prop::sample::select(&["\n", "\r\n", "\n\n"][..]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let snapshot = open(folder.path(), "a.csv", &csv(&frames[0], separator, end)).unwrap().read(0).unwrap();
        check(&snapshot, &frames[0].positions);
        prop_assert_eq!(texts(&snapshot, "label"), frames[0].labels.clone());
    }

    #[test]
    fn frames_of_text_hold_what_was_written(
        frames in frames("[A-Z][a-z]{3,5}"),
        end in prop::sample::select(&["\n", "\r\n"][..]),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in [("a.extxyz", xyz(&frames, end)), ("a.lammpstrj", dump(&frames, end))] {
            let trajectory = open(folder.path(), name, &bytes).unwrap();
            prop_assert_eq!(trajectory.frames(), frames.len());
            prop_assert_eq!(trajectory.warnings().len(), 0);
            // From the last to the first: no frame depends on another.
            for (index, frame) in frames.iter().enumerate().rev() {
                let snapshot = trajectory.read(index).unwrap();
                check(&snapshot, &frame.positions);
                prop_assert_eq!(texts(&snapshot, "element"), frame.labels.clone());
                prop_assert_eq!(snapshot.cell.unwrap().edges[1], DVec3::new(1.0, 4.0, 0.0));
            }
        }
    }

    #[test]
    fn arrays_hold_what_was_written(frames in frames("x"), fortran in any::<bool>(), big in any::<bool>(), single in any::<bool>()) {
        let (count, particles) = (frames.len(), frames[0].positions.len());
        let mut frames = frames;
        frames.iter_mut().for_each(|frame| frame.positions.resize(particles, [0.5; 3]));
        let values = flat(&frames);
        let mut written = values.clone();
        if fortran {
            for (index, value) in values.iter().enumerate() {
                let (frame, particle, axis) = (index / particles / 3, index / 3 % particles, index % 3);
                written[frame + count * (particle + particles * axis)] = *value;
            }
        }
        #[allow(clippy::cast_possible_truncation, reason = "numbers are rounded as written")]
        let item = |value: f64| match (single, big) {
            (true, true) => (value as f32).to_be_bytes().to_vec(),
            (true, false) => (value as f32).to_le_bytes().to_vec(),
            (false, true) => value.to_be_bytes().to_vec(),
            (false, false) => value.to_le_bytes().to_vec(),
        };
        let descr = format!("{}f{}", if big { '>' } else { '<' }, if single { 4 } else { 8 });
        let folder = tempfile::tempdir().unwrap();
        let bytes = npy(&descr, fortran, &[count, particles, 3], &written, item);
        let trajectory = open(folder.path(), "a.npy", &bytes).unwrap();
        prop_assert_eq!(trajectory.frames(), count);
        for (index, frame) in frames.iter().enumerate() {
            #[allow(clippy::cast_possible_truncation, reason = "numbers are rounded as written")]
            let round = |value: f64| if single { f64::from(value as f32) } else { value };
            let positions: Vec<[f64; 3]> = frame.positions.iter().map(|position| position.map(round)).collect();
            check(&trajectory.read(index).unwrap(), &positions);
        }
    }

    #[test]
    fn records_hold_three_decimals(positions in prop::collection::vec(prop::array::uniform3(-999_999_i32..999_999), 1..30)) {
        let positions: Vec<[f64; 3]> = positions.iter().map(|position| position.map(|value| f64::from(value) / 1000.0)).collect();
        let labels = vec![String::new(); positions.len()];
        let folder = tempfile::tempdir().unwrap();
        // The alternate location of each residue's atom is the only one.
        let snapshot = open(folder.path(), "a.pdb", &pdb(&[Frame { positions: positions.clone(), labels }])).unwrap().read(0).unwrap();
        check(&snapshot, &positions);
        prop_assert_eq!(snapshot.bonds.len(), usize::from(positions.len() > 1));
    }

    #[test]
    fn compressed_coordinates_hold_what_was_written(
        frames in prop::collection::vec(prop::collection::vec(prop::array::uniform3(any::<i16>()), 1..40), 1..4),
        // Bounds that are stored as one number of up to 64 and of more bits, and as three.
        scale in prop::sample::select(&[[1, 1, 1], [0, 1, 3], [100, 100, 100], [500, 1, 0], [65_000, 1, 40_000]][..]),
    ) {
        let scaled = |atom: &[i16; 3]| std::array::from_fn(|axis| i32::from(atom[axis]) * scale[axis]);
        let frames: Vec<Vec<[i32; 3]>> = frames.iter().map(|frame| frame.iter().map(scaled).collect()).collect();
        let folder = tempfile::tempdir().unwrap();
        let trajectory = open(folder.path(), "a.xtc", &xtc(&frames)).unwrap();
        prop_assert_eq!(trajectory.frames(), frames.len());
        for (index, frame) in frames.iter().enumerate().rev() {
            #[allow(clippy::cast_precision_loss, reason = "in 32 bits, as the format")]
            let positions: Vec<[f64; 3]> = frame.iter().map(|atom| atom.map(|value| f64::from(value as f32 * (1.0 / 1000.0)))).collect();
            check(&trajectory.read(index).unwrap(), &positions);
        }
    }

    #[test]
    fn numbers_are_rounded_correctly(text in "[+-]?[0-9]{1,30}(\\.[0-9]{0,40})?([eE][+-]?[0-9]{1,3})?") {
        let folder = tempfile::tempdir().unwrap();
        let snapshot = open(folder.path(), "a.csv", format!("x,y\n{text},1\n").as_bytes()).unwrap().read(0).unwrap();
        let expected: f64 = text.parse().unwrap();
        prop_assert_eq!(snapshot.numbers("x").unwrap()[0].to_bits(), expected.to_bits());
        let fortran = text.replace(['e', 'E'], "D");
        let snapshot = open(folder.path(), "a.csv", format!("x,y\n{fortran},1\n").as_bytes()).unwrap().read(0).unwrap();
        prop_assert_eq!(snapshot.numbers("x").unwrap()[0].to_bits(), expected.to_bits());
    }
}
