//! Named journeys of rays that leave surfaces.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine3, DMat3, DVec3};

use super::exact::Shape;
use super::random::Random;
use super::secondary::{Found, Tally, World};

pub(crate) type Journey = (&'static str, fn(&mut Random, &mut Tally));

pub(crate) const JOURNEYS: [Journey; 24] = [
    ("no acne: sphere", |r, tally| no_acne(r, tally, 0)),
    ("no acne: plane", |r, tally| no_acne(r, tally, 1)),
    ("no acne: box", |r, tally| no_acne(r, tally, 2)),
    ("no acne: ellipsoid", |r, tally| no_acne(r, tally, 3)),
    ("no acne: turned box", |r, tally| no_acne(r, tally, 4)),
    ("gap: sphere over plane", |r, tally| gap_over_plane(r, tally, 0)),
    ("gap: box over plane", |r, tally| gap_over_plane(r, tally, 2)),
    ("gap: ellipsoid and turned box over plane", |r, tally| {
        let kind = 3 + r.index(2);
        gap_over_plane(r, tally, kind);
    }),
    ("gap: nested spheres and boxes", gap_between_nested),
    ("contact shadow", contact_shadow),
    ("nested shells", nested_shells),
    ("transmission: sphere", |r, tally| transmission(r, tally, 0)),
    ("transmission: box", |r, tally| transmission(r, tally, 2)),
    ("transmission: ellipsoid", |r, tally| transmission(r, tally, 3)),
    ("transmission: turned box", |r, tally| transmission(r, tally, 4)),
    ("flush faces", flush_faces),
    ("coincident copies", coincident_copies),
    ("no acne: cylinder", |r, tally| no_acne(r, tally, 5)),
    ("no acne: capsule", |r, tally| no_acne(r, tally, 6)),
    ("no acne: stretched rod", |r, tally| no_acne(r, tally, 7)),
    ("gap: rod over plane", |r, tally| {
        let kind = 5 + r.index(2);
        gap_over_plane(r, tally, kind);
    }),
    ("transmission: cylinder", |r, tally| transmission(r, tally, 5)),
    ("transmission: capsule", |r, tally| transmission(r, tally, 6)),
    ("transmission: stretched rod", |r, tally| transmission(r, tally, 7)),
];

/// Returns a shape of about this size: 0 a sphere, 1 a plane, 2 a box, 3 an ellipsoid, 4 a rotated box,
/// 5 a cylinder, 6 a capsule, 7 the image of either.
fn some_shape(r: &mut Random, kind: usize, center: DVec3, scale: f64) -> Shape {
    let factors = r.extents();
    match kind {
        0 => Shape::Ball { center, radius: factors.x * scale },
        1 => Shape::Plane { point: center, normal: r.direction().normalize() },
        2 => Shape::Aligned { min: center - factors * scale, max: center + factors * scale },
        3 => Shape::Ellipsoid { forward: r.turned(factors * scale, center), radius: 1.0 },
        4 => Shape::Turned { forward: r.turned(factors * scale, center), half: DVec3::ONE },
        5 | 6 => {
            let half = r.direction().normalize() * (factors.y * scale);
            Shape::Rod {
                ends: [center - half, center + half],
                radius: factors.x * scale,
                is_round: kind == 6,
            }
        }
        _ => {
            let (forward, stop) = (r.turned(factors * scale, center), r.direction().normalize());
            Shape::RodImage { forward, stop, radius: r.between(0.1, 1.0), is_round: r.once_in(2) }
        }
    }
}

/// Checks that after a hit from outside on a convex shape, no outward ray hits it again.
fn no_acne(r: &mut Random, tally: &mut Tally, kind: usize) {
    let scale = r.scale(-60..=60);
    let far = if r.once_in(2) { 1.0 } else { r.scale(0..=30) };
    let center = r.point() * scale * far;
    let shape = some_shape(r, kind, center, scale);
    let origin = center + r.direction().normalize() * (8.0 * scale);
    let world = World::new(vec![shape]);
    let Some(found) = world.cast(origin, center + r.point() * scale - origin) else { return };
    tally.ask(world.is_rounded(&found), || format!("{shape:?} {found:?}"));
    let normal = found.surface.facing_normal();
    let incoming = found.arrived.direction();
    let mut directions = vec![incoming - normal * (2.0 * incoming.dot(normal)), normal];
    directions.extend((0..3).map(|_| r.direction_towards(normal)));
    // One direction is nearly along the surface.
    let along = normal.cross(r.direction());
    directions.push(along + normal * r.scale(-60..=-10));
    for direction in directions {
        if direction.dot(normal) > 0.0 {
            let again = world.leave(&found, direction);
            tally.ask(again.is_none(), || {
                format!("{shape:?} {found:?} leaves along {direction:?}: {again:?}")
            });
        }
    }
}

/// Returns the width of a gap between two surfaces at coordinates of about 1.
fn some_gap(r: &mut Random) -> f64 {
    r.pick(&[1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-7, 1e-9]) * r.between(0.5, 1.0)
}

/// Checks that a ray that leaves the first surface hits the second one, at the right point.
fn crosses(tally: &mut Tally, world: &World, from: &Found, direction: DVec3, slot: usize) {
    let next = world.leave(from, direction);
    let right = next.as_ref().is_some_and(|next| next.slot() == slot && world.is_met_right(from, next));
    tally.ask(right, || {
        format!("{:?}: {from:?} leaves along {direction:?}: {next:?}, not {slot}", world.shapes)
    });
}

/// Checks rays across a narrow gap between a plane and a shape, from the plane to the shape and back.
fn gap_over_plane(r: &mut Random, tally: &mut Tally, kind: usize) {
    let gap = some_gap(r);
    let center = r.point();
    let shape = some_shape(r, kind, center, 1.0);
    let normal = if kind == 2 { r.pick(&DVec3::AXES) * r.sign() } else { r.direction().normalize() };
    // The lowest point of the shape along the normal, and its depth below the centre.
    let (lowest, reach) = match &shape {
        Shape::Ball { radius, .. } => (center - normal * *radius, *radius),
        Shape::Aligned { min, max } => {
            let lowest = DVec3::select(normal.cmpgt(DVec3::ZERO), *min, *max);
            let lowest = DVec3::select(normal.cmpeq(DVec3::ZERO), (*min + *max) * 0.5, lowest);
            (lowest, (center - lowest).dot(normal))
        }
        Shape::Ellipsoid { forward, .. } => {
            let own = forward.matrix3.transpose() * normal;
            (center - forward.matrix3 * own.normalize(), own.length())
        }
        Shape::Turned { forward, .. } => {
            let own = forward.matrix3.transpose() * normal;
            (center - forward.matrix3 * own.signum(), own.abs().element_sum())
        }
        Shape::Rod { ends: [from, to], radius, is_round } => {
            let axis = (*to - *from).normalize();
            let end = if axis.dot(normal) > 0.0 { *from } else { *to };
            let down = if *is_round { normal } else { normal - axis * axis.dot(normal) };
            let lowest = end - down.normalize_or_zero() * *radius;
            (lowest, (center - lowest).dot(normal))
        }
        Shape::Plane { .. } | Shape::RodImage { .. } => unreachable!(),
    };
    let plane = Shape::Plane { point: center - normal * (reach + gap), normal };
    let world = World::new(if r.once_in(2) { vec![plane, shape] } else { vec![shape, plane] });
    let plane_slot = usize::from(!matches!(world.shapes[0], Shape::Plane { .. }));
    let below = lowest - normal * (gap + 2.0);
    // A ray from the plane up into the shape, aimed at a point inside, a little above the lowest one.
    let inside = lowest + (center - lowest) * r.between(0.05, 0.9);
    let aside = normal.cross(r.direction()) * (gap * r.number());
    if let Some(found) = world.cast(below + aside, normal) {
        let direction = inside - found.surface.point;
        tally.ask(found.slot() == plane_slot && world.is_rounded(&found), || format!("{found:?}"));
        crosses(tally, &world, &found, direction, 1 - plane_slot);
    }
    // A ray from the shape down to the plane, after a hit on the shape from inside.
    let down = lowest - inside + aside;
    if let Some(found) = world.cast(inside, down) {
        tally.ask(found.slot() != plane_slot && world.is_rounded(&found), || format!("{found:?}"));
        let direction = if r.once_in(2) { down } else { -r.direction_towards(normal) };
        if direction.dot(found.surface.normal) > 0.0 && direction.dot(normal) < -1e-6 {
            crosses(tally, &world, &found, direction, plane_slot);
        }
    }
}

/// Checks rays across a narrow gap between nested shapes, from the outer one inwards and from the inner one outwards.
fn gap_between_nested(r: &mut Random, tally: &mut Tally) {
    let gap = some_gap(r);
    let center = r.point();
    let size = r.extents();
    let (inner, outer) = if r.once_in(2) {
        let radius = size.x;
        (Shape::Ball { center, radius }, Shape::Ball { center, radius: radius * (1.0 + gap) })
    } else {
        let more = size * (1.0 + gap);
        let around = |half: DVec3| Shape::Aligned { min: center - half, max: center + half };
        (around(size), around(more))
    };
    let world = World::new(if r.once_in(2) { vec![inner, outer] } else { vec![outer, inner] });
    let radius = |shape: &Shape| match shape {
        Shape::Ball { radius, .. } => *radius,
        Shape::Aligned { min, max } => (max.x - min.x) * 0.5,
        _ => unreachable!(),
    };
    let inner_slot = usize::from(radius(&world.shapes[0]) > radius(&world.shapes[1]));
    let inside = center + r.point() * (0.3 * size.min_element());
    let origin = inside + r.direction().normalize() * 12.0;
    if let Some(found) = world.cast(origin, inside - origin) {
        tally.ask(found.slot() != inner_slot && world.is_rounded(&found), || format!("{found:?}"));
        crosses(tally, &world, &found, inside - found.surface.point, inner_slot);
    }
    if let Some(found) = world.cast(inside, r.direction()) {
        tally.ask(found.slot() == inner_slot && world.is_rounded(&found), || format!("{found:?}"));
        let direction = r.direction_towards(found.surface.normal);
        if direction.dot(found.surface.normal) > 0.0 {
            crosses(tally, &world, &found, direction, 1 - inner_slot);
        }
    }
}

/// Checks the occlusion of a light by a sphere on a plane, from a point of the plane near the contact.
fn contact_shadow(r: &mut Random, tally: &mut Tally) {
    let level = r.once_in(2);
    let normal = if level { DVec3::Y } else { r.direction().normalize() };
    let contact = r.point() * r.pick(&[0.0, 1.0, 16.0]);
    let any = r.extents().x;
    let radius = r.pick(&[1.0, 0.5, any]);
    let ball = Shape::Ball { center: contact + normal * radius, radius };
    let plane = Shape::Plane { point: contact, normal };
    let world = World::new(if r.once_in(2) { vec![plane, ball] } else { vec![ball, plane] });
    let plane_slot = usize::from(matches!(world.shapes[0], Shape::Ball { .. }));
    let sideways = normal.cross(r.direction());
    if sideways.length() < 1e-3 {
        return;
    }
    let sideways = sideways.normalize();
    let way = libm::exp10(-6.0 * r.between(0.0, 1.0)) * radius;
    let point = contact + sideways * way;
    // The ray comes from below, or from above at so low an angle that the ball is not in its path.
    let from = if r.once_in(2) { -normal } else { (sideways + normal * (way / radius)).normalize() };
    let Some(floor) = world.cast(point + from * 3.0, -from) else { return };
    if floor.slot() != plane_slot {
        return;
    }
    // The ball rises steeply over its contact: only low light from behind can reach the point.
    let elevation =
        if r.once_in(2) { way / radius * r.between(0.0, 4.0) } else { FRAC_PI_2 * r.between(0.0, 1.0) };
    let ((up, level), (across, ahead)) = (libm::sincos(elevation), libm::sincos(PI * r.between(-1.0, 1.0)));
    let light = normal * up + (sideways * ahead + normal.cross(sideways) * across) * level;
    if light.dot(normal) <= 0.0 {
        return;
    }
    let answer = ball.met_by(floor.surface.point, light);
    let shadow = world.leave(&floor, light);
    tally.ask(shadow.is_some() == answer.first().is_some(), || {
        format!("{:?}: {floor:?} looks towards {light:?}: {shadow:?}", world.shapes)
    });
}

/// Checks that a straight ray through the middle of nested shells hits each of them twice, in order.
fn nested_shells(r: &mut Random, tally: &mut Tally) {
    let count = 2 + r.index(5);
    let kind = r.pick(&[0, 2, 3, 4]);
    let center = r.point() * r.pick(&[0.0, 1.0, 8.0]);
    let factors = r.extents();
    let round_or_along_axes = kind < 3;
    let forward = if round_or_along_axes { DAffine3::IDENTITY } else { r.turned(factors, DVec3::ZERO) };
    let gap = r.pick(&[0.5, 0.1, 1e-3, 1e-5, 1e-8]);
    let mut sizes: Vec<(usize, f64)> = (0..count).map(|index| (0, 1.0 + gap * index as f64)).collect();
    // The slots are in any order.
    let mut order: Vec<usize> = (0..count).collect();
    for index in 0..count {
        order.swap(index, r.index(count));
    }
    let mut shapes = vec![Shape::Ball { center, radius: 1.0 }; count];
    for (place, (slot, size)) in sizes.iter_mut().enumerate() {
        *slot = order[place];
        let around = DVec3::splat(*size);
        let scaled = DAffine3 { matrix3: forward.matrix3 * *size, translation: center };
        shapes[*slot] = match kind {
            0 => Shape::Ball { center, radius: *size },
            2 => Shape::Aligned { min: center - around, max: center + around },
            3 => Shape::Ellipsoid { forward: scaled, radius: 1.0 },
            _ => Shape::Turned { forward: scaled, half: DVec3::ONE },
        };
    }
    let inwards = sizes.iter().rev().map(|(slot, _)| *slot);
    let expected: Vec<usize> = inwards.chain(sizes.iter().map(|(slot, _)| *slot)).collect();
    let world = World::new(shapes);
    let origin = center + r.direction().normalize() * 16.0;
    let middle = center + forward.matrix3 * r.point() * 0.3;
    let mut met = Vec::new();
    let mut next = world.cast(origin, middle - origin);
    while let Some(found) = next.filter(|_| met.len() <= expected.len()) {
        met.push(found.slot());
        next = world.go_on(&found);
    }
    tally.ask(met == expected, || {
        format!("{:?} {origin:?} {middle:?}: {met:?} instead of {expected:?}", world.shapes)
    });
}

/// Checks a ray into a shape in any direction, its exit on the far side, and its path away.
fn transmission(r: &mut Random, tally: &mut Tally, kind: usize) {
    let scale = r.scale(-40..=40);
    let far = if r.once_in(2) { 1.0 } else { r.scale(0..=10) };
    let center = r.point() * scale * far;
    let shape = some_shape(r, kind, center, scale);
    let origin = center + r.direction().normalize() * (8.0 * scale);
    let world = World::new(vec![shape]);
    let Some(found) = world.cast(origin, center + r.point() * scale - origin) else { return };
    let inward = -r.direction_towards(found.surface.normal);
    let direction = if r.once_in(4) { found.arrived.direction() } else { inward };
    if direction.dot(found.surface.normal) >= 0.0 {
        return;
    }
    let Some(out) = world.leave(&found, direction) else {
        return tally.ask(false, || format!("{shape:?} {found:?} goes in along {direction:?} and never out"));
    };
    let right = out.surface.hit.far && !out.surface.from_outside && world.is_met_from_inside(&out);
    tally.ask(right, || format!("{shape:?} {found:?} goes in along {direction:?}: {out:?}"));
    let away = r.direction_towards(out.surface.normal);
    for direction in [out.arrived.direction(), away] {
        if direction.dot(out.surface.normal) > 0.0 {
            let again = world.leave(&out, direction);
            tally.ask(again.is_none(), || format!("{shape:?} {out:?} leaves along {direction:?}: {again:?}"));
        }
    }
}

/// Checks two solids with a common face, or a solid on a plane. A ray away from both hits neither; a ray into one of them leaves it on its
/// far side.
fn flush_faces(r: &mut Random, tally: &mut Tally) {
    let axis = r.index(3);
    let up = DVec3::AXES[axis];
    let level = if r.once_in(2) { r.number() } else { r.whole(16) * 0.25 };
    let (mut low, mut high) = (r.point() * 0.5 - 1.5, r.point() * 0.5 + 1.5);
    let (bottom, top) = (low[axis] + level - 1.0, high[axis] + level + 1.0);
    (low[axis], high[axis]) = (level, top);
    let upper = Shape::Aligned { min: low, max: high };
    let standing = r.index(3);
    let other = match standing {
        0 => Shape::Plane { point: low, normal: up * r.sign() },
        1 => {
            (low[axis], high[axis]) = (bottom, level);
            Shape::Aligned { min: low, max: high }
        }
        _ => {
            // The same face by a transform of quarter turns, whose numbers are exact.
            let mut center = (r.point() * 2.0).round() * 0.125;
            center[axis] = level - 1.0;
            let matrix3 = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
            Shape::Turned { forward: DAffine3 { matrix3, translation: center }, half: DVec3::ONE }
        }
    };
    // The face must be exactly common to both.
    if standing == 2 && (level - 1.0) + 1.0 != level {
        return;
    }
    let world = World::new(if r.once_in(2) { vec![upper, other] } else { vec![other, upper] });
    let upper_slot =
        usize::from(!matches!(world.shapes[0], Shape::Aligned { min, .. } if min[axis] == level));
    let is_plane = standing == 0;
    // A point in the common face.
    let mut point = r.point() * 0.4;
    point[axis] = level;
    let from_above = r.once_in(2);
    let mut origin = point + r.point() * 0.2;
    origin[axis] = if from_above { level + 0.5 } else { level - 0.5 };
    let Some(found) = world.cast(origin, point - origin) else {
        return tally.ask(false, || format!("{:?} not met from {origin:?}", world.shapes));
    };
    tally.ask(found.surface.point[axis] == level, || format!("{:?} {found:?}", world.shapes));
    for direction in [r.direction_towards(up), -r.direction_towards(up)] {
        if direction[axis] == 0.0 {
            continue;
        }
        let next = world.leave(&found, direction);
        let into_upper = direction[axis] > 0.0;
        if is_plane && !into_upper {
            tally.ask(next.is_none(), || {
                format!("{:?} {found:?} leaves along {direction:?}: {next:?}", world.shapes)
            });
            continue;
        }
        let slot = if into_upper { upper_slot } else { 1 - upper_slot };
        let comes_out = next.clone().filter(|next| next.slot() == slot && !next.surface.from_outside);
        tally.ask(comes_out.is_some(), || {
            format!("{:?} {found:?} goes in along {direction:?}: {next:?}", world.shapes)
        });
        // A ray that continues hits nothing more, unless the point was rounded into the common face and thus touches it.
        if let Some(out) = comes_out.filter(|out| out.surface.point[axis] != level) {
            let again = world.go_on(&out);
            tally.ask(again.is_none(), || format!("{:?} {out:?} goes on: {again:?}", world.shapes));
        }
    }
    seam_from_outside(r, tally, &world, axis, level);
}

/// Checks that a ray from the outer edge of a common face, away from both boxes, hits neither.
fn seam_from_outside(r: &mut Random, tally: &mut Tally, world: &World, axis: usize, level: f64) {
    let [Shape::Aligned { min, max }, Shape::Aligned { .. }] = world.shapes[..] else { return };
    let side = (axis + 1) % 3;
    let outward = DVec3::AXES[side];
    let mut point = (min + max) * 0.5;
    (point[side], point[axis]) = (max[side], level);
    let origin = point + outward * 2.0;
    let Some(found) = world.cast(origin, -outward) else {
        return tally.ask(false, || format!("{:?} leaks at {point:?}", world.shapes));
    };
    let direction = r.direction_towards(outward);
    if direction.dot(outward) > 0.0 && found.surface.normal == outward {
        let again = world.leave(&found, direction);
        tally.ask(again.is_none(), || {
            format!("{:?} {found:?} leaves along {direction:?}: {again:?}", world.shapes)
        });
    }
}

/// Checks copies of one shape: outwards a ray hits none of them, inwards it leaves the first.
fn coincident_copies(r: &mut Random, tally: &mut Tally) {
    let kind = r.pick(&[0, 2, 3, 4, 5, 6, 7]);
    // Some counts exceed the number that the kernel tracks.
    let count = 2 + r.index(11);
    let center = r.point();
    let shape = some_shape(r, kind, center, 1.0);
    let world = World::new(vec![shape; count]);
    let origin = center + r.direction().normalize() * 8.0;
    let Some(found) = world.cast(origin, center + r.point() * 0.5 - origin) else { return };
    tally.ask(found.slot() == 0, || format!("{count} of {shape:?} {found:?}"));
    let normal = found.surface.normal;
    let outward = r.direction_towards(normal);
    if outward.dot(normal) > 0.0 {
        let again = world.leave(&found, outward);
        tally
            .ask(again.is_none(), || format!("{count} of {shape:?} {found:?} leaves {outward:?}: {again:?}"));
    }
    let through = world.go_on(&found);
    tally.ask(through.as_ref().is_some_and(|out| out.slot() == 0 && out.surface.hit.far), || {
        format!("{count} of {shape:?} {found:?} goes on: {through:?}")
    });
    if let Some(out) = through {
        let again = world.go_on(&out);
        tally.ask(again.is_none(), || format!("{count} of {shape:?} {out:?} goes on: {again:?}"));
    }
}
