//! Pictures read from files of any program, in the formats that frames are written in.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use super::found_frame::{read, size_of};
use super::picture::{FileChannels, FileColors};
use super::{FrameFormat, exr_file, hdr_file, pfm_file, png_file, ppm_file};
use crate::color::{Rgb, Transfer};
use crate::output::Channels;
use crate::trace::Passes;

/// A picture read from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Output values from 0 to 255, unrounded, row by row from the top. Uncovered areas are black.
    pub values: Vec<[f64; 3]>,
    /// Linear light, premultiplied, if the file contains linear light.
    pub light: Option<Vec<Rgb>>,
    /// Covered fraction of each pixel, if the file has alpha.
    pub alpha: Option<Vec<f32>>,
}

impl PictureFile {
    /// Maximum number of pixels: 8192 columns times 8192 rows.
    pub const LARGEST_AREA: u64 = 1 << 26;

    /// Reads a picture in PNG, binary PPM, PFM, Radiance HDR, or OpenEXR as [frames](FrameFormat) are written. `transfer` converts linear light to
    /// output values. Memory is bounded regardless of the file's header.
    ///
    /// # Errors
    ///
    /// If the file is missing, incomplete, of another format or too large, or has numbers that are not finite. The error describes the
    /// reason.
    pub fn read(path: &Path, transfer: Transfer) -> Result<Self, String> {
        /// Maximum number of bytes per pixel of all formats.
        const OF_A_PIXEL: u64 = 64;
        /// Upper bound on the bytes of headers and other contents of a file.
        const OF_THE_REST: u64 = 1 << 26;
        if !path.metadata().map_err(|error| error.to_string())?.is_file() {
            return Err("it is not a regular file".to_owned());
        }
        let mut file = BufReader::new(File::open(path).map_err(|error| error.to_string())?);
        let mut beginning = Vec::new();
        (&mut file).take(4).read_to_end(&mut beginning).map_err(|error| error.to_string())?;
        let format = match &beginning[..] {
            b"\x89PNG" => FrameFormat::default(),
            [b'P', b'6', ..] => FrameFormat::Ppm,
            [b'P', b'F', ..] => FrameFormat::Pfm,
            b"#?RA" => FrameFormat::Hdr,
            [0x76, 0x2f, 0x31, 0x01] => FrameFormat::Exr(Channels::Rgb, Passes::default()),
            _ => {
                return Err(
                    "it is no PNG, binary PPM (P6), PFM (PF), Radiance HDR (#?RADIANCE) or OpenEXR file"
                        .to_owned(),
                );
            }
        };
        file.seek(SeekFrom::Start(0)).map_err(|error| error.to_string())?;
        let area = match size_of(file, format) {
            Some((width, height)) => {
                let area = u64::from(width) * u64::from(height);
                if area == 0 || area > Self::LARGEST_AREA {
                    let most = Self::LARGEST_AREA;
                    return Err(format!(
                        "it has {width}x{height} pixels, and pictures have from 1 to {most} pixels"
                    ));
                }
                area
            }
            None if matches!(format, FrameFormat::Exr(..)) => return Err("its header has no size".to_owned()),
            // The decoder reports the reason.
            None => 0,
        };
        let bytes = read(path, area * OF_A_PIXEL + OF_THE_REST).map_err(|error| error.to_string())?;
        let channels = match format {
            FrameFormat::Png(_) | FrameFormat::Png16(_) => png_file::channels(Cursor::new(&bytes))?,
            FrameFormat::Ppm => {
                let picture = ppm_file::decode(&bytes)?;
                let (pixels, _) = picture.bytes.as_chunks::<3>();
                let values = pixels.iter().map(|pixel| pixel.map(f64::from)).collect();
                FileChannels { size: picture.size, colors: FileColors::Encoded(values), alpha: None }
            }
            FrameFormat::Pfm => pfm_file::channels(&bytes)?,
            FrameFormat::Exr(..) => exr_file::channels(&bytes)?,
            FrameFormat::Hdr => hdr_file::channels(&bytes)?,
        };
        Self::of(channels, transfer)
    }

    fn of(channels: FileChannels, transfer: Transfer) -> Result<Self, String> {
        let FileChannels { size, colors, alpha } = channels;
        let at = |index: usize| {
            let (width, index) = (u64::from(size.0), index as u64);
            format!("its pixel {},{} has a number that is not finite", index % width, index / width)
        };
        let count = u64::from(size.0) * u64::from(size.1);
        let alpha_is_whole = alpha.as_ref().is_none_or(|alpha| alpha.len() as u64 == count);
        let colors_count = match &colors {
            FileColors::Encoded(values) => values.len(),
            FileColors::Light(light) => light.len(),
        };
        if colors_count as u64 != count || !alpha_is_whole {
            return Err("its size is not that of its pixels".to_owned());
        }
        if let Some(index) = alpha.iter().flatten().position(|alpha| !alpha.is_finite()) {
            return Err(at(index));
        }
        let (values, light) = match colors {
            FileColors::Encoded(mut values) => {
                let covers = values.iter_mut().zip(alpha.iter().flatten());
                for (pixel, alpha) in covers.filter(|(_, alpha)| **alpha < 1.0) {
                    *pixel = transfer.encode_unrounded(transfer.decode(*pixel) * *alpha);
                }
                (values, None)
            }
            FileColors::Light(light) => {
                if let Some(index) = light.iter().position(|pixel| !pixel.is_finite()) {
                    return Err(at(index));
                }
                (light.iter().map(|pixel| transfer.encode_unrounded(*pixel)).collect(), Some(light))
            }
        };
        Ok(Self { size, values, light, alpha })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::output::encode;
    use crate::trace::Film;

    fn read_bytes(bytes: &[u8]) -> Result<PictureFile, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture");
        fs::write(&path, bytes).unwrap();
        PictureFile::read(&path, Transfer::Srgb)
    }

    fn formats() -> Vec<FrameFormat> {
        let mut formats = vec![
            FrameFormat::Png(Channels::Rgb),
            FrameFormat::Png(Channels::Rgba),
            FrameFormat::Png16(Channels::Rgb),
            FrameFormat::Png16(Channels::Rgba),
            FrameFormat::Ppm,
            FrameFormat::Pfm,
        ];
        if cfg!(feature = "image") {
            formats.push(FrameFormat::Hdr);
        }
        if cfg!(feature = "exr") {
            formats.push(FrameFormat::Exr(Channels::Rgba, Passes::default()));
        }
        formats
    }

    fn film() -> Film {
        Film::from_pixels(7, 5, (0..35_u8).map(|index| Rgb::new(0.01, 0.02, 0.03) * f32::from(index)))
    }

    #[test]
    fn every_format_has_the_values_that_were_written() {
        for format in formats() {
            let bytes = encode(&film(), Transfer::Srgb, format).unwrap();
            let picture = read_bytes(&bytes).unwrap();
            assert_eq!(picture.size, (7, 5));
            assert_eq!(picture.alpha.is_some(), format.channels() == Channels::Rgba, "{format:?}");
            let step = match format {
                FrameFormat::Png(_) | FrameFormat::Ppm => 0.5,
                FrameFormat::Png16(_) => 0.5 / 257.0,
                FrameFormat::Pfm | FrameFormat::Exr(..) => 0.0,
                // Half a unit of at least 1 / 256 of the largest channel, where the transfer is steepest.
                FrameFormat::Hdr => 1.5,
            };
            for (found, written) in picture.values.iter().zip(film().pixels()) {
                let written = Transfer::Srgb.encode_unrounded(*written);
                let is_near =
                    found.iter().zip(written).all(|(found, written)| (found - written).abs() <= step + 1e-9);
                assert!(is_near, "{format:?}: {found:?} {written:?}");
            }
            let light = picture.light;
            assert_eq!(
                light.is_some(),
                matches!(format, FrameFormat::Pfm | FrameFormat::Exr(..) | FrameFormat::Hdr)
            );
            assert!(light.is_none_or(|light| step > 0.0 || light == film().pixels()));
        }
    }

    /// Reads grayscale, palettes and low bit depths, as other programs write them, and headers of portable maps in several lines.
    #[test]
    fn files_of_other_programs_are_read() {
        let png = |color, depth, palette: Option<Vec<u8>>, data: &[u8]| {
            let mut bytes = Vec::new();
            let mut encoder = png::Encoder::new(&mut bytes, 2, 1);
            encoder.set_color(color);
            encoder.set_depth(depth);
            if let Some(palette) = palette {
                encoder.set_palette(palette);
            }
            encoder.write_header().unwrap().write_image_data(data).unwrap();
            bytes
        };
        let black_and_white = [[0.0; 3], [255.0; 3]];
        for bytes in [
            png(png::ColorType::Grayscale, png::BitDepth::Eight, None, &[0, 255]),
            png(png::ColorType::Grayscale, png::BitDepth::One, None, &[0b0100_0000]),
            png(
                png::ColorType::Indexed,
                png::BitDepth::One,
                Some(vec![255, 255, 255, 0, 0, 0]),
                &[0b1000_0000],
            ),
            png(png::ColorType::GrayscaleAlpha, png::BitDepth::Eight, None, &[9, 0, 255, 255]),
            b"P6\n# a comment\n2 1\n255\n\0\0\0\xff\xff\xff".to_vec(),
            b"P6 2\t1 255 \0\0\0\xff\xff\xff".to_vec(),
        ] {
            assert_eq!(read_bytes(&bytes).unwrap().values, black_and_white);
        }
        let numbers = [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].map(f32::to_le_bytes).concat();
        let pfm = [b"PF\n2 1\n-1.000000\n", &numbers[..]].concat();
        assert_eq!(read_bytes(&pfm).unwrap().light.unwrap(), [Rgb::ZERO, Rgb::ONE]);
    }

    #[test]
    fn invalid_files_report_the_reason() {
        let header = "PF\n1 1\n-1.0\n";
        let not_a_number = [f32::NAN, 0.0, 0.0].map(f32::to_le_bytes).concat();
        let infinite = [0.0, f32::INFINITY, 0.0].map(f32::to_le_bytes).concat();
        let wide = read_bytes(b"P6 100000 100000 255\n").unwrap_err();
        assert_eq!(wide, "it has 100000x100000 pixels, and pictures have from 1 to 67108864 pixels");
        for (bytes, reason) in [
            (b"".to_vec(), "it is no PNG, binary PPM"),
            (b"GIF89a".to_vec(), "it is no PNG, binary PPM"),
            (b"P6 0 5 255\n".to_vec(), "it has 0x5 pixels"),
            (b"P6 2 1 65535\n\0\0\0\0\0\0\0\0\0\0\0\0".to_vec(), "it does not have 8 bits a channel"),
            (b"P6 2 1 255\n\0\0\0".to_vec(), "3 bytes of pixels instead of 6"),
            (b"PF\n4294967295 4294967295\n-1.0\n".to_vec(), "it has 4294967295x4294967295 pixels"),
            ([header.as_bytes(), &not_a_number].concat(), "its pixel 0,0 has a number that is not finite"),
            ([header.as_bytes(), &infinite].concat(), "its pixel 0,0 has a number that is not finite"),
        ] {
            let found = read_bytes(&bytes).unwrap_err();
            assert!(found.contains(reason), "{found}");
        }
    }

    /// Checks that a truncated file, or a file with a changed byte, gives an error or a picture of the same size, and never a panic.
    #[test]
    fn damaged_files_do_not_panic() {
        for format in formats() {
            let bytes = encode(&film(), Transfer::Srgb, format).unwrap();
            for end in (0..bytes.len()).step_by(3) {
                assert!(read_bytes(&bytes[..end]).is_err(), "{format:?} cut at {end}");
            }
            for place in (0..bytes.len()).step_by(3) {
                let mut changed = bytes.clone();
                changed[place] ^= 0xff;
                if let Ok(picture) = read_bytes(&changed) {
                    assert_eq!(picture.values.len(), 35, "{format:?} at {place}");
                }
            }
        }
    }
}
