//! Reflection and refraction at the smooth boundary of two transparent media: Snell's law and Fresnel's equations (Born and Wolf,
//! "Principles of Optics", section 1.5).

use crate::trace::math::{Double, Real, add, dot, subtract, times};

/// The boundary between two media, given by their refractive indices, which are greater than 0; of one ray, or one per lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary<R = f64> {
    /// Refractive index of the medium from which the light arrives.
    pub from: R,
    /// Refractive index of the medium behind the boundary.
    pub into: R,
}

impl<R: Real> Boundary<R> {
    /// Returns the cosine of the angle of refraction, for the cosine of the angle of incidence, 0..=1, and a mask of the rays without total
    /// internal reflection.
    ///
    /// Near the critical angle n2^2 - n1^2 sin^2 cancels, so it is computed from exact products.
    #[inline(always)]
    pub(super) fn refraction(&self, cosine: R) -> (R, R::Mask) {
        let (zero, one) = (cosine.of(0.0), cosine.of(1.0));
        let squared_sine = Double { high: one, low: zero } - Double::product(cosine, cosine);
        let bent = Double::product(self.from, self.from) * squared_sine;
        let rest = (Double::product(self.into, self.into) - bent).rounded();
        (rest.sqrt() / self.into, zero.less_or_equal(rest))
    }

    /// Returns the Fresnel reflectance of unpolarised light, 0..=1, for rays without total internal reflection. `transmitted` is the cosine
    /// of the angle of refraction.
    #[inline(always)]
    pub(super) fn partial_reflectance(&self, cosine: R, transmitted: R) -> R {
        let across = squared_ratio(self.from * cosine, self.into * transmitted);
        let along = squared_ratio(self.from * transmitted, self.into * cosine);
        (across + along) * 0.5
    }

    /// Returns the refracted directions of rays in unit directions, which need not be unit vectors. `cosine` and `transmitted` are the
    /// cosines of the angles of incidence and of refraction.
    #[inline(always)]
    pub(super) fn refracted(&self, unit: [R; 3], normal: [R; 3], cosine: R, transmitted: R) -> [R; 3] {
        let ratio = self.from / self.into;
        add(times(unit, ratio), times(normal, ratio * cosine - transmitted))
    }
}

#[cfg(test)]
impl Boundary {
    /// Returns the cosine of the angle of refraction, for the cosine of the angle of incidence, 0..=1. `None` under total internal
    /// reflection.
    #[must_use]
    pub(super) fn transmitted_cosine(&self, cosine: f64) -> Option<f64> {
        let (transmitted, passes) = self.refraction(cosine);
        passes.then_some(transmitted)
    }

    /// Returns the Fresnel reflectance of unpolarised light, 0..=1, for the cosine of the angle of incidence.
    #[must_use]
    pub(super) fn reflectance(&self, cosine: f64) -> f64 {
        let (transmitted, passes) = self.refraction(cosine);
        if passes { self.partial_reflectance(cosine, transmitted) } else { 1.0 }
    }
}

/// Returns the cosine of the angle between a unit direction and the normal that it arrives against, 0..=1.
#[inline(always)]
pub(super) fn incidence<R: Real>(unit: [R; 3], normal: [R; 3]) -> R {
    let cosine = -dot(unit, normal);
    let (zero, one) = (cosine.of(0.0), cosine.of(1.0));
    let cosine = cosine.if_less(zero, zero, cosine);
    one.if_less(cosine, one, cosine)
}

/// Returns d - 2 (d.N) N.
#[inline(always)]
pub(super) fn mirrored<R: Real>(direction: [R; 3], normal: [R; 3]) -> [R; 3] {
    subtract(direction, times(normal, dot(direction, normal) * 2.0))
}

#[inline(always)]
fn squared_ratio<R: Real>(one: R, other: R) -> R {
    let share = (one - other) / (one + other);
    share * share
}

#[cfg(test)]
mod tests {
    use super::*;

    const INTO_GLASS: Boundary = Boundary { from: 1.0, into: 1.5 };
    const OUT_OF_GLASS: Boundary = Boundary { from: 1.5, into: 1.0 };

    #[test]
    fn light_arriving_straight_goes_on_straight() {
        assert_eq!(INTO_GLASS.transmitted_cosine(1.0), Some(1.0));
        assert!((INTO_GLASS.reflectance(1.0) - 0.04).abs() < 1e-17);
    }

    #[test]
    fn grazing_light_enters_glass_at_the_critical_angle() {
        // cos_i, cos_t, R: computed to 16 and 15 digits. R is a mean of squared quotients, each rounded a few times.
        for (cosine, transmitted, reflected) in [
            (1e-3, 0.745_356_290_642_267_3, 0.994_205_572_508_501),
            (1e-6, 0.745_355_992_500_228, 0.999_994_186_242_658),
            (1e-8, 0.745_355_992_499_929_9, 0.999_999_941_862_235),
        ] {
            let found = INTO_GLASS.transmitted_cosine(cosine).unwrap();
            assert!((found - transmitted).abs() <= f64::EPSILON, "{found}");
            assert!((INTO_GLASS.reflectance(cosine) - reflected).abs() <= 1e-15);
        }
    }

    #[test]
    fn total_internal_reflection_starts_at_the_critical_angle() {
        // The sine of the critical angle is 2/3. Each entry is an angle relative to it, with cos_t^2 there. Rounding the cosine of the
        // angle changes cos_t^2 by 2e-16.
        let critical = libm::asin(2.0 / 3.0);
        for (angle, squared) in [(-1e-6, 2.236_067_727_5e-6), (-1e-9, 2.236_067_977_25e-9)] {
            let found = OUT_OF_GLASS.transmitted_cosine(libm::cos(critical + angle)).unwrap();
            assert!((found * found - squared).abs() < 1e-15, "{found}");
            assert!(OUT_OF_GLASS.reflectance(libm::cos(critical + angle)) < 1.0);
        }
        for angle in [1e-9, 1e-6] {
            assert_eq!(OUT_OF_GLASS.transmitted_cosine(libm::cos(critical + angle)), None);
            assert_eq!(OUT_OF_GLASS.reflectance(libm::cos(critical + angle)), 1.0);
        }
    }
}
