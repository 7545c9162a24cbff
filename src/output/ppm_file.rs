//! PPM files: binary, 8 bits per channel.

use std::io::BufRead;

use super::picture::StoredPicture;
use super::portable_map::Words;
use super::provenance::Provenance;

/// Returns the header, which precedes the pixels.
pub(super) fn header((width, height): (u32, u32), provenance: Option<&Provenance>) -> String {
    let comment = provenance.map(|provenance| format!("# {} {provenance}\n", Provenance::KEYWORD));
    format!("P6\n{}{width} {height} 255\n", comment.unwrap_or_default())
}

/// The contents of a header.
struct Header {
    size: (u32, u32),
    provenance: Option<String>,
}

/// Parses the header.
fn read_header(file: &mut impl BufRead) -> Result<Header, String> {
    let mut words = Words::default();
    if words.next(file)? != "P6" {
        return Err("it is not a binary portable pixmap".to_owned());
    }
    let size = (words.side(file)?, words.side(file)?);
    if words.next(file)? != "255" {
        return Err("it does not have 8 bits a channel".to_owned());
    }
    let own = |text: &String| Some(text.strip_prefix(Provenance::KEYWORD)?.strip_prefix(' ')?.to_owned());
    Ok(Header { size, provenance: words.comments.iter().find_map(own) })
}

/// Returns the width and height from the beginning of a file.
pub(super) fn size(file: &mut impl BufRead) -> Option<(u32, u32)> {
    read_header(file).ok().map(|header| header.size)
}

/// Decodes a file completely. Returns the reason if the file is not valid.
pub(super) fn decode(mut bytes: &[u8]) -> Result<StoredPicture, String> {
    let Header { size, provenance } = read_header(&mut bytes)?;
    let count = u64::from(size.0) * u64::from(size.1) * 3;
    if bytes.len() as u64 != count {
        return Err(format!("it has {} bytes of pixels instead of {count}", bytes.len()));
    }
    Ok(StoredPicture { size, bytes: bytes.to_vec(), provenance })
}
