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

pub(crate) const CATEGORIES: [Category; 41] = [
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
        let shape = match r.index(5) {
            0 => ball(center, 1.0),
            1 => Shape::Plane { point: center, normal: r.direction() },
            2 => unit_box(r),
            3 => Shape::Ellipsoid { forward, radius: 1.0 },
            _ => Shape::Turned { forward, half: DVec3::ONE },
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
            shapes.push(match r.index(5) {
                0 => ball(center, 0.5),
                1 => Shape::Plane { point: center, normal: r.direction().normalize() },
                2 => around(center, half),
                3 => Shape::Ellipsoid { forward, radius: 1.0 },
                _ => Shape::Turned { forward, half },
            });
        }
        Case { shapes, origin: r.point() * 4.0, direction: r.direction() }
    }),
];

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
