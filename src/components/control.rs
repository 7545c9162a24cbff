//! Values of a program that its preview changes.

use std::ops::RangeInclusive;

use hecs::World;

use crate::color::Rgb;

/// A named value that systems read and that a preview changes: a number with a slider, a switch (`bool`) or a colour ([`Rgb`]).
///
/// A world has one entity for each control. A constant both declares the control and reads its value:
///
/// ```
/// use rayreel::components::{Control, Material, Shape, Transform};
/// use rayreel::{Context, Engine, Rgb, Step, World};
///
/// const GRAVITY: Control = Control::number("gravity", 9.81, 0.0..=20.0);
///
/// let mut world = World::new();
/// world.spawn((GRAVITY,));
/// let ball = world.spawn((Shape::Sphere { radius: 1.0 }, Material::matte(Rgb::ONE), Transform::IDENTITY));
/// let mut engine = Engine::new(world);
/// engine.add_stepped_system(Step::per_second(4), move |context: &mut Context<'_>| {
///     let speed = -GRAVITY.value(context.world) * context.time.seconds();
///     context.world.get::<&mut Transform>(ball).unwrap().translation.y += speed * context.step_seconds();
///     context.changes.mark_transform(ball);
/// });
///
/// let mut height_after_a_second = |gravity| {
///     GRAVITY.set(engine.world_mut(), gravity); // as the preview's slider does; steps start over
///     engine.seek(engine.timeline.time_of(24))?;
///     Ok::<f64, rayreel::EngineError>(engine.world().get::<&Transform>(ball).unwrap().translation.y)
/// };
/// assert_eq!(height_after_a_second(8.0)?, -3.0);
/// assert_eq!(height_after_a_second(4.0)?, -1.5);
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control<T = f64> {
    pub(crate) name: &'static str,
    pub(crate) value: T,
    /// The least and the greatest value of a number.
    pub(crate) range: (f64, f64),
}

impl Control {
    /// Creates a control for a number in a range.
    #[must_use]
    pub const fn number(name: &'static str, value: f64, range: RangeInclusive<f64>) -> Self {
        Self { name, value, range: (*range.start(), *range.end()) }
    }
}

impl Control<bool> {
    /// Creates a control that is on or off.
    #[must_use]
    pub const fn switch(name: &'static str, value: bool) -> Self {
        Self { name, value, range: (0.0, 1.0) }
    }
}

impl Control<Rgb> {
    /// Creates a control for a colour.
    #[must_use]
    pub const fn color(name: &'static str, value: Rgb) -> Self {
        Self { name, value, range: (0.0, 1.0) }
    }
}

impl<T: Copy + Send + Sync + 'static> Control<T> {
    /// Returns the current value in a world: that of the control with this name or, if the world has none, the value of `self`.
    #[must_use]
    pub fn value(&self, world: &World) -> T {
        let mut controls = world.query::<&Self>();
        controls.iter().find(|control| control.name == self.name).map_or(self.value, |control| control.value)
    }

    /// Sets the value in a world, which gets the control if it has none of this name.
    pub fn set(&self, world: &mut World, value: T) {
        let mut controls = world.query_mut::<&mut Self>().into_iter();
        match controls.find(|control| control.name == self.name) {
            Some(control) => control.value = value,
            None => {
                world.spawn((Self { value, ..*self },));
            }
        }
    }
}
