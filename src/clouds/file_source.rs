//! The particles of a data file at a moment.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::bonds::BondSettings;
use super::cell;
use super::columns::{FrameColumns, picked};
use super::error::{CloudError, CloudPart};
use super::filter::ParticleFilter;
use super::frame_timing::{FrameTiming, FramesAt};
use super::legend::legend;
use super::mapping::{ColorBy, ELEMENT, FirstFrame, ScaleBy};
use super::trajectory_file::TrajectoryFile;
use crate::color::Transfer;
use crate::components::{Cloud, CloudBonds, CloudLegend, DataMoment, Particles};
use crate::time::Time;
use crate::trajectory::{Snapshot, Values};

/// The choice and the look of the particles of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudSettings {
    /// The particles, or the cell.
    pub content: CloudContent,
    /// The times of the frames.
    pub times: FrameTiming,
    /// The condition of the particles that are shown.
    pub filter: Option<ParticleFilter>,
    /// Their sizes.
    pub scale_by: Option<ScaleBy>,
    /// Their colours.
    pub color_by: Option<ColorBy>,
    /// The rods between them.
    pub bonds: Option<BondSettings>,
    /// The number of cells along each edge of the periodic cell that have copies of the particles, with the cell itself.
    pub images: [u32; 3],
    /// The conversion of the colours to light.
    pub transfer: Transfer,
}

/// The part of a data file that a cloud shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloudContent {
    /// The particles.
    Particles,
    /// The edges of the periodic cell, which have this radius, or a 400th of the longest edge.
    Cell(Option<f64>),
}

/// The particles of a data file.
#[derive(Debug)]
pub struct FileParticles {
    file: Arc<TrajectoryFile>,
    /// The name of the file, for messages.
    name: String,
    settings: CloudSettings,
    first: OnceLock<FirstFrame>,
    /// The legend, once it was needed; `None` without colours.
    legend: OnceLock<Option<CloudLegend>>,
    last: Mutex<Option<ShownFrames>>,
}

/// The later of two frames, and its share.
type LaterFrame = (Arc<Snapshot>, f64);

/// The particles of the last moment.
#[derive(Debug)]
struct ShownFrames {
    at: FramesAt,
    cloud: Cloud,
    /// The time in the unit of the file.
    time: Option<f64>,
}

impl FileParticles {
    /// Creates the particles of a file. `name` is the file as written in the scene.
    #[must_use]
    pub fn new(file: Arc<TrajectoryFile>, name: &str, settings: CloudSettings) -> Self {
        let (first, legend) = (OnceLock::new(), OnceLock::new());
        Self { file, name: name.to_owned(), settings, first, legend, last: Mutex::default() }
    }

    /// Returns whether these are the particles of the same file, with the same settings.
    #[must_use]
    pub fn is_same(&self, file: &Arc<TrajectoryFile>, settings: &CloudSettings) -> bool {
        Arc::ptr_eq(&self.file, file) && self.settings == *settings
    }

    /// Returns the warnings about the file.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        self.file.trajectory().warnings()
    }

    /// Returns whether the first frame has atoms of several elements: molecules, of which most differ from their mirror images.
    ///
    /// # Errors
    ///
    /// If it cannot be read.
    pub fn has_molecules(&self) -> Result<bool, CloudError> {
        Ok(match self.file.frame(0)?.column(ELEMENT) {
            Some(Values::Labels { names, .. }) => names.len() > 1,
            Some(Values::Numbers(numbers)) => numbers.windows(2).any(|pair| pair[0] != pair[1]),
            None => false,
        })
    }

    /// Checks that the columns exist that the settings name, in the first frame.
    ///
    /// # Errors
    ///
    /// Returns the first setting that does not fit the frame.
    pub fn check(&self) -> Result<(), CloudError> {
        let snapshot = self.file.frame(0)?;
        let columns = FrameColumns::of(&snapshot);
        if let CloudContent::Cell(radius) = self.settings.content {
            return edges(&columns, radius).map(|_| ());
        }
        columns.positions(Some(&[]))?;
        // A filter may leave few.
        let count = self.settings.filter.as_ref().map_or(columns.count(), |_| 0);
        cell::images(columns.cell().as_ref(), self.settings.images, count)?;
        if let Some(filter) = &self.settings.filter {
            filter.bind(&columns)?;
        }
        if let Some(scale_by) = &self.settings.scale_by {
            scale_by.scales(&columns)?;
        }
        self.first_frame(&columns)?;
        self.bonds(&snapshot, None).map(|_| ())
    }

    /// Returns the facts of the first frame, whose columns are these if it is at hand.
    fn first_frame(&self, columns: &FrameColumns<'_>) -> Result<&FirstFrame, CloudError> {
        if let Some(first) = self.first.get() {
            return Ok(first);
        }
        let first = match &self.settings.color_by {
            Some(color_by) => color_by.first_frame(columns)?,
            None => FirstFrame::default(),
        };
        Ok(self.first.get_or_init(|| first))
    }

    /// Returns the rows that the filter keeps; `None` for all.
    fn rows(&self, columns: &FrameColumns<'_>) -> Result<Option<Vec<u32>>, CloudError> {
        let filter = self.settings.filter.as_ref();
        filter.map(|filter| Ok(filter.bind(columns)?.rows(columns.count()))).transpose()
    }

    /// Returns the legend of the first frame.
    fn first_legend(&self) -> Result<Option<CloudLegend>, CloudError> {
        let Some(color_by) = &self.settings.color_by else { return Ok(None) };
        let snapshot = self.file.frame(0)?;
        let columns = FrameColumns::of(&snapshot);
        let rows = self.rows(&columns)?;
        let first = self.first_frame(&columns)?;
        legend(color_by, &columns, rows.as_deref(), first, self.settings.transfer).map(Some)
    }

    /// Returns the earlier and the later frame, with its share.
    fn frames(&self, at: FramesAt) -> Result<(Arc<Snapshot>, Option<LaterFrame>), CloudError> {
        let later = match at.next {
            Some((next, share)) => Some((self.file.frame(next)?, share)),
            None => None,
        };
        Ok((self.file.frame(at.frame)?, later))
    }

    fn particles(&self, at: FramesAt) -> Result<ShownFrames, CloudError> {
        let (earlier, later) = self.frames(at)?;
        let time = time_between(&earlier, later.as_ref());
        let columns = match &later {
            Some((later, share)) => FrameColumns::between(&earlier, later, *share)?,
            None => FrameColumns::of(&earlier),
        };
        if self.first.get().is_none() {
            let first = self.file.frame(0)?;
            self.first_frame(&FrameColumns::of(&first))?;
        }
        let cloud = self.mapped(&columns, &earlier, at);
        if Arc::strong_count(&self.file) == 1 {
            // Frames between which further moments lie are needed again.
            match at.next {
                Some((next, _)) => self.file.release(&[at.frame, next]),
                None => self.file.release(&[]),
            }
        }
        Ok(ShownFrames { at, cloud: cloud?, time })
    }

    fn mapped(
        &self,
        columns: &FrameColumns<'_>,
        snapshot: &Arc<Snapshot>,
        at: FramesAt,
    ) -> Result<Cloud, CloudError> {
        let origin = match at.next {
            Some((next, _)) => format!("{}, frames {} to {next}", self.name, at.frame),
            None => format!("{}, frame {}", self.name, at.frame),
        };
        let origin = Some(origin.into());
        if let CloudContent::Cell(radius) = self.settings.content {
            return Ok(Cloud { origin, ..edges(columns, radius)? });
        }
        let CloudSettings { scale_by, color_by, transfer, images, .. } = &self.settings;
        let rows = self.rows(columns)?;
        let rows = rows.as_deref();
        let scales = match scale_by {
            Some(scale_by) => {
                let scales = scale_by.scales(columns)?;
                Some(Arc::new(picked(rows, columns.count(), |row| scales[row])))
            }
            None => None,
        };
        let colors = match (color_by, self.first.get()) {
            (Some(color_by), Some(first)) => Some(color_by.colors(columns, rows, first, *transfer)?),
            _ => None,
        };
        let numbers = match snapshot.column("id") {
            Some(Values::Numbers(ids)) => Some(picked(rows, columns.count(), |row| number(ids[row]))),
            _ => rows.map(|rows| rows.iter().map(|row| u64::from(*row)).collect()),
        };
        let mut cloud = Cloud {
            positions: Arc::new(columns.positions(rows)?),
            scales,
            colors,
            numbers: numbers.map(Arc::new),
            bonds: self.bonds(snapshot, rows)?,
            origin,
        };
        let shown = cloud.positions.len();
        cell::repeat(&mut cloud, &cell::images(columns.cell().as_ref(), *images, shown)?);
        Ok(cloud)
    }

    /// Returns the bonds between the particles in these rows, or between all.
    fn bonds(&self, frame: &Arc<Snapshot>, rows: Option<&[u32]>) -> Result<Option<CloudBonds>, CloudError> {
        let Some(BondSettings { radius, color, distance }) = self.settings.bonds else { return Ok(None) };
        let mut pairs = self.file.bonds(frame, distance)?;
        if let Some(rows) = rows {
            let mut particles = vec![None; frame.count];
            for (particle, row) in (0..).zip(rows) {
                particles[*row as usize] = Some(particle);
            }
            let kept =
                |[one, other]: &[u32; 2]| Some([particles[*one as usize]?, particles[*other as usize]?]);
            pairs = Arc::new(pairs.iter().filter_map(kept).collect());
        }
        Ok(Some(CloudBonds { pairs, radius, color }))
    }

    /// Reads the frame ahead that follows if frames go on as from the last moment to this one.
    fn read_ahead(&self, before: FramesAt, at: FramesAt) {
        let step = at.frame.abs_diff(before.frame);
        let newest = at.next.map_or(at.frame, |(next, _)| next);
        if step > 0 && at.frame > before.frame {
            self.file.read_ahead(newest + step);
        }
    }
}

impl Particles for FileParticles {
    fn at(&self, time: Time) -> Result<Cloud, String> {
        let at = self.settings.times.frames_at(time, self.file.trajectory().frames());
        // Nothing is locked while threads work, as in `TrajectoryFile`.
        let last = || self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(shown) = last().as_ref().filter(|shown| shown.at == at) {
            return Ok(shown.cloud.clone());
        }
        let shown = self.particles(at).map_err(|error| error.to_string())?;
        let cloud = shown.cloud.clone();
        let before = last().replace(shown);
        if let Some(before) = before {
            self.read_ahead(before.at, at);
        }
        Ok(cloud)
    }

    fn is_still(&self) -> bool {
        self.file.trajectory().frames() == 1
    }

    fn legend(&self) -> Result<Option<CloudLegend>, String> {
        if let Some(legend) = self.legend.get() {
            return Ok(legend.clone());
        }
        let legend = self.first_legend().map_err(|error| error.to_string())?;
        Ok(self.legend.get_or_init(|| legend).clone())
    }

    fn moment(&self, time: Time) -> Result<Option<DataMoment>, String> {
        let at = self.settings.times.frames_at(time, self.file.trajectory().frames());
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let shown = last.as_ref().filter(|shown| shown.at == at).map(|shown| shown.time);
        drop(last);
        let time = match shown {
            Some(time) => time,
            None => {
                let (earlier, later) = self.frames(at).map_err(|error| error.to_string())?;
                time_between(&earlier, later.as_ref())
            }
        };
        Ok(Some(DataMoment { frame: at.frame, time }))
    }
}

/// Returns the time of the earlier of two frames, or in proportion between both.
fn time_between(earlier: &Snapshot, later: Option<&LaterFrame>) -> Option<f64> {
    let own = earlier.time?;
    let other = later.and_then(|(later, share)| Some((later.time?, *share)));
    Some(other.map_or(own, |(later, share)| own + share * (later - own)))
}

fn edges(columns: &FrameColumns<'_>, radius: Option<f64>) -> Result<Cloud, CloudError> {
    match columns.cell() {
        Some(cell) => Ok(cell::edges(&cell, radius)),
        None => {
            let help = "name a file with the cell of a simulation, or draw the edges with `entities`";
            Err(CloudError::new(CloudPart::Style, "the data has no periodic cell", help))
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "ids are whole numbers; others are truncated, and negative ones are 0"
)]
fn number(id: f64) -> u64 {
    id as u64
}
