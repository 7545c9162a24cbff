//! Many copies of one shape.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use crate::color::Rgb;
use crate::time::Time;

/// Copies of an entity's [`Shape`](super::Shape), one for each particle, in columns of equal length.
///
/// An entity with this component, a shape, a material and a transform is drawn once for each position. The entity's transform, parent and
/// visibility apply to all copies. Declare writes with [`Changes::mark_shape`](crate::Changes::mark_shape).
///
/// ```
/// use std::sync::Arc;
/// use rayreel::components::{Cloud, Material, Shape, Transform};
/// use rayreel::glam::DVec3;
/// use rayreel::{Engine, Ray, Rgb, Time, World};
///
/// let positions = (0..1000).map(|index| DVec3::X * f64::from(index)).collect();
/// let cloud = Cloud { positions: Arc::new(positions), ..Cloud::default() };
/// let mut world = World::new();
/// let row = world.spawn((Shape::Sphere { radius: 0.25 }, Material::matte(Rgb::ONE), Transform::IDENTITY, cloud));
/// let mut engine = Engine::new(world);
/// engine.seek(Time::ZERO)?;
/// let hit = engine.cast(Ray { origin: DVec3::new(17.0, 0.0, -1.0), direction: DVec3::Z }).unwrap();
/// assert_eq!((hit.entity, hit.distance), (row, 0.75));
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cloud {
    /// The places of the copies, in the entity's own space.
    pub positions: Arc<Vec<DVec3>>,
    /// The factors of the shape's size; `None` if all are 1. Particles with a factor that is not greater than 0 are not drawn.
    pub scales: Option<Arc<Vec<f64>>>,
    /// The colours; `None` if all copies have the colours of the entity's material.
    pub colors: Option<CloudColors>,
    /// The numbers by which the particles are called; `None` if these are their indices.
    pub numbers: Option<Arc<Vec<u64>>>,
    /// Rods between particles; `None` for none.
    pub bonds: Option<CloudBonds>,
    /// The file and the frame that the particles are from, for messages.
    pub origin: Option<Arc<str>>,
}

/// Rods between the particles of a [`Cloud`], which move with them: cylinders from one position to the other.
///
/// If the particles have colours of their own, each half of a rod has that of its particle. Not drawn are the rods of particles that are not
/// drawn, and rods without length.
#[derive(Clone, Debug, Default)]
pub struct CloudBonds {
    /// The particles at the ends, by index.
    pub pairs: Arc<Vec<[u32; 2]>>,
    /// The radius, in the entity's own space.
    pub radius: f64,
    /// The colour of all bonds; `None` if they have those of their particles.
    pub color: Option<Rgb>,
}

/// A copy of the shape of a [`Cloud`], or a rod between two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CloudMember {
    /// The number of a particle.
    Particle(u64),
    /// The numbers of the particles that a bond joins.
    Bond([u64; 2]),
}

/// The colours of the particles of a [`Cloud`], which replace the colour of the entity's material. They are shared by many particles, so that a
/// million of them have few materials.
#[derive(Clone, Debug, Default)]
pub struct CloudColors {
    /// The colours, at most 65 536.
    pub palette: Arc<Vec<Rgb>>,
    /// The index of each particle's colour. Particles with an index beyond the palette have the last colour.
    pub indices: Arc<Vec<u16>>,
}

/// The particles of a [`Cloud`] over time: before tracks are evaluated, the cloud of the same entity is set to those of the moment.
#[derive(Clone)]
pub struct CloudSource {
    /// The particles.
    pub particles: Arc<dyn Particles>,
    /// The place in a scene, for messages.
    pub place: Arc<str>,
}

/// The meaning of the colours of particles.
#[derive(Clone, Debug, PartialEq)]
pub enum CloudLegend {
    /// Colours of numbers.
    Ramp {
        /// The name of the numbers.
        title: String,
        /// The colours, of even steps.
        colors: Vec<Rgb>,
        /// The numbers of the first and the last colour.
        range: [f64; 2],
    },
    /// Colours of kinds.
    Kinds {
        /// The name of the property by which kinds differ.
        title: String,
        /// The kinds with their colours.
        kinds: Vec<(String, Rgb)>,
    },
}

/// A frame of data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DataMoment {
    /// The index of the frame; of the earlier one between two.
    pub frame: usize,
    /// The time in the unit of the data, if the frame has one.
    pub time: Option<f64>,
}

/// The number of a particle: an entity with this component is at that particle of its parent, which is a cloud. Its translation is set
/// before tracks are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AtParticle(pub u64);

/// Particles as a function of time.
pub trait Particles: Send + Sync {
    /// Returns the particles at a moment. A cloud with the same columns as the previous one is not prepared again.
    ///
    /// # Errors
    ///
    /// Returns the cause and the remedy if there are none, as for a file that cannot be read.
    fn at(&self, time: Time) -> Result<Cloud, String>;

    /// Returns whether the particles are the same at all moments.
    fn is_still(&self) -> bool {
        false
    }

    /// Returns the meaning of the colours; `None` if they have none.
    ///
    /// # Errors
    ///
    /// Returns the cause if it cannot be found.
    fn legend(&self) -> Result<Option<CloudLegend>, String> {
        Ok(None)
    }

    /// Returns the frame of the data that is shown at a moment, and its time; `None` if there are no frames.
    ///
    /// # Errors
    ///
    /// Returns the cause if it cannot be read.
    fn moment(&self, time: Time) -> Result<Option<DataMoment>, String> {
        let _ = time;
        Ok(None)
    }
}

impl Cloud {
    /// Returns whether both share all columns that determine the shapes.
    pub(crate) fn shares_shapes(&self, other: &Self) -> bool {
        let pairs = |cloud: &Self| cloud.bonds.as_ref().map(|bonds| Arc::as_ptr(&bonds.pairs));
        // By bits, so that a radius that is not a number equals itself.
        let radius = |cloud: &Self| cloud.bonds.as_ref().map(|bonds| bonds.radius.to_bits());
        Arc::ptr_eq(&self.positions, &other.positions)
            && address(&self.scales) == address(&other.scales)
            && (pairs(self), radius(self)) == (pairs(other), radius(other))
            && self.rods_per_bond() == other.rods_per_bond()
    }

    /// Returns the number of rods of each bond: halves of two colours, or one.
    pub(crate) fn rods_per_bond(&self) -> usize {
        let is_divided =
            self.colors.is_some() && self.bonds.as_ref().is_some_and(|bonds| bonds.color.is_none());
        if is_divided { 2 } else { 1 }
    }

    /// Returns the number of all bonds, of which some may not be drawn.
    pub(crate) fn bond_count(&self) -> usize {
        self.bonds.as_ref().map_or(0, |bonds| bonds.pairs.len())
    }

    /// Returns a rod of a bond: the particles at the ends of the bond, and the end to which the rod belongs, if it is a half.
    pub(crate) fn rod(&self, rod: usize) -> Option<([usize; 2], Option<usize>)> {
        let rods = self.rods_per_bond();
        let pair = self.bonds.as_ref()?.pairs.get(rod / rods)?.map(|particle| particle as usize);
        Some((pair, (rods == 2).then_some(rod % 2)))
    }

    /// Returns whether both share the column of colours. The palettes may differ.
    pub(crate) fn shares_colors(&self, other: &Self) -> bool {
        let indices = |cloud: &Self| cloud.colors.as_ref().map(|colors| Arc::as_ptr(&colors.indices));
        indices(self) == indices(other)
    }

    /// Returns the position of the particle with a number.
    #[must_use]
    pub fn position(&self, number: u64) -> Option<DVec3> {
        let particle = match &self.numbers {
            Some(numbers) => numbers.iter().position(|known| *known == number)?,
            None => usize::try_from(number).ok()?,
        };
        self.positions.get(particle).copied()
    }

    /// Returns the number by which a particle is called.
    #[must_use]
    pub fn number(&self, particle: usize) -> u64 {
        self.numbers.as_ref().and_then(|numbers| numbers.get(particle).copied()).unwrap_or(particle as u64)
    }
}

/// Returns the address of a shared column, by which it is compared.
fn address<T>(column: &Option<Arc<T>>) -> Option<*const T> {
    column.as_ref().map(Arc::as_ptr)
}

impl PartialEq for Cloud {
    /// Compares the columns as shared memory, not their values.
    fn eq(&self, other: &Self) -> bool {
        let palette = |cloud: &Self| cloud.colors.as_ref().map(|colors| Arc::as_ptr(&colors.palette));
        let bond_color = |cloud: &Self| cloud.bonds.as_ref().and_then(|bonds| bonds.color);
        address(&self.numbers) == address(&other.numbers)
            && palette(self) == palette(other)
            && bond_color(self) == bond_color(other)
            && self.shares_shapes(other)
            && self.shares_colors(other)
            && self.origin == other.origin
    }
}

impl fmt::Display for CloudMember {
    /// Formats a particle as `1234`, and a bond as `12-57`.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Particle(number) => write!(formatter, "{number}"),
            Self::Bond([one, other]) => write!(formatter, "{one}-{other}"),
        }
    }
}

impl PartialEq for CloudSource {
    /// Compares the particles as shared memory.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.particles, &other.particles) && self.place == other.place
    }
}

impl fmt::Debug for CloudSource {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("CloudSource").field("place", &self.place).finish_non_exhaustive()
    }
}
