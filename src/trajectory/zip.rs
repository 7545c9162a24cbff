//! Members of ZIP files, as NumPy writes them: stored or deflated, without encryption.

use super::data_file::DataFile;
use super::decompress;
use super::error::{DataPlace, Faults};

/// Largest number of members that is read.
const MOST_MEMBERS: u64 = 10_000;

/// A file in a ZIP file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ZipMember {
    pub name: String,
    /// `true` for deflated data, `false` for stored data.
    pub is_deflated: bool,
    /// Bytes of the data in the file.
    pub compressed: u64,
    /// Bytes of the data when decompressed.
    pub length: u64,
    /// Position of the data.
    pub start: u64,
}

fn damaged(position: u64, cause: impl Into<String>) -> Faults {
    Faults::one(DataPlace::Byte(position), cause, "copy the file again, or write it with `numpy.savez`")
}

/// Returns the little-endian number of so many bytes at a position.
fn number(bytes: &[u8], position: usize, length: usize) -> Option<u64> {
    let bytes = bytes.get(position..)?.get(..length)?;
    Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

/// Returns the members of a file, from the directory at its end.
pub(super) fn members(file: &DataFile) -> Result<Vec<ZipMember>, Faults> {
    /// The directory's end: 22 bytes, and a comment of at most 65 535.
    const LONGEST_END: u64 = 22 + 65_535;
    let tail_start = file.length().saturating_sub(LONGEST_END);
    let tail = file.read(tail_start..file.length())?;
    let Some(end) = memchr::memmem::rfind(&tail, b"PK\x05\x06") else {
        return Err(damaged(0, "this is no archive of NumPy, or it is truncated: it has no directory"));
    };
    let field = |position, length| number(&tail, end + position, length);
    let lost = || damaged(tail_start + end as u64, "its directory is damaged");
    let (Some(mut count), Some(mut size), Some(mut start)) = (field(10, 2), field(12, 4), field(16, 4))
    else {
        return Err(lost());
    };
    // Files of more than 4 GiB have a second end of the directory, with wider numbers (ZIP64).
    if start == 0xffff_ffff || size == 0xffff_ffff || count == 0xffff {
        let wide = memchr::memmem::rfind(&tail[..end], b"PK\x06\x06");
        let wide =
            wide.map(|wide| [(32, 8), (40, 8), (48, 8)].map(|(at, length)| number(&tail, wide + at, length)));
        let Some([Some(wide_count), Some(wide_size), Some(wide_start)]) = wide else { return Err(lost()) };
        (count, size, start) = (wide_count, wide_size, wide_start);
    }
    let stop = start.checked_add(size).filter(|stop| *stop <= file.length()).ok_or_else(lost)?;
    if count > MOST_MEMBERS {
        return Err(damaged(start, format!("it has {count} arrays, at most {MOST_MEMBERS} are read")));
    }
    let directory = file.read(start..stop)?;
    let mut position = 0;
    let mut members = Vec::new();
    for _ in 0..count {
        let (member, next) = entry(file, &directory, position)
            .ok_or_else(|| damaged(start + position as u64, "an entry of its directory is damaged"))??;
        members.push(member);
        position = next;
    }
    Ok(members)
}

/// Reads an entry of the directory. Returns it and the position of the next one.
fn entry(file: &DataFile, directory: &[u8], at: usize) -> Option<Result<(ZipMember, usize), Faults>> {
    let field = |position, length| number(directory, at + position, length);
    if directory.get(at..at + 4)? != b"PK\x01\x02" {
        return None;
    }
    let (flags, method) = (field(8, 2)?, field(10, 2)?);
    let (mut compressed, mut length, mut local) = (field(20, 4)?, field(24, 4)?, field(42, 4)?);
    let lengths =
        [field(28, 2)?, field(30, 2)?, field(32, 2)?].map(|length| usize::try_from(length).unwrap_or(0));
    let name = directory.get(at + 46..)?.get(..lengths[0])?;
    let name = String::from_utf8_lossy(name).into_owned();
    let extra = directory.get(at + 46 + lengths[0]..)?.get(..lengths[1])?;
    wide_numbers(extra, [&mut length, &mut compressed, &mut local]);
    let next = at + 46 + lengths.iter().sum::<usize>();
    if flags & 1 == 1 || !matches!(method, 0 | 8) {
        let cause = format!("array `{name}` is encrypted, or compressed in an unusual way");
        return Some(Err(damaged(local, cause)));
    }
    // The local header repeats the name, and has other extra fields.
    let header = file.read(local..local.checked_add(30)?).ok()?;
    if !header.starts_with(b"PK\x03\x04") {
        return None;
    }
    let start = local + 30 + number(&header, 26, 2)? + number(&header, 28, 2)?;
    let end = start.checked_add(compressed)?;
    if end > file.length() || method == 0 && compressed != length {
        return None;
    }
    Some(Ok((ZipMember { name, is_deflated: method == 8, compressed, length, start }, next)))
}

/// Replaces numbers that do not fit 32 bits by those of the extra field 1, which has only these, in order.
fn wide_numbers(mut extra: &[u8], numbers: [&mut u64; 3]) {
    while let (Some(tag), Some(length)) = (number(extra, 0, 2), number(extra, 2, 2)) {
        let length = usize::try_from(length).unwrap_or(0);
        if tag == 1 {
            let mut position = 4;
            for wide in numbers.into_iter().filter(|number| **number == 0xffff_ffff) {
                let Some(found) = number(extra, position, 8) else { return };
                *wide = found;
                position += 8;
            }
            return;
        }
        extra = extra.get(4 + length..).unwrap_or(&[]);
    }
}

/// Returns a member as a file of its own, in memory if it has at most `memory` bytes. Stored members are read in place instead.
pub(super) fn inflate(file: &DataFile, member: &ZipMember, memory: u64) -> Result<DataFile, Faults> {
    let end = member.start + member.compressed;
    decompress::inflate(file, member.start..end, member.length, memory)
        .map_err(|faults| faults.within(&format!("array `{}`", member.name)))
}
