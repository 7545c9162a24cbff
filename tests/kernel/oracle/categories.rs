//! Named categories of numerically hard rays, each against one or a few shapes.

use glam::{DAffine3, DVec3};

use super::exact::Shape;
use super::random::Random;

/// Shapes in document order, and a ray.
pub(crate) struct Case {
    pub(crate) shapes: Vec<Shape>,
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

pub(crate) type Category = (&'static str, fn(&mut Random) -> Case);

fn case(shape: Shape, origin: DVec3, direction: DVec3) -> Case {
    Case { shapes: vec![shape], origin, direction }
}

fn ball(center: DVec3, radius: f64) -> Shape {
    Shape::Ball { center, radius }
}

fn around(center: DVec3, half: DVec3) -> Shape {
    Shape::Aligned { min: center - half, max: center + half }
}

fn unit_box(r: &mut Random) -> Shape {
    let center = r.point();
    let half = r.extents();
    around(center, half)
}

const CUBE: Shape = Shape::Aligned { min: DVec3::NEG_ONE, max: DVec3::ONE };

/// Returns a direction that is not zero.
fn towards(way: DVec3) -> DVec3 {
    if way == DVec3::ZERO { DVec3::Z } else { way }
}

/// Returns a ray from some distance towards a point within about `size` of `center`.
fn aimed(r: &mut Random, shape: Shape, center: DVec3, size: f64) -> Case {
    let origin = center + r.direction() * (4.0 * size);
    let target = center + r.point() * size;
    case(shape, origin, towards(target - origin))
}

/// Returns integers a, b, c, d with a^2 + b^2 + c^2 = d^2, in any order and with any signs.
fn quadruple(r: &mut Random) -> (DVec3, f64) {
    const QUADRUPLES: [(DVec3, f64); 6] = [
        (DVec3::new(1.0, 2.0, 2.0), 3.0),
        (DVec3::new(2.0, 3.0, 6.0), 7.0),
        (DVec3::new(1.0, 4.0, 8.0), 9.0),
        (DVec3::new(2.0, 6.0, 9.0), 11.0),
        (DVec3::new(3.0, 4.0, 0.0), 5.0),
        (DVec3::new(8.0, 9.0, 12.0), 17.0),
    ];
    let (DVec3 { x, y, z }, d) = r.pick(&QUADRUPLES);
    let point = r.pick(&[DVec3::new(x, y, z), DVec3::new(z, x, y), DVec3::new(y, x, z)]);
    (point * DVec3::new(r.sign(), r.sign(), r.sign()), d)
}

/// Returns a direction of integers that is exactly perpendicular to `normal`.
fn square_to(r: &mut Random, normal: DVec3) -> DVec3 {
    let other = r.whole_direction(5);
    let along = normal.cross(other);
    if along == DVec3::ZERO {
        DVec3::new(-normal.y, normal.x, 0.0) + DVec3::Z * f64::from(normal.z == 0.0)
    } else {
        along
    }
}

pub(crate) const CATEGORIES: [Category; 60] = [
    ("sphere, ordinary", |r| case(ball(r.point() * 4.0, 1.0), r.point() * 4.0, r.direction())),
    ("sphere, aimed at", |r| {
        let center = r.point() * 4.0;
        aimed(r, ball(center, 1.0), center, 1.0)
    }),
    ("sphere, far and tiny", |r| {
        let radius = r.scale(-30..=-10);
        let center = r.direction() * r.scale(0..=20);
        let origin = r.point();
        case(ball(center, radius), origin, center + r.point() * radius - origin)
    }),
    ("sphere, huge ground", |r| {
        let radius = r.scale(20..=40);
        let origin = DVec3::new(r.number(), 1.5 + r.number(), 0.0);
        case(ball(DVec3::new(0.0, -radius, 0.0), radius), origin, r.direction())
    }),
    ("sphere, near tangency", |r| {
        let height = 1.0 + r.number() * r.scale(-80..=-20);
        let origin = DVec3::new(-4.0, height, r.number() * 1e-9);
        let direction = DVec3::new(1.0, r.number() * r.scale(-60..=-30), 0.0);
        // The centre is the zero point, where the digits of the height count, or somewhere else.
        let center = if r.once_in(2) { DVec3::ZERO } else { r.point() };
        case(ball(center, 1.0), origin, direction)
    }),
    ("sphere, tangent exactly", |r| {
        let scale = r.scale(-40..=40);
        if r.once_in(3) {
            // All digits count: along an axis, at the height of the radius.
            let radius = 1.5 + r.number();
            let origin = DVec3::new(-4.0 + r.number(), radius, 0.0) * scale;
            return case(ball(DVec3::ZERO, radius * scale), origin, DVec3::X * r.scale(-110..=110));
        }
        let (touched, radius) = quadruple(r);
        let along = square_to(r, touched);
        let center = DVec3::new(r.whole(50), r.whole(50), r.whole(50));
        let origin = center + touched - along * r.whole(9) * 0.25;
        case(ball(center * scale, radius * scale), origin * scale, along * r.scale(-110..=110))
    }),
    ("sphere, origin inside", |r| case(ball(DVec3::ZERO, 2.0), r.point(), r.direction())),
    ("sphere, origin nearly on it", |r| {
        let origin = r.direction().normalize() * (1.0 + r.number() * r.scale(-60..=-30));
        case(ball(DVec3::ZERO, 1.0), origin, r.direction())
    }),
    ("sphere, origin exactly on it", |r| {
        let scale = r.scale(-110..=110);
        if r.once_in(3) {
            let radius = (1.5 + r.number()) * scale;
            let origin = r.pick(&DVec3::AXES) * r.sign() * radius;
            return case(ball(DVec3::ZERO, radius), origin, r.direction());
        }
        let (touched, radius) = quadruple(r);
        let center = DVec3::new(r.whole(50), r.whole(50), r.whole(50));
        let direction = if r.once_in(4) { r.direction() } else { r.whole_direction(6) };
        case(ball(center * scale, radius * scale), (center + touched) * scale, direction)
    }),
    ("sphere, behind", |r| {
        let center = r.direction() * 3.0;
        case(ball(center, 1.0), DVec3::ZERO, r.point() * 0.1 - center)
    }),
    ("sphere, any scale", |r| {
        let scale = r.scale(-110..=110);
        let center = r.point() * 2.0;
        let Case { origin, direction, .. } = aimed(r, ball(center, 1.0), center, 1.0);
        case(ball(center * scale, scale), origin * scale, direction * r.scale(-110..=110))
    }),
    ("plane, ordinary and grazing", |r| {
        let normal = r.direction().normalize();
        let along = normal.cross(r.direction()) + normal * r.number() * r.scale(-40..=0);
        let along = if along == DVec3::ZERO { normal } else { along };
        case(Shape::Plane { point: r.point(), normal }, r.point() * r.scale(0..=20), along)
    }),
    ("plane, normal of whole numbers as written", |r| {
        let normal = r.whole_direction(1 << 20);
        let point = r.whole_direction(1 << 20) * r.scale(-8..=8);
        let origin = if r.once_in(2) { r.whole_direction(8) } else { r.point() * r.scale(0..=20) };
        let direction = if r.once_in(2) { r.whole_direction(8) } else { -normal };
        case(Shape::Plane { point, normal: normal * r.scale(-110..=110) }, origin, direction)
    }),
    ("plane, far", |r| {
        let normal = r.direction().normalize();
        let point = r.point() * r.scale(20..=60);
        case(Shape::Plane { point, normal }, r.point() * r.scale(-20..=60), r.direction())
    }),
    ("plane, parallel", |r| {
        let normal = r.direction().normalize();
        // The products of the same two numbers cancel exactly.
        let direction = match r.index(3) {
            0 => DVec3::new(normal.y, -normal.x, 0.0),
            1 => DVec3::new(0.0, normal.z, -normal.y),
            _ => DVec3::new(-normal.z, 0.0, normal.x),
        };
        let normal = if direction == DVec3::ZERO { DVec3::Y } else { normal };
        let direction = if direction == DVec3::ZERO { DVec3::new(r.number(), 0.0, 1.0) } else { direction };
        let point = r.point();
        let origin = if r.once_in(4) { point } else { r.point() * r.scale(0..=20) };
        case(Shape::Plane { point, normal }, origin, direction * r.scale(-110..=110))
    }),
    ("plane, origin exactly on it", |r| {
        let scale = r.scale(-110..=110);
        if r.once_in(2) {
            let point = r.point() * scale;
            let normal = r.pick(&DVec3::AXES) * r.sign();
            let origin = point + (r.point() - normal * normal.dot(r.point())) * scale;
            let origin = DVec3::select(normal.cmpeq(DVec3::ZERO), origin, point);
            return case(Shape::Plane { point, normal }, origin, r.direction());
        }
        let normal = r.direction().normalize();
        let origin = DVec3::new(normal.y, -normal.x, 0.0) * scale;
        case(Shape::Plane { point: DVec3::ZERO, normal }, origin, r.direction())
    }),
    ("box, ordinary", |r| case(unit_box(r), r.point() * 4.0, r.direction())),
    ("box, aimed at", |r| {
        let center = r.point();
        let half = r.extents();
        aimed(r, around(center, half), center, 1.5)
    }),
    ("box, from inside", |r| case(unit_box(r), r.point() * 0.2, r.direction())),
    ("box, along faces", |r| {
        let height = r.pick(&[1.0, -1.0, 1.0 + f64::EPSILON, 0.5]);
        let zero = r.pick(&[0.0, -0.0]);
        let origin = DVec3::new(-3.0, height, r.number());
        case(CUBE, origin, DVec3::new(1.0, zero, r.number() * 0.1))
    }),
    ("box, through edges and corners", |r| {
        let corner = DVec3::new(1.0, 1.0, if r.once_in(2) { 1.0 } else { r.number() });
        let direction = r.direction();
        case(CUBE, corner - direction * 4.0, direction)
    }),
    ("box, thin, any scale", |r| {
        let scale = r.scale(-110..=110);
        let half = DVec3::new(1.0, r.scale(-50..=-1), 1.0);
        let center = r.point();
        let Shape::Aligned { min, max } = around(center * scale, half * scale) else { unreachable!() };
        let Case { origin, direction, .. } = aimed(r, CUBE, center, 1.0);
        case(Shape::Aligned { min, max }, origin * scale, direction * r.scale(-110..=110))
    }),
    ("box, signed zeros and subnormals", subnormal_box),
    ("boxes, sharing a face", boxes_sharing_a_face),
    ("turned box, ordinary", |r| {
        let center = r.point();
        let factors = DVec3::splat(1.2 + r.number());
        let forward = r.turned(factors, center);
        let half = r.extents();
        aimed(r, Shape::Turned { forward, half }, center, 1.5)
    }),
    ("turned box, from inside", |r| {
        let center = r.point();
        let factors = r.extents();
        let forward = r.turned(factors, center);
        let shape = Shape::Turned { forward, half: DVec3::ONE };
        case(shape, forward.transform_point3(r.point() * 0.9), r.direction())
    }),
    ("turned box, thin", |r| {
        let center = r.point();
        let factors = DVec3::new(1.0, r.scale(-13..=-1), 1.0 + 0.5 * r.number());
        let forward = r.turned(factors, center);
        aimed(r, Shape::Turned { forward, half: DVec3::ONE }, center, 1.0)
    }),
    ("turned box, far and any scale", |r| {
        let scale = r.scale(-60..=60);
        let center = r.direction() * r.scale(0..=20) * scale;
        let factors = r.extents() * scale;
        let forward = r.turned(factors, center);
        let Case { shapes, origin, direction, .. } =
            aimed(r, Shape::Turned { forward, half: DVec3::ONE }, center, 1.5 * scale);
        case(shapes[0], origin, direction * r.scale(-60..=60))
    }),
    ("turned box, through edges and corners", |r| {
        let factors = r.extents();
        let center = r.point();
        let forward = r.turned(factors, center);
        let corner = DVec3::new(r.sign(), r.sign(), if r.once_in(2) { 1.0 } else { r.number() });
        let direction = r.direction();
        let origin = forward.transform_point3(corner) - direction * 4.0;
        case(Shape::Turned { forward, half: DVec3::ONE }, origin, direction)
    }),
    ("turned box, by quarter turns", |r| {
        let center = DVec3::new(r.whole(20), r.whole(20), r.whole(20));
        let forward = r.quarter_turned(center);
        let half = DVec3::new(1.0, 2.0, 0.5);
        let corner = DVec3::new(r.sign(), r.sign(), r.whole(8) * 0.125) * half;
        let direction = r.whole_direction(6);
        let origin = forward.transform_point3(corner) - direction * r.whole(8) * 0.5;
        case(Shape::Turned { forward, half }, origin, direction)
    }),
    ("sheared box", |r| {
        let center = r.point();
        let forward = r.sheared(center);
        aimed(r, Shape::Turned { forward, half: DVec3::ONE }, center, 1.5)
    }),
    ("ellipsoid, ordinary", |r| {
        let center = r.point();
        let factors = r.extents();
        let forward = r.turned(factors, center);
        aimed(r, Shape::Ellipsoid { forward, radius: 1.0 }, center, 1.2)
    }),
    ("ellipsoid, sheared", |r| {
        let center = r.point();
        let forward = r.sheared(center);
        let radius = 1.2 + r.number();
        aimed(r, Shape::Ellipsoid { forward, radius }, center, 1.2)
    }),
    ("ellipsoid, flat", |r| {
        let center = r.point();
        let factors = DVec3::new(1.0, r.between(1e-4, 1e-2), 1.0 + 0.5 * r.number());
        let forward = r.turned(factors, center);
        aimed(r, Shape::Ellipsoid { forward, radius: 1.0 }, center, 1.0)
    }),
    ("ellipsoid, near tangency", |r| {
        let center = r.point();
        let factors = r.extents();
        let forward = r.turned(factors, center);
        let own = r.direction().normalize();
        let along = forward.matrix3 * own.cross(r.direction());
        let touched = forward.transform_point3(own * (1.0 + r.number() * r.scale(-80..=-10)));
        case(Shape::Ellipsoid { forward, radius: 1.0 }, touched - along * 3.0, towards(along))
    }),
    ("ellipsoid, origin inside", |r| {
        let center = r.point();
        let factors = r.extents();
        let forward = r.turned(factors, center);
        let shape = Shape::Ellipsoid { forward, radius: 2.0 };
        case(shape, forward.transform_point3(r.point()), r.direction())
    }),
    ("ellipsoid, far and any scale", |r| {
        let scale = r.scale(-60..=60);
        let center = r.direction() * r.scale(0..=20) * scale;
        let factors = r.extents() * scale;
        let forward = r.turned(factors, center);
        let Case { shapes, origin, direction, .. } =
            aimed(r, Shape::Ellipsoid { forward, radius: 1.0 }, center, 1.2 * scale);
        case(shapes[0], origin, direction * r.scale(-60..=60))
    }),
    ("ellipsoid, by quarter turns, tangent or origin on it", |r| {
        let center = DVec3::new(r.whole(50), r.whole(50), r.whole(50));
        let forward = r.quarter_turned(center);
        let (own, radius) = quadruple(r);
        let touched = forward.transform_point3(own);
        let shape = Shape::Ellipsoid { forward, radius };
        if r.once_in(2) {
            return case(shape, touched, r.whole_direction(6));
        }
        let along = forward.matrix3 * square_to(r, own);
        case(shape, touched - along * r.whole(9) * 0.25, along)
    }),
    ("any shape, from beyond all measure", |r| {
        let center = r.point() * 4.0;
        let factors = r.extents();
        let forward: DAffine3 = r.turned(factors, center);
        let is_round = r.once_in(2);
        let shape = match r.index(7) {
            0 => ball(center, 1.0),
            1 => Shape::Plane { point: center, normal: r.direction() },
            2 => unit_box(r),
            3 => Shape::Ellipsoid { forward, radius: 1.0 },
            4 => Shape::Turned { forward, half: DVec3::ONE },
            5 => Shape::Rod { ends: [center, center + r.direction()], radius: 1.0, is_round },
            _ => Shape::RodImage { forward, stop: r.direction(), radius: 1.0, is_round },
        };
        let far = r.scale(40..=480);
        // A ray along an axis may hit from any distance; any other ray misses.
        let axis = r.pick(&DVec3::AXES) * r.sign();
        let direction = if r.once_in(2) { axis } else { r.direction() };
        let aside = (r.point() * r.pick(&[1.0, 3.0, 50.0])) * (DVec3::ONE - axis.abs());
        case(shape, aside - direction * far, direction)
    }),
    ("planes nearer to each other than double-double can tell", nearly_tied_planes),
    ("several shapes", |r| {
        let mut shapes = Vec::new();
        for _ in 0..4 {
            let center = r.point() * 2.0;
            let factors = r.extents() * 0.5;
            let half = DVec3::splat(0.5);
            let forward: DAffine3 = r.turned(factors, center);
            let is_round = r.once_in(2);
            shapes.push(match r.index(7) {
                0 => ball(center, 0.5),
                1 => Shape::Plane { point: center, normal: r.direction().normalize() },
                2 => around(center, half),
                3 => Shape::Ellipsoid { forward, radius: 1.0 },
                4 => Shape::Turned { forward, half },
                5 => Shape::Rod { ends: [center, center + r.direction()], radius: 0.5, is_round },
                _ => Shape::RodImage { forward, stop: r.direction(), radius: 0.5, is_round },
            });
        }
        Case { shapes, origin: r.point() * 4.0, direction: r.direction() }
    }),
    ("cylinder, aimed at", |r| rod_aimed_at(r, false)),
    ("capsule, aimed at", |r| rod_aimed_at(r, true)),
    ("cylinder, needle of 2^30 to 1", |r| needle(r, false)),
    ("capsule, needle of 2^30 to 1", |r| needle(r, true)),
    ("cylinder, far and any scale", |r| far_rod(r, false)),
    ("capsule, far and any scale", |r| far_rod(r, true)),
    ("cylinder, near tangency", |r| grazed_rod(r, false)),
    ("capsule, near tangency", |r| grazed_rod(r, true)),
    ("cylinder, tangent exactly, on rims or the origin on it", |r| touched_rod(r, false)),
    ("capsule, tangent exactly or the origin on it", |r| touched_rod(r, true)),
    ("cylinder, along the axis", |r| along_rod(r, false)),
    ("capsule, along the axis", |r| along_rod(r, true)),
    ("cylinder, origin inside", |r| within_rod(r, false)),
    ("capsule, origin inside", |r| within_rod(r, true)),
    ("cylinder, as wide as the ground", |r| {
        let radius = r.scale(20..=40);
        let ends = [DVec3::new(0.0, -radius * r.scale(-40..=0), 0.0), DVec3::ZERO];
        let origin = DVec3::new(r.number(), 1.5 + r.number(), 0.0);
        case(Shape::Rod { ends, radius, is_round: false }, origin, r.direction())
    }),
    ("cylinder, stretched or sheared", |r| rod_image(r, false)),
    ("capsule, stretched or sheared", |r| rod_image(r, true)),
    ("rod, stretched by quarter turns, touched or the origin on it", |r| {
        let center = DVec3::new(r.whole(20), r.whole(20), r.whole(20));
        let forward = r.quarter_turned(center);
        let is_round = r.once_in(2);
        let (ends, radius, own, along) = touched(r);
        let stop = ends[1] - ends[0];
        let place = forward.transform_point3(own - ends[0]);
        let direction = if r.once_in(2) { r.whole_direction(6) } else { forward.matrix3 * along };
        let back = r.whole(6) * 0.5;
        case(Shape::RodImage { forward, stop, radius, is_round }, place - direction * back, direction)
    }),
    ("rod, with flush ends", flush_rods),
];

/// Returns a rod of ordinary proportions.
fn some_rod(r: &mut Random, is_round: bool) -> ([DVec3; 2], f64, Shape) {
    let from = r.point() * 2.0;
    let ends = [from, from + r.direction() * 2.0];
    let radius = r.between(0.05, 1.2);
    (ends, radius, Shape::Rod { ends, radius, is_round })
}

/// Returns a point of an axis, or beyond its ends.
fn near_axis(r: &mut Random, [from, to]: [DVec3; 2]) -> DVec3 {
    from + (to - from) * r.between(-0.2, 1.2)
}

fn rod_aimed_at(r: &mut Random, is_round: bool) -> Case {
    let (ends, radius, shape) = some_rod(r, is_round);
    let target = near_axis(r, ends) + r.point() * radius;
    let origin = target + r.direction() * r.between(0.1, 8.0);
    case(shape, origin, towards(target - origin))
}

fn needle(r: &mut Random, is_round: bool) -> Case {
    let radius = r.scale(-30..=-30) * r.between(0.5, 1.0);
    let from = r.point();
    let ends = [from, from + r.direction()];
    let target = near_axis(r, ends) + r.point() * radius;
    let origin = if r.once_in(4) { near_axis(r, ends) } else { r.point() * 4.0 };
    case(Shape::Rod { ends, radius, is_round }, origin, towards(target - origin))
}

fn far_rod(r: &mut Random, is_round: bool) -> Case {
    let scale = r.scale(-60..=60);
    let far = r.direction() * r.scale(0..=20);
    let (ends, radius, _) = some_rod(r, is_round);
    let ends = ends.map(|end| (end + far) * scale);
    let target = near_axis(r, ends) + r.point() * (radius * scale);
    let origin = if r.once_in(2) { r.point() * scale } else { target + r.direction() * (8.0 * scale) };
    let direction = towards(target - origin) * (r.scale(-40..=40) / scale);
    case(Shape::Rod { ends, radius: radius * scale, is_round }, origin, direction)
}

fn grazed_rod(r: &mut Random, is_round: bool) -> Case {
    let (ends, radius, shape) = some_rod(r, is_round);
    let across = (ends[1] - ends[0]).cross(r.direction()).normalize_or(DVec3::X);
    let touched = near_axis(r, ends) + across * (radius * (1.0 + r.number() * r.scale(-80..=-10)));
    let along = across.cross(r.direction());
    case(shape, touched - along * 3.0, towards(along))
}

/// Returns the ends and the radius of a rod along an axis, a point of its side, its rim or its end, and a direction that touches the side
/// there; all of them of whole numbers.
fn touched(r: &mut Random) -> ([DVec3; 2], f64, DVec3, DVec3) {
    let axis = r.index(3);
    let [up, one, other] = [0, 1, 2].map(|step| DVec3::AXES[(axis + step) % 3]);
    let scale = 1.0 + r.index(4) as f64;
    let (three, four) = (3.0 * r.sign() * scale, 4.0 * r.sign() * scale);
    let from = DVec3::new(r.whole(20), r.whole(20), r.whole(20));
    let height = 1.0 + r.index(8) as f64;
    let ends = [from, from + up * height * r.sign()];
    let part = r.pick(&[0.0, 1.0, 0.25, 0.5]);
    let inwards = r.pick(&[1.0, 1.0, 0.0]);
    let place = from + (ends[1] - from) * part + (one * three + other * four) * inwards;
    let along = one * -four + other * three + up * r.whole(3);
    (ends, 5.0 * scale, place, along)
}

fn touched_rod(r: &mut Random, is_round: bool) -> Case {
    let scale = r.scale(-40..=40);
    let (ends, radius, place, along) = touched(r);
    let direction = if r.once_in(2) { along } else { r.whole_direction(6) };
    let origin = place - direction * (r.whole(6) * 0.5);
    let shape = Shape::Rod { ends: ends.map(|end| end * scale), radius: radius * scale, is_round };
    case(shape, origin * scale, direction * r.scale(-40..=40))
}

fn along_rod(r: &mut Random, is_round: bool) -> Case {
    let nearly = if r.once_in(2) { DVec3::ZERO } else { r.point() * r.scale(-60..=-5) };
    if r.once_in(2) {
        // On or near the side, exactly along the axis.
        let (ends, radius, place, _) = touched(r);
        let up = ends[1] - ends[0];
        let off = r.pick(&[0.0, 0.0, f64::EPSILON, -f64::EPSILON, 0.5, -0.5]);
        let origin = place * (1.0 + off) - up * r.whole(2);
        return case(Shape::Rod { ends, radius, is_round }, origin, up * r.sign() + nearly);
    }
    let (ends, radius, shape) = some_rod(r, is_round);
    let up = ends[1] - ends[0];
    let origin = near_axis(r, ends) + r.point() * radius - up * r.whole(2);
    case(shape, origin, towards(up * r.sign() + nearly))
}

fn within_rod(r: &mut Random, is_round: bool) -> Case {
    let (ends, radius, shape) = some_rod(r, is_round);
    let place = ends[0] + (ends[1] - ends[0]) * r.between(0.01, 0.99);
    let direction = if r.once_in(4) { ends[1] - ends[0] } else { r.direction() };
    case(shape, place + r.point() * (0.5 * radius), direction)
}

fn rod_image(r: &mut Random, is_round: bool) -> Case {
    let (center, scale) = (r.point(), r.scale(-40..=40));
    let factors = r.extents();
    let forward = if r.once_in(2) { r.turned(factors, center) } else { r.sheared(center) };
    let forward = DAffine3 { matrix3: forward.matrix3 * scale, translation: forward.translation * scale };
    let stop = r.direction() * 2.0;
    let radius = r.between(0.05, 1.2);
    let target = near_axis(r, [DVec3::ZERO, stop]) + r.point() * radius;
    let target = forward.transform_point3(target);
    let origin = if r.once_in(2) { target + r.direction() * scale } else { r.point() * 6.0 * scale };
    case(Shape::RodImage { forward, stop, radius, is_round }, origin, towards((target - origin) / scale))
}

/// Returns a cylinder or a capsule with its equal, a plane, a box, a sphere or another rod, that touches or continues it, and a ray aimed
/// at a point of both.
fn flush_rods(r: &mut Random) -> Case {
    let (ends, radius, place, along) = touched(r);
    let up = ends[1] - ends[0];
    let is_round = r.once_in(2);
    let one = Shape::Rod { ends, radius, is_round };
    let half = DVec3::splat(2.0 * radius);
    let other = match r.index(6) {
        0 => Shape::Plane { point: ends[0], normal: up },
        1 => Shape::Rod { ends: [ends[1], ends[1] + up], radius, is_round: r.once_in(2) },
        2 => ball(r.pick(&ends), radius),
        3 => around(ends[0] - up.normalize() * half, half),
        4 => Shape::Rod { ends: [ends[0], ends[1] + up], radius, is_round: r.once_in(2) },
        _ => one,
    };
    let direction = if r.once_in(3) { along } else { r.whole_direction(6) };
    let origin = place - direction * (r.whole(6) * 0.5);
    Case { shapes: if r.once_in(2) { vec![one, other] } else { vec![other, one] }, origin, direction }
}

/// Returns a box with a ray whose zeros and subnormals decide the result, or a tiny box.
fn subnormal_box(r: &mut Random) -> Case {
    let subnormal = |r: &mut Random| r.number() * r.scale(-1070..=-1030);
    match r.index(4) {
        // Subnormal components of the origin, at a face through zero.
        0 => {
            let shape = Shape::Aligned { min: DVec3::new(0.0, 0.0, -1.0), max: DVec3::ONE };
            let origin = DVec3::new(-1.0, subnormal(r), r.number());
            let direction = DVec3::new(1.0, r.pick(&[0.0, -0.0, f64::EPSILON]), r.pick(&[0.0, -0.0]));
            case(shape, origin, direction)
        }
        // Subnormal components of the direction, along a face.
        1 => {
            let origin = DVec3::new(-3.0, r.pick(&[1.0, -1.0, 0.5]), r.pick(&[1.0, -1.0, 0.25]));
            case(CUBE, origin, DVec3::new(r.pick(&[1.0, 3.0]), subnormal(r), subnormal(r)))
        }
        // Subnormal components of both.
        2 => {
            let shape = Shape::Aligned { min: DVec3::new(0.0, 0.0, 0.0), max: DVec3::ONE };
            let origin = DVec3::new(-1.0, subnormal(r), subnormal(r));
            case(shape, origin, DVec3::new(1.0, subnormal(r), r.number()))
        }
        // The whole scene is as small as possible before the errors of products underflow.
        _ => {
            let scale = r.scale(-960..=-900);
            let half = r.extents() * scale;
            let shape = Shape::Aligned { min: -half, max: half };
            case(shape, r.point() * scale * 4.0, r.direction() * r.scale(-110..=110))
        }
    }
}

/// Returns planes at quotients of successive Fibonacci numbers, so close to each other that ordering them takes twice the digits of both,
/// and copies of them. The order is total nevertheless.
fn nearly_tied_planes(r: &mut Random) -> Case {
    let plane = |index: usize, length: f64| {
        let (mut height, mut speed) = (1.0, 1.0);
        for _ in 0..index {
            (height, speed) = (speed, height + speed);
        }
        Shape::Plane { point: DVec3::Y, normal: DVec3::new(speed - height, height, 0.0) * length }
    };
    let first = 60 + r.index(12);
    let shapes = (0..6).map(|_| plane(first + r.index(3), r.sign() * r.scale(-8..=8))).collect();
    Case { shapes, origin: DVec3::ZERO, direction: DVec3::new(1.0, 1.0, 0.0) }
}

/// Returns two boxes with a common face, and a ray aimed at a point of that face or of its edge.
fn boxes_sharing_a_face(r: &mut Random) -> Case {
    let axis = r.index(3);
    let few = r.once_in(2);
    let number = |r: &mut Random| if few { r.whole(8) * 0.125 } else { r.number() };
    let (low, high) = (DVec3::splat(-2.0) + r.point() * 0.25, DVec3::splat(2.0) + r.point() * 0.25);
    let (low, high) = if few { (DVec3::splat(-2.0), DVec3::splat(2.0)) } else { (low, high) };
    let seam = number(r);
    let (mut below, mut above) = (high, low);
    (below[axis], above[axis]) = (seam, seam);
    let (one, other) = (Shape::Aligned { min: low, max: below }, Shape::Aligned { min: above, max: high });
    let mut target = DVec3::new(number(r), number(r), number(r)) * 2.0;
    target[axis] = seam;
    let side = (axis + 1 + r.index(2)) % 3;
    if !r.once_in(4) {
        target[side] = high[side];
    }
    let mut direction = if few { r.whole_direction(8) } else { r.direction() };
    let mut origin = target - direction * 4.0;
    if r.once_in(4) {
        // Within the plane of the face.
        direction[axis] = r.pick(&[0.0, -0.0]);
        direction = towards_in_plane(direction, axis);
        origin = target - direction * 4.0;
        origin[axis] = seam;
    }
    let shapes = if r.once_in(2) { vec![one, other] } else { vec![other, one] };
    Case { shapes, origin, direction }
}

/// Returns the direction, or one perpendicular to the axis if it is zero.
fn towards_in_plane(direction: DVec3, axis: usize) -> DVec3 {
    if direction == DVec3::ZERO { DVec3::AXES[(axis + 1) % 3] } else { direction }
}
