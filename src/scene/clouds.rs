//! Opens the data files of clouds, and makes an entity of each cloud.

use std::collections::HashMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{
    BetweenDocument, CloudDocument, ColorByDocument, ColorDocument, ColorMapDocument, EndDocument,
    EntityDocument, ScaleByDocument, SceneDocument, SpaceDocument, StyleDocument, TransferDocument,
};
use super::input::InputFiles;
use super::source_text::SourceText;
use super::spawn::transfer;
use super::suggest_file::nearby;
use super::validate::{At, Problems, frame_rate, start_time};
use crate::clouds::{
    Between, BondSettings, CloudContent, CloudError, CloudPart, CloudSettings, ColorBy, ColorMap, End,
    FileParticles, FrameTiming, ParticleFilter, ScaleBy, TrajectoryFile,
};
use crate::components::CloudSource;

/// The label of warnings about data files.
pub(super) const DATA_LABEL: &str = "shown as far as it can be";

/// The label of warnings about molecules in left-handed space.
pub(super) const MIRRORED_LABEL: &str = "each is shown as its mirror image";

/// The settings of the whole scene on which clouds depend.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CloudScene {
    pub(super) transfer: TransferDocument,
    pub(super) space: Option<SpaceDocument>,
}

/// The data files of a scene, and the particles taken from them. Both are used again when the scene is loaded again, so that an edit of the
/// scene reads no file.
#[derive(Debug, Default)]
pub(super) struct CloudFiles {
    /// True if the scene will be loaded again.
    is_kept: bool,
    files: HashMap<PathBuf, Arc<TrajectoryFile>>,
    particles: Vec<Arc<FileParticles>>,
}

impl CloudFiles {
    /// Creates an empty list for a scene that will be loaded again.
    pub(super) fn kept() -> Self {
        Self { is_kept: true, ..Self::default() }
    }

    /// Opens the data files of a document's clouds, and appends an entity for each cloud to the document. Files and particles of `before`
    /// are used if they are still the same.
    pub(super) fn open(
        &mut self,
        document: &mut SceneDocument,
        scene_text: &SourceText,
        of_scene: CloudScene,
        before: &Self,
        inputs: &mut InputFiles,
        problems: &mut Problems,
    ) {
        if document.clouds.is_empty() {
            return;
        }
        problems.clouds_from(document.entities.len());
        let scene = At::scene();
        let list = scene.field("clouds");
        let paths: Vec<_> = (0..document.clouds.len()).map(|index| list.index(index).path()).collect();
        let folders = scene_text.folders(&paths).into_iter();
        let mut entities = Vec::with_capacity(document.clouds.len());
        for (index, (cloud, folder)) in document.clouds.iter().zip(folders).enumerate() {
            let at = list.index(index);
            let source = self.source(cloud, folder, of_scene.transfer, before, inputs);
            let source = source.map_err(|error| add_error(error, cloud, &at, problems)).ok();
            for warning in source.iter().flat_map(|particles| particles.warnings()) {
                let help = "complete the file, or render what there is";
                problems.warn(&at.field("source"), warning, DATA_LABEL, help);
            }
            // Who writes the space has made a choice.
            let is_mirrored = of_scene.space.is_none()
                && source.as_ref().is_some_and(|particles| particles.has_molecules() == Ok(true));
            if is_mirrored {
                let help = "write `space: RightHanded` in the scene, for which positions of atoms are meant";
                problems.warn(&at.field("source"), "molecules in left-handed space", MIRRORED_LABEL, help);
            }
            let place = || format!("{}: ", scene_text.line_of(&at.path())).into();
            let source = source.map(|particles| Box::new(CloudSource { particles, place: place() }));
            entities.push(Arc::new(entity(cloud, source)));
        }
        document.entities.extend(entities);
    }

    fn source(
        &mut self,
        cloud: &CloudDocument,
        folder: &Path,
        film: TransferDocument,
        before: &Self,
        inputs: &mut InputFiles,
    ) -> Result<Arc<FileParticles>, CloudError> {
        let path = folder.join(&cloud.source);
        let key = inputs.add(&path);
        let file = self.file(&path, key, &cloud.source, before)?;
        let settings = settings(cloud, film)?;
        let known =
            before.particles.iter().chain(&self.particles).find(|known| known.is_same(&file, &settings));
        let particles = match known {
            Some(known) => Arc::clone(known),
            None => Arc::new(FileParticles::new(file, &cloud.source, settings)),
        };
        particles.check()?;
        self.particles.push(Arc::clone(&particles));
        Ok(particles)
    }

    fn file(
        &mut self,
        path: &Path,
        key: PathBuf,
        written: &str,
        before: &Self,
    ) -> Result<Arc<TrajectoryFile>, CloudError> {
        if let Some(file) = self.files.get(&key) {
            return Ok(Arc::clone(file));
        }
        let error = |message: String, help: Option<String>| CloudError {
            part: CloudPart::Source,
            message,
            help: help.unwrap_or_else(|| "name a file of particles, as \"gas.xyz\"".to_owned()),
        };
        let file = match before.files.get(&key) {
            Some(file) if file.is_current(path) => Arc::clone(file),
            Some(file) => file.opened_again(path).map_err(|failure| error(failure.to_string(), None))?,
            None => {
                match fs::metadata(path) {
                    // Reading a pipe could block forever.
                    Ok(metadata) if !metadata.is_file() => {
                        return Err(error(format!("`{}` is not a file", path.display()), None));
                    }
                    Err(failure) if failure.kind() == ErrorKind::NotFound => {
                        let kind = Path::new(written).extension().map(ToOwned::to_owned);
                        let is_like = |name: &str| Path::new(name).extension() == kind.as_deref();
                        let help = nearby(path, Path::new(written), is_like);
                        return Err(error(format!("there is no file `{}`", path.display()), help));
                    }
                    _ => {}
                }
                TrajectoryFile::open(path, self.is_kept)
                    .map_err(|failure| error(failure.to_string(), None))?
            }
        };
        self.files.insert(key, Arc::clone(&file));
        Ok(file)
    }
}

/// Returns the entity of a cloud.
fn entity(cloud: &CloudDocument, source: Option<Box<CloudSource>>) -> EntityDocument {
    let CloudDocument { visible, casts_shadow, in_reflections, .. } = *cloud;
    // A mapped colour takes the place of the material's, and needs no other.
    let white = (cloud.color_by.is_some() && cloud.material.is_none()).then_some(ColorDocument([255.0; 3]));
    EntityDocument {
        name: cloud.name.clone(),
        parent: cloud.parent.clone().map(Box::new),
        transform: cloud.transform.clone(),
        shape: Some(cloud.particle_shape()),
        material: cloud.material.clone(),
        color: cloud.color.or(white).map(Box::new),
        visible,
        casts_shadow,
        in_reflections,
        cloud: source,
        ..EntityDocument::default()
    }
}

fn settings(cloud: &CloudDocument, film: TransferDocument) -> Result<CloudSettings, CloudError> {
    let frames = &cloud.frames;
    let times = FrameTiming {
        start: start_time(frames.start).unwrap_or_default(),
        is_early: frames.start < 0.0,
        rate: frame_rate(frames).unwrap_or_default(),
        between: match frames.between {
            BetweenDocument::Hold => Between::Hold,
            BetweenDocument::Linear => Between::Linear,
        },
        end: match frames.end {
            EndDocument::Hold => End::Hold,
            EndDocument::Loop => End::Loop,
        },
    };
    let filter = match &cloud.filter {
        Some(filter) => Some(ParticleFilter::parse(filter)?),
        None => None,
    };
    let scale_by = cloud.sizes().map(|scale_by| match scale_by {
        ScaleByDocument::Column(column) => ScaleBy::Column(column),
        ScaleByDocument::VanDerWaals => ScaleBy::VanDerWaals,
        ScaleByDocument::Covalent => ScaleBy::Covalent,
    });
    let color_by = cloud.color_by.as_ref().map(|color_by| match color_by {
        ColorByDocument::Element => ColorBy::Element,
        ColorByDocument::Category(column) => ColorBy::Category(column.clone()),
        ColorByDocument::Map { column, map, range } => {
            ColorBy::Map { column: column.clone(), map: color_map(*map), range: *range }
        }
    });
    let transfer = transfer(film);
    let bonds = cloud.rods().map(|(radius, bonds)| BondSettings {
        radius,
        color: bonds.color.map(|color| transfer.decode(color.0)),
        distance: bonds.distance,
    });
    let content = match cloud.style {
        Some(StyleDocument::Cell) => CloudContent::Cell(cloud.bonds.as_ref().and_then(|bonds| bonds.radius)),
        _ => CloudContent::Particles,
    };
    // Larger ones are reported by the validation.
    let images = cloud.images.map(|count| u32::try_from(count).unwrap_or(1));
    Ok(CloudSettings { content, times, filter, scale_by, color_by, bonds, images, transfer })
}

fn color_map(document: ColorMapDocument) -> ColorMap {
    match document {
        ColorMapDocument::Viridis => ColorMap::Viridis,
        ColorMapDocument::Magma => ColorMap::Magma,
        ColorMapDocument::Inferno => ColorMap::Inferno,
        ColorMapDocument::Plasma => ColorMap::Plasma,
        ColorMapDocument::Cividis => ColorMap::Cividis,
        ColorMapDocument::Turbo => ColorMap::Turbo,
        ColorMapDocument::CoolWarm => ColorMap::CoolWarm,
    }
}

fn add_error(
    CloudError { part, message, help }: CloudError,
    cloud: &CloudDocument,
    at: &At<'_>,
    problems: &mut Problems,
) {
    const MISFIT: &str = "does not fit the data";
    // A style stands for fields that are not written.
    let is_of_style = match part {
        CloudPart::ScaleBy => cloud.scale_by.is_none(),
        CloudPart::Bonds => cloud.bonds.is_none(),
        _ => false,
    };
    match part {
        _ if is_of_style => problems.add(&at.field("style"), message, MISFIT, help),
        CloudPart::Bonds => problems.add(&at.field("bonds"), message, MISFIT, help),
        CloudPart::Images => problems.add(&at.field("images"), message, MISFIT, help),
        CloudPart::Style => problems.add(&at.field("style"), message, MISFIT, help),
        CloudPart::Source => problems.add(&at.field("source"), message, "cannot be shown", help),
        CloudPart::Frames => problems.add(&at.field("frames"), message, MISFIT, help),
        CloudPart::ScaleBy => problems.add(&at.field("scale_by"), message, MISFIT, help),
        CloudPart::ColorBy => problems.add(&at.field("color_by"), message, MISFIT, help),
        CloudPart::Filter(place) => problems.add_inside(&at.field("filter"), place, message, "here", help),
    }
}
