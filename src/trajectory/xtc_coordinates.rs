//! Decoding of the coordinates in XTC files: whole multiples of the inverse precision, as differences between near atoms.
//!
//! ```text
//! atom:  position within the bounds, in as few bits as the bounds allow
//! flag:  1 bit; if set, 5 bits: 3 * (number of small atoms that follow) + (change of the small size: 0, 1, 2 for -1, 0, +1)
//! small: each in `small` bits, relative to the atom before; the first of them stands for the atom before `atom`, since the oxygen of
//!        a water molecule is nearest to both hydrogens
//! ```
//!
//! Without the flag, the number of small atoms is that of the group before (GROMACS, `src/gromacs/fileio/libxdrf.cpp`).

/// Compressed coordinates.
pub(super) struct CompressedCoordinates<'a> {
    /// Multiples of a nanometre.
    pub precision: f32,
    /// Smallest coordinates.
    pub low: [i32; 3],
    /// Largest coordinates.
    pub high: [i32; 3],
    /// Index of the first size of small differences, which is also their number of bits.
    pub small: u32,
    pub data: &'a [u8],
}

/// Sizes of small differences: three of them take as many bits as the index.
const SIZES: [u32; 73] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256, 322, 406,
    512, 645, 812, 1024, 1290, 1625, 2048, 2580, 3250, 4096, 5060, 6501, 8192, 10321, 13003, 16384, 20642,
    26007, 32768, 41285, 52015, 65536, 82570, 104_031, 131_072, 165_140, 208_063, 262_144, 330_280, 416_127,
    524_287, 660_561, 832_255, 1_048_576, 1_321_122, 1_664_510, 2_097_152, 2_642_245, 3_329_021, 4_194_304,
    5_284_491, 6_658_042, 8_388_607, 10_568_983, 13_316_085, 16_777_216,
];
/// Smallest index of a size.
const FIRST: usize = 9;
/// Largest size of bounds that are stored as one number.
const LARGEST: u32 = 0xff_ffff;

/// Reads bits, the highest of each byte first.
struct BitReader<'a> {
    data: &'a [u8],
    /// Bits that were taken from `data` and not read, in the low bits.
    bits: u64,
    count: u32,
}

/// An error of a code that ends early.
const ENDS_EARLY: &str = "they end early";

impl BitReader<'_> {
    /// Reads up to 32 bits.
    fn read(&mut self, count: u32) -> Result<u32, &'static str> {
        while self.count < count {
            let (first, rest) = self.data.split_first().ok_or(ENDS_EARLY)?;
            self.bits = self.bits << 8 | u64::from(*first);
            self.count += 8;
            self.data = rest;
        }
        self.count -= count;
        let value = self.bits >> self.count & ((1 << count) - 1);
        Ok(u32::try_from(value).unwrap_or(u32::MAX))
    }

    /// Reads three numbers below these sizes, which are stored as one number of so many bits, the lowest byte first.
    fn read_three(&mut self, mut bits: u32, sizes: [u32; 3]) -> Result<[i32; 3], &'static str> {
        let is_short = bits <= 64;
        let (mut value, mut shift) = (0_u128, 0);
        while bits > 8 {
            value |= u128::from(self.read(8)?) << shift;
            shift += 8;
            bits -= 8;
        }
        value |= u128::from(self.read(bits)?) << shift;
        let [_, y, z] = sizes;
        if y == 0 || z == 0 {
            return Err("a size is zero");
        }
        // Division of 64 bits is several times as fast as that of 128.
        let numbers = if is_short {
            let value = u64::try_from(value).unwrap_or(u64::MAX);
            let (y, z) = (u64::from(y), u64::from(z));
            [value / z / y, value / z % y, value % z].map(u128::from)
        } else {
            let (y, z) = (u128::from(y), u128::from(z));
            [value / z / y, value / z % y, value % z]
        };
        Ok(numbers.map(|number| i32::try_from(number).unwrap_or(i32::MAX)))
    }
}

/// Returns the number of bits of numbers below a size.
fn bits_of(size: u32) -> u32 {
    u32::BITS - size.leading_zeros()
}

/// Returns the number of bits of three numbers below these sizes, stored as one.
fn bits_of_three(sizes: [u32; 3]) -> u32 {
    let product = sizes.iter().map(|size| u128::from(*size)).product::<u128>();
    u128::BITS - product.leading_zeros()
}

/// Decodes the coordinates of as many atoms as the axes have elements.
pub(super) fn decode(
    compressed: &CompressedCoordinates<'_>,
    axes: &mut [Vec<f64>; 3],
) -> Result<(), &'static str> {
    let CompressedCoordinates { precision, low, high, small, data } = *compressed;
    if !(precision > 0.0 && precision.is_finite()) {
        return Err("their precision is not above 0");
    }
    // In 32 bits, as GROMACS computes.
    let unit = 1.0 / precision;
    let atoms = axes[0].len();
    let mut bounds = [0_u32; 3];
    for ((bound, low), high) in bounds.iter_mut().zip(low).zip(high) {
        *bound = high.wrapping_sub(low).cast_unsigned().wrapping_add(1);
    }
    let is_large = bounds.iter().any(|bound| *bound > LARGEST);
    let mut small = small as usize;
    let size_of = |small: usize| SIZES.get(small).copied().ok_or("a size is unknown");
    let half_of = |small: usize| size_of(small).map(|size| (size / 2).cast_signed());
    let mut smaller = half_of(small.saturating_sub(1).max(FIRST))?;
    let mut half = half_of(small)?;

    let [xs, ys, zs] = axes;
    let mut slots = xs.iter_mut().zip(ys).zip(zs);
    // Returns `false` once all atoms have coordinates.
    let mut put = |[x, y, z]: [i32; 3]| {
        #[allow(clippy::cast_precision_loss, reason = "in 32 bits, as GROMACS computes")]
        let length = |multiple: i32| f64::from(multiple as f32 * unit);
        let slot = slots.next();
        slot.map(|((to_x, to_y), to_z)| (*to_x, *to_y, *to_z) = (length(x), length(y), length(z))).is_some()
    };
    let add = |a: [i32; 3], b: [i32; 3]| std::array::from_fn(|axis| a[axis].wrapping_add(b[axis]));
    let mut reader = BitReader { data, bits: 0, count: 0 };
    let mut run = 0;
    let mut left = atoms;
    while left > 0 {
        let offset = if is_large {
            let mut offset = [0; 3];
            for (offset, bound) in offset.iter_mut().zip(bounds) {
                *offset = reader.read(bits_of(bound))?.cast_signed();
            }
            offset
        } else {
            reader.read_three(bits_of_three(bounds), bounds)?
        };
        let mut before = add(offset, low);
        let mut change = 1;
        if reader.read(1)? == 1 {
            let code = reader.read(5)?;
            change = code % 3;
            run = code / 3;
        }
        // The number of atoms ends the last group, even if that states more.
        left = left.saturating_sub(1 + run as usize);
        if run == 0 {
            put(before);
        }
        let sizes = [size_of(small)?; 3];
        for index in 0..run {
            let bits = u32::try_from(small).unwrap_or(0);
            let difference = reader.read_three(bits, sizes)?.map(|value| value.wrapping_sub(half));
            let atom = add(before, difference);
            if index == 0 {
                put(atom);
                if !put(before) {
                    break;
                }
                before = atom;
            } else {
                before = atom;
                if !put(atom) {
                    break;
                }
            }
        }
        match change {
            0 => {
                small = small.checked_sub(1).ok_or("a size is unknown")?;
                half = smaller;
                smaller = if small > FIRST { half_of(small - 1)? } else { 0 };
            }
            2 => {
                small += 1;
                smaller = half;
                half = half_of(small)?;
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_read_across_bytes() {
        let mut reader = BitReader { data: &[0b1010_0110, 0b1111_0000, 0xff], bits: 0, count: 0 };
        assert_eq!(
            [3, 7, 1, 5].map(|count| reader.read(count)),
            [Ok(0b101), Ok(0b001_1011), Ok(1), Ok(0b10000)]
        );
        assert_eq!((reader.read(8), reader.read(1)), (Ok(0xff), Err(ENDS_EARLY)));
    }

    #[test]
    fn damaged_codes_end_with_an_error() {
        let ones = [0xff; 64];
        for (small, high, precision) in [
            (0, [9; 3], 1000.0),
            (72, [9; 3], 1000.0),
            (73, [9; 3], 1000.0),
            (9, [i32::MAX; 3], 1000.0),
            (9, [9; 3], 0.0),
        ] {
            let compressed = CompressedCoordinates { precision, low: [-5; 3], high, small, data: &ones };
            let mut axes = [vec![0.0; 500], vec![0.0; 500], vec![0.0; 500]];
            assert!(decode(&compressed, &mut axes).is_err(), "{small}");
        }
    }
}
