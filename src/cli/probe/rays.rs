//! Casts given rays and prints one line per ray. Rays are processed in batches, so that inputs of any length can be streamed.

use std::fmt::Write;
use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;

use rayreel::{Engine, Hit, World};

use super::super::exit::Failure;
use super::super::print;
use super::names::hit_label;
use super::numbers::Shortest;
use super::read::RayReader;

/// Number of rays that are cast together.
const BATCH: usize = 8192;
/// Number of hits that a thread formats at a time.
const CHUNK: usize = 1024;

const HEADER: &str = "hit,entity,t,px,py,pz,nx,ny,nz\n";

pub(super) fn run(path: &Path, engine: &Engine, json: bool) -> Result<(), Failure> {
    let mut reader = RayReader::open(path)?;
    let write = if json { json_lines } else { csv_lines };
    let print = if json { print::json_part } else { print::result_part };
    if !json && print(HEADER)?.is_break() {
        return Ok(());
    }
    let world = engine.world();
    let mut rays = Vec::with_capacity(BATCH);
    loop {
        rays.clear();
        let read = reader.read(&mut rays, BATCH);
        let hits = engine.cast_all(&rays);
        let lines = hits.par_chunks(CHUNK).map(|hits| write(world, hits).context("cannot write the results"));
        let lines = lines.collect::<anyhow::Result<Vec<_>>>()?.concat();
        let nobody_listens =
            print(&String::from_utf8(lines).context("cannot write the results")?)?.is_break();
        read?;
        if nobody_listens || rays.len() < BATCH {
            return Ok(());
        }
    }
}

/// Formats hits as CSV with the nine columns of [`HEADER`]. For a ray without a hit, only the first column is filled. `t` is empty if no
/// `f64` can hold it.
fn csv_lines(world: &World, hits: &[Option<Hit>]) -> anyhow::Result<Vec<u8>> {
    let mut lines = Vec::new();
    let mut writer = csv::Writer::from_writer(&mut lines);
    let mut text = String::new();
    for hit in hits {
        let Some(hit) = hit else {
            writer.write_record(["0", "", "", "", "", "", "", "", ""])?;
            continue;
        };
        writer.write_field("1")?;
        writer.write_field(hit_label(world, hit))?;
        let point_and_normal = hit.point.to_array().into_iter().chain(hit.normal.to_array());
        for number in [hit.t].into_iter().chain(point_and_normal.map(Some)) {
            text.clear();
            if let Some(number) = number {
                write!(text, "{}", Shortest(number))?;
            }
            writer.write_field(&text)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()?;
    drop(writer);
    Ok(lines)
}

/// Formats hits as JSON, one object per line.
fn json_lines(world: &World, hits: &[Option<Hit>]) -> anyhow::Result<Vec<u8>> {
    let mut lines = Vec::new();
    for hit in hits {
        match hit {
            None => lines.extend_from_slice(b"{\"hit\":false"),
            Some(hit) => {
                lines.extend_from_slice(b"{\"hit\":true,\"entity\":");
                serde_json::to_writer(&mut lines, &hit_label(world, hit))?;
                lines.extend_from_slice(b",\"t\":");
                serde_json::to_writer(&mut lines, &hit.t)?;
                lines.extend_from_slice(b",\"point\":");
                serde_json::to_writer(&mut lines, &hit.point.to_array())?;
                lines.extend_from_slice(b",\"normal\":");
                serde_json::to_writer(&mut lines, &hit.normal.to_array())?;
            }
        }
        lines.extend_from_slice(b"}\n");
    }
    Ok(lines)
}
