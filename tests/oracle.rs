//! The kernel's shapes against exact arithmetic of 400 bits, on random rays in the categories where numbers are hard.
//!
//! Wherever the exact margin is more than 2^-90, the verdict must be right and the distance within 2 units in the last place.
//! `RAYREEL_CASES` asks for more than the usual thousand cases a category.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may fail loudly, and prints its table")]

use dashu_float::FBig;
use glam::DVec3;

use rayreel::trace::shapes::{AlignedBox, Plane, Sphere};
use rayreel::trace::{Geometry, PreparedScene, PreparedShape, Ray, SurfaceMaterial};

type Exact = FBig;

fn exact(value: f64) -> Exact {
    Exact::try_from(value).unwrap().with_precision(400).value()
}

fn rounded(value: &Exact) -> f64 {
    value.to_f64().value()
}

fn dot(a: &[Exact; 3], b: &[Exact; 3]) -> Exact {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn vector(value: DVec3) -> [Exact; 3] {
    value.to_array().map(exact)
}

fn difference(a: DVec3, b: DVec3) -> [Exact; 3] {
    std::array::from_fn(|axis| exact(a[axis]) - exact(b[axis]))
}

/// What exact arithmetic says: the first t >= 0, and by what share of the whole another verdict was missed.
struct Answer {
    t: Option<Exact>,
    margin: f64,
}

fn sphere(shape: &Sphere, origin: DVec3, direction: DVec3) -> Answer {
    let (to_center, d) = (difference(shape.center, origin), vector(direction));
    let (a, b) = (dot(&d, &d), dot(&to_center, &d));
    let squared = exact(shape.radius) * exact(shape.radius);
    let c = dot(&to_center, &to_center) - &squared;
    let discriminant = &b * &b - &a * &c;
    let share = |value: &Exact, whole: &Exact| rounded(&(value / whole)).abs();
    let margin = share(&discriminant, &(&b * &b + &a * &squared)).min(share(&c, &(&c + &squared + &squared)));
    if discriminant < Exact::ZERO {
        return Answer { t: None, margin };
    }
    let root = discriminant.sqrt();
    let near = (&b - &root) / &a;
    let far = (&b + &root) / &a;
    Answer { t: [near, far].into_iter().find(|t| *t >= Exact::ZERO), margin }
}

fn plane(shape: &Plane, origin: DVec3, direction: DVec3) -> Answer {
    let normal = vector(shape.normal);
    let (height, speed) = (dot(&difference(shape.point, origin), &normal), dot(&vector(direction), &normal));
    let margin = rounded(&speed).abs().min(rounded(&height).abs());
    if speed == Exact::ZERO {
        return Answer { t: None, margin: 1.0 };
    }
    let t = height / speed;
    Answer { t: (t >= Exact::ZERO).then_some(t), margin }
}

fn aligned_box(shape: &AlignedBox, origin: DVec3, direction: DVec3) -> Answer {
    let (mut entry, mut exit): (Option<Exact>, Option<Exact>) = (None, None);
    for axis in 0..3 {
        let (low, high) =
            (exact(shape.min[axis]) - exact(origin[axis]), exact(shape.max[axis]) - exact(origin[axis]));
        if direction[axis] == 0.0 {
            if low > Exact::ZERO || high < Exact::ZERO {
                return Answer { t: None, margin: 1.0 };
            }
            continue;
        }
        let (one, other) = (low / exact(direction[axis]), high / exact(direction[axis]));
        let (near, far) = if one < other { (one, other) } else { (other, one) };
        entry = Some(entry.map_or(near.clone(), |entry| if near > entry { near } else { entry }));
        exit = Some(exit.map_or(far.clone(), |exit| if far < exit { far } else { exit }));
    }
    let (entry, exit) = (entry.unwrap(), exit.unwrap());
    // Slabs are decided exactly: every margin will do.
    let hit = entry <= exit;
    Answer { t: if hit { [entry, exit].into_iter().find(|t| *t >= Exact::ZERO) } else { None }, margin: 1.0 }
}

/// Numbers that look random, the same every time (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In -1..1; now and then with few digits, so that exact coincidences happen.
    fn number(&mut self) -> f64 {
        let full = (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        if self.bits().is_multiple_of(4) { (full * 8.0).round() / 8.0 } else { full }
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number())
    }

    fn direction(&mut self) -> DVec3 {
        let direction = self.point();
        if direction == DVec3::ZERO { DVec3::X } else { direction }
    }

    fn scale(&mut self, exponents: std::ops::RangeInclusive<i32>) -> f64 {
        let span = u64::from(exponents.end().abs_diff(*exponents.start())) + 1;
        let step = i32::try_from(self.bits() % span).unwrap();
        libm::ldexp(1.0, exponents.start() + step)
    }
}

/// A shape, and a ray's origin and direction.
type Case = (PreparedShape, DVec3, DVec3);
type Category = (&'static str, fn(&mut Random) -> Case);

fn ball(center: DVec3, radius: f64) -> PreparedShape {
    PreparedShape::Sphere(Sphere { center, radius })
}

/// A named way to make hard cases.
const CATEGORIES: [Category; 14] = [
    ("sphere, ordinary", |r| (ball(r.point() * 4.0, 1.0), r.point() * 4.0, r.direction())),
    ("sphere, far and tiny", |r| {
        let radius = r.scale(-30..=-10);
        let center = r.direction() * r.scale(0..=20);
        let origin = r.point();
        (ball(center, radius), origin, center + r.point() * radius - origin)
    }),
    ("sphere, huge ground", |r| {
        let radius = r.scale(20..=40);
        (
            ball(DVec3::new(0.0, -radius, 0.0), radius),
            DVec3::new(r.number(), 1.5 + r.number(), 0.0),
            r.direction(),
        )
    }),
    ("sphere, near tangency", |r| {
        let height = 1.0 + r.number() * r.scale(-80..=-20);
        (
            ball(r.point(), 1.0),
            DVec3::new(-4.0, height, r.number() * 1e-9),
            DVec3::new(1.0, r.number() * r.scale(-60..=-30), 0.0),
        )
    }),
    ("sphere, origin inside", |r| (ball(DVec3::ZERO, 2.0), r.point(), r.direction())),
    ("sphere, origin nearly on it", |r| {
        let origin = r.direction().normalize() * (1.0 + r.number() * r.scale(-60..=-30));
        (ball(DVec3::ZERO, 1.0), origin, r.direction())
    }),
    ("sphere, behind", |r| {
        let center = r.direction() * 3.0;
        (ball(center, 1.0), DVec3::ZERO, r.point() * 0.1 - center)
    }),
    ("sphere, any scale", |r| {
        let scale = r.scale(-110..=110);
        (ball(r.point() * 2.0 * scale, scale), r.point() * 3.0 * scale, r.direction() * r.scale(-110..=110))
    }),
    ("plane, ordinary and grazing", |r| {
        let normal = r.direction().normalize();
        let along = normal.cross(r.direction()) + normal * r.number() * r.scale(-40..=0);
        let along = if along == DVec3::ZERO { normal } else { along };
        (PreparedShape::Plane(Plane { point: r.point(), normal }), r.point() * r.scale(0..=20), along)
    }),
    ("box, ordinary", |r| (unit_box(r), r.point() * 4.0, r.direction())),
    ("box, from inside", |r| (unit_box(r), r.point() * 0.2, r.direction())),
    ("box, along faces", |r| {
        let shape = AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let origin = DVec3::new(
            -3.0,
            [1.0, -1.0, 1.0 + f64::EPSILON, 0.5][usize::try_from(r.bits() % 4).unwrap()],
            r.number(),
        );
        let zero = if r.bits().is_multiple_of(2) { 0.0 } else { -0.0 };
        (PreparedShape::AlignedBox(shape), origin, DVec3::new(1.0, zero, r.number() * 0.1))
    }),
    ("box, through edges and corners", |r| {
        let shape = AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let corner = DVec3::new(1.0, 1.0, if r.bits().is_multiple_of(2) { 1.0 } else { r.number() });
        let direction = r.direction();
        (PreparedShape::AlignedBox(shape), corner - direction * 4.0, direction)
    }),
    ("box, thin, any scale", |r| {
        let scale = r.scale(-110..=110);
        let half = DVec3::new(1.0, r.scale(-50..=-1), 1.0) * scale;
        let center = r.point() * scale;
        let shape = AlignedBox { min: center - half, max: center + half };
        (PreparedShape::AlignedBox(shape), r.point() * 3.0 * scale, r.direction() * r.scale(-110..=110))
    }),
];

fn unit_box(r: &mut Random) -> PreparedShape {
    let center = r.point();
    let half = DVec3::new(1.1 + r.number(), 1.1 + r.number(), 1.1 + r.number());
    PreparedShape::AlignedBox(AlignedBox { min: center - half, max: center + half })
}

#[test]
fn verdicts_and_distances_are_right_in_every_category() {
    let cases = std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1000);
    let mut random = Random(2026);
    let mut wrong = Vec::new();
    println!(
        "| category | cases | hits | median ulp | worst ulp | wrong verdicts |\n|---|---|---|---|---|---|"
    );
    for (name, make) in CATEGORIES {
        let (mut errors, mut wrong_verdicts) = (Vec::new(), 0);
        for _ in 0..cases {
            let (shape, origin, direction) = make(&mut random);
            let answer = match &shape {
                PreparedShape::Sphere(shape) => sphere(shape, origin, direction),
                PreparedShape::Plane(shape) => plane(shape, origin, direction),
                PreparedShape::AlignedBox(shape) => aligned_box(shape, origin, direction),
                _ => unreachable!("no category makes images"),
            };
            if answer.margin < libm::ldexp(1.0, -90) {
                continue;
            }
            let mut geometry = Geometry::default();
            geometry.push(shape);
            let scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
            let ray = Ray::new(origin, direction).unwrap();
            match (scene.cast(&ray), &answer.t) {
                (Some(surface), Some(t)) => {
                    let d = vector(direction);
                    let expected = t * dot(&d, &d).sqrt();
                    let nearest = rounded(&expected);
                    let found = scene.distance(&ray, &surface.hit);
                    let unit = (nearest.abs().next_up() - nearest.abs()).max(f64::MIN_POSITIVE);
                    let error = rounded(&((exact(found) - expected) / exact(unit))).abs();
                    if error.is_nan() || error > 2.0 || !surface.point.is_finite() {
                        wrong.push(format!("{name}: {error} ulp, {shape:?} {origin:?} {direction:?}"));
                    }
                    errors.push(error);
                }
                (None, None) => {}
                (found, expected) => {
                    wrong_verdicts += 1;
                    wrong.push(format!(
                        "{name}: hit {} instead of {}, margin {:e}, {shape:?} {origin:?} {direction:?}",
                        found.is_some(),
                        expected.is_some(),
                        answer.margin
                    ));
                }
            }
        }
        errors.sort_by(f64::total_cmp);
        let (median, worst) =
            (errors.get(errors.len() / 2).copied().unwrap_or(0.0), errors.last().copied().unwrap_or(0.0));
        println!("| {name} | {cases} | {} | {median:.2} | {worst:.2} | {wrong_verdicts} |", errors.len());
        if median > 0.5 {
            wrong.push(format!("{name}: the median is off by {median} ulp"));
        }
    }
    let count = wrong.len();
    wrong.truncate(12);
    assert!(wrong.is_empty(), "{count} wrong:\n{}", wrong.join("\n"));
}
