//! Simple writers of all formats.

use rayreel::trajectory::Format;

/// Particles that are written: coordinates and a label of each.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) labels: Vec<String>,
}

/// Writes frames as text with the separator between fields.
pub(crate) fn csv(frame: &Frame, separator: char, end: &str) -> Vec<u8> {
    let mut text = format!("x{separator}\"label\"{separator}y{separator}z{end}");
    for ([x, y, z], label) in frame.positions.iter().zip(&frame.labels) {
        let label = label.replace('"', "\"\"");
        text.push_str(&format!("{x:?}{separator}\"{label}\"{separator}{y:e}{separator}{z}{end}"));
    }
    text.into_bytes()
}

pub(crate) fn xyz(frames: &[Frame], end: &str) -> Vec<u8> {
    let mut text = String::new();
    for (index, frame) in frames.iter().enumerate() {
        let count = frame.positions.len();
        let keys = "Lattice=\"3 0 0 1 4 0 0 0 5\" Properties=species:S:1:pos:R:3:q:R:2";
        text.push_str(&format!("{count}{end}{keys} Time={index}.5{end}"));
        for ([x, y, z], label) in frame.positions.iter().zip(&frame.labels) {
            text.push_str(&format!("{label} {x:?}\t{y:e}  {z} {y} {x}{end}"));
        }
    }
    text.into_bytes()
}

pub(crate) fn dump(frames: &[Frame], end: &str) -> Vec<u8> {
    let mut text = String::new();
    for (index, frame) in frames.iter().enumerate() {
        let count = frame.positions.len();
        text.push_str(&format!("ITEM: TIMESTEP{end}{index}{end}ITEM: NUMBER OF ATOMS{end}{count}{end}"));
        text.push_str(&format!("ITEM: BOX BOUNDS xy xz yz pp pp ff{end}0 5 1{end}0 4 0{end}-1 1 0{end}"));
        text.push_str(&format!("ITEM: ATOMS id element x y z{end}"));
        for (id, ([x, y, z], label)) in frame.positions.iter().zip(&frame.labels).enumerate() {
            text.push_str(&format!("{id} {label} {x:?} {y:e} {z}{end}"));
        }
    }
    text.into_bytes()
}

/// Writes positions with three decimals.
pub(crate) fn pdb(frames: &[Frame]) -> Vec<u8> {
    let mut text = "CRYST1   10.000   20.000   30.000  90.00  90.00 120.00 P 1           1\n".to_owned();
    for (index, frame) in (1..).zip(frames) {
        text.push_str(&format!("MODEL     {index:4}\n"));
        for (serial, [x, y, z]) in (1..).zip(&frame.positions) {
            text.push_str(&format!(
                "ATOM  {serial:5}  CA AALA A{:4}    {x:8.3}{y:8.3}{z:8.3}  1.00  0.00           C\n",
                serial % 10_000
            ));
        }
        text.push_str("ENDMDL\n");
    }
    text.push_str("CONECT    1    2\nEND\n");
    text.into_bytes()
}

/// Writes an array; `item` returns the bytes of a number.
pub(crate) fn npy(
    descr: &str,
    fortran: bool,
    shape: &[usize],
    values: &[f64],
    item: impl Fn(f64) -> Vec<u8>,
) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({},), }}\n", shape.join(", "));
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).unwrap().to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.iter().flat_map(|value| item(*value)));
    bytes
}

/// Returns the numbers of frames in the order of `(frames, particles, 3)`.
pub(crate) fn flat(frames: &[Frame]) -> Vec<f64> {
    frames.iter().flat_map(|frame| frame.positions.iter().flatten().copied()).collect()
}

/// Writes stored members into a ZIP file.
pub(crate) fn zip(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, data) in members {
        let start = u32::try_from(bytes.len()).unwrap();
        let length = u32::try_from(data.len()).unwrap().to_le_bytes();
        let mut fields = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        fields.extend(length);
        fields.extend(length);
        fields.extend(u16::try_from(name.len()).unwrap().to_le_bytes());
        fields.extend([0, 0]);
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&fields);
        bytes.extend(name.as_bytes());
        bytes.extend(data);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&fields);
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let count = u16::try_from(members.len()).unwrap().to_le_bytes();
    let (start, size) = (u32::try_from(bytes.len()).unwrap(), u32::try_from(directory.len()).unwrap());
    bytes.extend(directory);
    bytes.extend(b"PK\x05\x06\x00\x00\x00\x00");
    bytes.extend(count);
    bytes.extend(count);
    bytes.extend(size.to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0, 0]);
    bytes
}

/// Writes bits, the highest first.
#[derive(Default)]
struct BitWriter {
    bytes: Vec<u8>,
    free: u32,
}

impl BitWriter {
    fn put(&mut self, value: u128, count: u32) {
        for bit in (0..count).rev() {
            if self.free == 0 {
                self.bytes.push(0);
                self.free = 8;
            }
            self.free -= 1;
            *self.bytes.last_mut().unwrap() |= u8::from(value >> bit & 1 == 1) << self.free;
        }
    }
}

/// Writes multiples of 0.001 without small differences: the longest form of the format.
pub(crate) fn xtc(frames: &[Vec<[i32; 3]>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (step, frame) in (0..).zip(frames) {
        let count = i32::try_from(frame.len()).unwrap();
        for word in [1995, count, step] {
            bytes.extend(word.to_be_bytes());
        }
        #[allow(clippy::cast_precision_loss, reason = "small numbers")]
        bytes.extend((step as f32 / 4.0).to_be_bytes());
        for edge in [3.0_f32, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 5.0] {
            bytes.extend(edge.to_be_bytes());
        }
        bytes.extend(count.to_be_bytes());
        if frame.len() <= 9 {
            #[allow(clippy::cast_precision_loss, reason = "small numbers")]
            frame
                .iter()
                .flatten()
                .for_each(|value| bytes.extend((*value as f32 * (1.0 / 1000.0)).to_be_bytes()));
            continue;
        }
        let low: [i32; 3] = std::array::from_fn(|axis| frame.iter().map(|atom| atom[axis]).min().unwrap());
        let high: [i32; 3] = std::array::from_fn(|axis| frame.iter().map(|atom| atom[axis]).max().unwrap());
        let sizes: [u32; 3] =
            std::array::from_fn(|axis| high[axis].wrapping_sub(low[axis]).cast_unsigned() + 1);
        let mut bits = BitWriter::default();
        for atom in frame {
            let offset: [u32; 3] =
                std::array::from_fn(|axis| atom[axis].wrapping_sub(low[axis]).cast_unsigned());
            if sizes.iter().any(|size| *size > 0xff_ffff) {
                for (offset, size) in offset.iter().zip(sizes) {
                    bits.put(u128::from(*offset), 32 - size.leading_zeros());
                }
            } else {
                let [x, y, z] = offset.map(u128::from);
                let value = (x * u128::from(sizes[1]) + y) * u128::from(sizes[2]) + z;
                let mut left =
                    128 - sizes.iter().map(|size| u128::from(*size)).product::<u128>().leading_zeros();
                let mut rest = value;
                while left > 8 {
                    bits.put(rest & 0xff, 8);
                    rest >>= 8;
                    left -= 8;
                }
                bits.put(rest, left);
            }
            bits.put(0, 1);
        }
        bytes.extend(1000.0_f32.to_be_bytes());
        low.iter().chain(&high).for_each(|word| bytes.extend(word.to_be_bytes()));
        bytes.extend(9_u32.to_be_bytes());
        bytes.extend(u32::try_from(bits.bytes.len()).unwrap().to_be_bytes());
        bits.bytes.resize(bits.bytes.len().next_multiple_of(4), 0);
        bytes.extend(bits.bytes);
    }
    bytes
}

/// Returns an example of each format, with the name of its file.
pub(crate) fn examples() -> Vec<(&'static str, Vec<u8>)> {
    let frame = |offset: f64| Frame {
        positions: (0..12).map(|index| f64::from(index) / 7.0 + offset).map(|x| [x, -x, 2.0 * x]).collect(),
        labels: (0..12).map(|index| ["Na", "Cl", "O"][index % 3].to_owned()).collect(),
    };
    let frames = [frame(0.0), frame(1.0), frame(2.0)];
    let doubles = |value: f64| value.to_le_bytes().to_vec();
    let positions = npy("<f8", false, &[3, 12, 3], &flat(&frames), doubles);
    let multiples: Vec<Vec<[i32; 3]>> = (0..3)
        .map(|frame| (0..12).map(|atom| [atom * 100, frame * 7 - atom, atom * atom]).collect())
        .collect();
    let examples = vec![
        ("a.csv", csv(&frames[0], ',', "\n")),
        ("a.tsv", csv(&frames[0], '\t', "\r\n")),
        ("a.xyz", xyz(&frames, "\n")),
        ("a.dump", dump(&frames, "\n")),
        ("a.pdb", pdb(&frames)),
        ("a.npy", positions.clone()),
        (
            "a.npz",
            zip(&[
                ("positions.npy", positions),
                ("time.npy", npy("<f8", false, &[3], &[0.0, 1.0, 2.0], doubles)),
            ]),
        ),
        ("a.xtc", xtc(&multiples)),
    ];
    for (name, _) in &examples {
        assert!(Format::of_name(std::path::Path::new(name)).is_some());
    }
    examples
}
