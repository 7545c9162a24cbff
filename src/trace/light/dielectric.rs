//! Reflection and refraction at the smooth boundary of two transparent media: Snell's law and Fresnel's equations (Born and Wolf,
//! "Principles of Optics", section 1.5).

use crate::trace::math::Double;

/// The boundary between two media, given by their refractive indices, which are greater than 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Refractive index of the medium from which the light arrives.
    pub from: f64,
    /// Refractive index of the medium behind the boundary.
    pub into: f64,
}

impl Boundary {
    /// Returns the cosine of the angle of refraction, for the cosine of the angle of incidence, 0..=1. `None` under total internal
    /// reflection.
    ///
    /// Near the critical angle n2^2 - n1^2 sin^2 cancels, so it is computed from exact products.
    #[must_use]
    pub fn transmitted_cosine(&self, cosine: f64) -> Option<f64> {
        let squared_sine = Double::from(1.0) - Double::product(cosine, cosine);
        let bent = Double::product(self.from, self.from) * squared_sine;
        let rest = (Double::product(self.into, self.into) - bent).rounded();
        (rest >= 0.0).then(|| rest.sqrt() / self.into)
    }

    /// Returns the Fresnel reflectance of unpolarised light, 0..=1, for the cosine of the angle of incidence.
    #[must_use]
    pub fn reflectance(&self, cosine: f64) -> f64 {
        let Some(transmitted) = self.transmitted_cosine(cosine) else {
            return 1.0;
        };
        let ratio = |one: f64, other: f64| {
            let share = (one - other) / (one + other);
            share * share
        };
        let across = ratio(self.from * cosine, self.into * transmitted);
        let along = ratio(self.from * transmitted, self.into * cosine);
        0.5 * (across + along)
    }
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
