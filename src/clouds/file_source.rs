//! The particles of a data file at a moment.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::bonds::BondSettings;
use super::columns::{FrameColumns, picked};
use super::error::CloudError;
use super::filter::ParticleFilter;
use super::frame_timing::{FrameTiming, FramesAt};
use super::mapping::{ColorBy, FirstFrame, ScaleBy};
use super::trajectory_file::TrajectoryFile;
use crate::color::Transfer;
use crate::components::{Cloud, CloudBonds, Particles};
use crate::time::Time;
use crate::trajectory::{Snapshot, Values};

/// The choice and the look of the particles of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudSettings {
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
    /// The conversion of the colours to light.
    pub transfer: Transfer,
}

/// The particles of a data file.
#[derive(Debug)]
pub struct FileParticles {
    file: Arc<TrajectoryFile>,
    /// The name of the file, for messages.
    name: String,
    settings: CloudSettings,
    first: OnceLock<FirstFrame>,
    last: Mutex<Option<(FramesAt, Cloud)>>,
}

impl FileParticles {
    /// Creates the particles of a file. `name` is the file as written in the scene.
    #[must_use]
    pub fn new(file: Arc<TrajectoryFile>, name: &str, settings: CloudSettings) -> Self {
        Self { file, name: name.to_owned(), settings, first: OnceLock::new(), last: Mutex::default() }
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

    /// Checks that the columns exist that the settings name, in the first frame.
    ///
    /// # Errors
    ///
    /// Returns the first setting that does not fit the frame.
    pub fn check(&self) -> Result<(), CloudError> {
        let snapshot = self.file.frame(0)?;
        let columns = FrameColumns::of(&snapshot);
        columns.positions(Some(&[]))?;
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

    fn particles(&self, at: FramesAt) -> Result<Cloud, CloudError> {
        let earlier = self.file.frame(at.frame)?;
        let later = match at.next {
            Some((next, share)) => Some((self.file.frame(next)?, share)),
            None => None,
        };
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
        cloud
    }

    fn mapped(
        &self,
        columns: &FrameColumns<'_>,
        snapshot: &Arc<Snapshot>,
        at: FramesAt,
    ) -> Result<Cloud, CloudError> {
        let CloudSettings { filter, scale_by, color_by, transfer, .. } = &self.settings;
        let rows = match filter {
            Some(filter) => Some(filter.bind(columns)?.rows(columns.count())),
            None => None,
        };
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
        let origin = match at.next {
            Some((next, _)) => format!("{}, frames {} to {next}", self.name, at.frame),
            None => format!("{}, frame {}", self.name, at.frame),
        };
        Ok(Cloud {
            positions: Arc::new(columns.positions(rows)?),
            scales,
            colors,
            numbers: numbers.map(Arc::new),
            bonds: self.bonds(snapshot, rows)?,
            origin: Some(origin.into()),
        })
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
        if let Some((frames, cloud)) = last().as_ref()
            && *frames == at
        {
            return Ok(cloud.clone());
        }
        let cloud = self.particles(at).map_err(|error| error.to_string())?;
        let before = last().replace((at, cloud.clone()));
        if let Some((before, _)) = before {
            self.read_ahead(before, at);
        }
        Ok(cloud)
    }

    fn is_still(&self) -> bool {
        self.file.trajectory().frames() == 1
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
