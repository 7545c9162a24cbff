//! Tests of random scenes that extend each other, against one scene in which the changes have been made by hand.

use std::fs;

use rayreel::Scene;
use rayreel::scene::Override;

use crate::reload::described::described;
use crate::reload::random::Random;

/// A value of a scene.
#[derive(Clone, Debug)]
enum Value {
    Plain(String),
    /// Fields in round brackets, with the word before them.
    Group(&'static str, Vec<(String, Value)>),
    Map(Vec<(String, Value)>),
    List(Vec<Value>),
}
use Value::{Group, List, Map, Plain};

impl Value {
    /// Returns the notation of the value, with random separators.
    fn text(&self, random: &mut Random) -> String {
        let (opening, closing, members): (String, _, Vec<String>) = match self {
            Plain(text) => return text.clone(),
            Group(word, fields) => {
                let fields = fields.iter().map(|(name, value)| format!("{name}: {}", value.text(random)));
                (format!("{word}("), ")", fields.collect())
            }
            Map(entries) => {
                let entries =
                    entries.iter().map(|(name, value)| format!("\"{name}\": {}", value.text(random)));
                ("{".to_owned(), "}", entries.collect())
            }
            List(items) => ("[".to_owned(), "]", items.iter().map(|item| item.text(random)).collect()),
        };
        let mut text = opening;
        for (index, member) in members.iter().enumerate() {
            text += member;
            text += if index + 1 < members.len() {
                random.pick(&[", ", " , /* ), */ ", ",\n  "])
            } else {
                random.pick(&["", "", ",", " // {, \"\n", " , // (\n "])
            };
        }
        text + closing
    }

    fn field(&self, name: &str) -> Option<&Value> {
        let Group(_, fields) = self else { return None };
        fields.iter().find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// Returns the key of an item in a list of the scene.
    fn key(&self, list: &str) -> Option<String> {
        let part = |name: &str| self.field(name).map(|value| format!("{value:?}"));
        match list {
            "animate" => Some(format!("{:?} {:?} {:?}", part("target"), part("material"), part("channel"))),
            _ => part("name"),
        }
    }
}

/// Makes a change by hand.
fn changed(base: Value, change: Value, field: &str) -> Value {
    match (base, change) {
        (Group(word, mut base), Group(new, change)) if word == new || new.is_empty() => {
            let excludes = |field: &str, other: &str| {
                [["target", "view"], ["screen", "fov"]]
                    .iter()
                    .any(|pair| pair.contains(&field) && pair.contains(&other))
            };
            base.retain(|(field, _)| {
                change.iter().any(|(name, _)| name == field)
                    || !change.iter().any(|(name, _)| excludes(field, name))
            });
            Group(word, entries(base, change))
        }
        (Map(base), Map(change)) => Map(entries(base, change)),
        (List(mut base), List(change)) if ["entities", "animate", "spawn"].contains(&field) => {
            for item in change {
                let same = |old: &&mut Value| item.key(field).is_some() && old.key(field) == item.key(field);
                match base.iter_mut().find(same) {
                    Some(old) if field == "animate" => *old = item,
                    Some(old) => *old = changed(old.clone(), item, ""),
                    None => base.push(item),
                }
            }
            List(base)
        }
        (_, change) => change,
    }
}

fn entries(mut base: Vec<(String, Value)>, change: Vec<(String, Value)>) -> Vec<(String, Value)> {
    for (name, value) in change {
        match base.iter_mut().find(|(known, _)| *known == name) {
            Some((_, old)) => *old = changed(old.clone(), value, &name),
            None => base.push((name, value)),
        }
    }
    base
}

/// Leaves an entity out by hand, with its animations.
fn left_out(scene: &mut Value, name: &str) {
    let Group(_, fields) = scene else { return };
    let quoted = format!("{:?}", Plain(format!("\"{name}\"")));
    for (field, value) in fields {
        let key = if field == "entities" { "name" } else { "target" };
        if let List(items) = value {
            items.retain(|item| item.field(key).is_none_or(|value| format!("{value:?}") != quoted));
        }
    }
}

/// A generator of scenes, or of changes of scenes, in which fields are missing.
struct Generator<'a> {
    random: &'a mut Random,
    is_change: bool,
}

impl Generator<'_> {
    fn group(&mut self, word: &'static str, fields: &[(&str, String)]) -> Value {
        let fields = fields.iter().filter(|_| !(self.is_change && self.random.once_in(2)));
        Group(word, fields.map(|(name, value)| ((*name).to_owned(), Plain(value.clone()))).collect())
    }

    /// Adds a field, mostly.
    fn add(&mut self, fields: &mut Vec<(String, Value)>, name: &str, value: impl FnOnce(&mut Self) -> Value) {
        if !self.random.once_in(if self.is_change { 2 } else { 12 }) {
            let value = value(self);
            fields.push((name.to_owned(), value));
        }
    }

    fn number(&mut self) -> String {
        format!("{:?}", 0.25 + self.random.share())
    }

    fn camera(&mut self) -> Value {
        let (x, focus) = (self.random.number(), 4 + self.random.index(5));
        let mut fields = Vec::new();
        if !(self.is_change && self.random.once_in(2)) {
            fields.push(("position".to_owned(), Plain(format!("({x:?}, 1, -9)"))));
        }
        if !(self.is_change && self.random.once_in(2)) {
            let view = self.random.pick(&["target", "view"]);
            fields.push((view.to_owned(), Plain(format!("({:?}, 0.25, 8)", self.random.number()))));
        }
        self.add(&mut fields, "roll", |this| Plain(this.number()));
        if self.random.once_in(2) {
            self.add(&mut fields, "fov", |this| Plain(format!("{}", 30 + this.random.index(40))));
        } else {
            let height = self.number();
            self.add(&mut fields, "screen", |this| {
                this.group("", &[("distance", "1".to_owned()), ("height", height)])
            });
        }
        let aperture = self.number();
        self.add(&mut fields, "lens", |this| {
            this.group("", &[("aperture", aperture), ("focus", focus.to_string())])
        });
        Group("", fields)
    }

    fn material(&mut self) -> Value {
        let mut fields = Vec::new();
        let [one, other] = [self.random.share(), self.random.share()].map(|share| format!("{share:?}"));
        self.add(&mut fields, "k_a", |_| Plain(one.clone()));
        self.add(&mut fields, "k_d", |_| Plain(other.clone()));
        self.add(&mut fields, "color", |this| Plain(this.random.color()));
        self.add(&mut fields, "specular", |this| {
            this.group("", &[("k_s", one), ("shininess", "20".to_owned())])
        });
        self.add(&mut fields, "reflective", |this| this.group("", &[("k_r", other)]));
        Group("", fields)
    }

    fn entity(&mut self, name: Option<usize>) -> Value {
        let is_changed = self.is_change && name.is_some_and(|name| name < 4);
        let name = name.map(|name| ("name".to_owned(), Plain(format!("\"n{name}\""))));
        let mut fields: Vec<(String, Value)> = name.into_iter().collect();
        let (place, size) = (self.random.triple(), self.number());
        self.add(&mut fields, "transform", |this| {
            this.group(
                "",
                &[("translation", place), ("rotation", "Euler(0, 30, 0)".to_owned()), ("scale", size)],
            )
        });
        let (word, field, size) = match self.random.index(6) {
            0 => ("Box", "size", "(1, 2, 1)".to_owned()),
            1..=3 if is_changed => ("", "radius", self.number()),
            _ => ("Sphere", "radius", self.number()),
        };
        if !(is_changed && self.random.once_in(2)) {
            fields.push(("shape".to_owned(), Group(word, vec![(field.to_owned(), Plain(size))])));
        }
        let material = format!("\"m{}\"", self.random.index(3));
        fields.push(("material".to_owned(), Plain(material)));
        let (kind, light) = (self.random.pick(&["Point", "Directional"]), self.random.light());
        let kind: &'static str = if kind == "Point" { "Point" } else { "Directional" };
        self.add(&mut fields, "light", |this| {
            this.group(kind, &[("intensity", light), ("casts_shadows", "false".to_owned())])
        });
        Group("", fields)
    }

    fn animation(&mut self) -> Value {
        let (target, channel) = match self.random.index(3) {
            0 => ("camera".to_owned(), "Position"),
            _ => (format!("n{}", self.random.index(4)), self.random.pick(&["Translation", "Scale"])),
        };
        let key = self.random.triple();
        let fields = [
            ("target", format!("\"{target}\"")),
            ("channel", channel.to_owned()),
            ("track", format!("Keys([(0, {key}), (1, (1, 1, 1))])")),
        ];
        Group("", fields.map(|(name, value)| (name.to_owned(), Plain(value))).into())
    }

    fn scene(&mut self) -> Value {
        let mut fields = Vec::new();
        let (width, height) = (8 + self.random.index(9), 6 + self.random.index(5));
        self.add(&mut fields, "film", |this| {
            this.group(
                "",
                &[
                    ("width", width.to_string()),
                    ("height", height.to_string()),
                    ("transfer", "Classic".to_owned()),
                ],
            )
        });
        let seconds = self.number();
        self.add(&mut fields, "timeline", |this| {
            this.group("", &[("fps", width.to_string()), ("duration", seconds)])
        });
        self.add(&mut fields, "quality", |this| {
            this.group("", &[("depth", height.to_string()), ("cutoff", "0".to_owned())])
        });
        self.add(&mut fields, "sampling", |this| {
            this.group(
                "",
                &[("samples", "2".to_owned()), ("seed", width.to_string()), ("noise", "PerFrame".to_owned())],
            )
        });
        if !(self.is_change && self.random.once_in(2)) {
            fields.push(("camera".to_owned(), self.camera()));
        }
        self.add(&mut fields, "cameras", |this| Map(vec![("side".to_owned(), this.camera())]));
        self.add(&mut fields, "shots", |_| List(vec![Plain("(0, \"camera\")".to_owned())]));
        self.add(&mut fields, "ambient", |this| Plain(this.random.light()));
        self.add(&mut fields, "ambient_occlusion", |this| {
            let distance = this.number();
            if this.is_change && this.random.once_in(3) {
                return Plain("None".to_owned());
            }
            this.group("", &[("samples", "2".to_owned()), ("distance", distance)])
        });
        let colors = [self.random.color(), self.random.color()];
        self.add(&mut fields, "background", |this| {
            if this.is_change && this.random.once_in(2) {
                return Plain(colors[0].clone());
            }
            this.group("", &[("bottom", colors[0].clone()), ("top", colors[1].clone())])
        });
        self.add(&mut fields, "fog", |this| {
            let density = this.number();
            if this.is_change && this.random.once_in(3) {
                return Plain("None".to_owned());
            }
            this.group("", &[("color", colors[0].clone()), ("density", density)])
        });
        let count = if self.is_change { self.random.index(3) } else { 3 };
        let materials = (0..count).map(|index| (format!("m{index}"), self.material())).collect();
        fields.push(("materials".to_owned(), Map(materials)));
        let mut names: Vec<usize> = (0..4).collect();
        if self.is_change {
            names.retain(|_| !self.random.once_in(2));
        }
        let mut entities: Vec<Value> = names.into_iter().map(|name| self.entity(Some(name))).collect();
        if !self.is_change {
            let place = self.random.index(4);
            entities.insert(place, self.entity(None));
        } else if self.random.once_in(3) {
            let name = 4 + self.random.index(2);
            entities.push(self.entity(Some(name)));
        }
        fields.push(("entities".to_owned(), List(entities)));
        if self.random.once_in(3) {
            fields.push(("spawn".to_owned(), List(vec![Plain("Script(\"spawn(#{})\")".to_owned())])));
        }
        self.add(&mut fields, "animate", |this| List(vec![this.animation()]));
        Group("", fields)
    }
}

/// Overrides that apply to many of the scenes.
const OVERRIDES: [&str; 6] = [
    "film.width=9",
    "camera.roll=5",
    "camera.lens.aperture=0.5",
    "entities.n1.shape.radius=2",
    "entities.0.transform.translation=(0, 1, 2)",
    "materials.\"m0\"=(k_d: 0.5)",
];

#[test]
fn extended_scenes_equal_scenes_changed_by_hand() {
    const CASES: usize = 1000;
    let (mut good, mut with_effect) = (0, 0);
    for seed in 0..CASES {
        let random = &mut Random(seed as u64);
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mut by_hand = Generator { random, is_change: false }.scene();
        let mut texts = vec![by_hand.text(random)];
        fs::write(path("0.ron"), &texts[0]).unwrap();
        let changes = 1 + random.index(2);
        for index in 0..changes {
            let change = Generator { random, is_change: true }.scene();
            let without = random.once_in(4).then(|| format!("n{}", random.index(4)));
            let without =
                without.filter(|name| texts[0].contains(&format!("name: \"{name}\"")) && index == 0);
            if let Some(name) = &without {
                left_out(&mut by_hand, name);
            }
            let Group(word, mut fields) = change.clone() else { panic!() };
            by_hand = changed(by_hand, change, "");
            fields
                .extend(without.map(|name| ("without".to_owned(), List(vec![Plain(format!("\"{name}\""))]))));
            fields.insert(0, ("extends".to_owned(), Plain(format!("\"{index}.ron\""))));
            let text = Group(word, fields).text(random);
            fs::write(path(&format!("{}.ron", index + 1)), &text).unwrap();
            texts.push(text);
        }
        fs::write(path("by_hand.ron"), by_hand.text(random)).unwrap();
        let overrides: Vec<Override> =
            OVERRIDES.iter().filter(|_| random.once_in(8)).map(|one| one.parse().unwrap()).collect();
        let load = |name: &str| Scene::load_overridden(&path(name), &overrides);
        let about = || {
            format!("seed {seed}\n{}\n--- by hand\n{}", texts.join("\n---\n"), by_hand.text(&mut Random(0)))
        };
        match (load(&format!("{changes}.ron")), load("by_hand.ron")) {
            (Ok((scene, _)), Ok((expected, _))) => {
                assert_eq!(scene.timeline, expected.timeline, "{}", about());
                let (found, expected) = (described(&scene.world, false), described(&expected.world, false));
                for (found, expected) in found.iter().zip(&expected) {
                    assert_eq!(found, expected, "{}", about());
                }
                assert_eq!(found.len(), expected.len(), "{}", about());
                let base = Scene::load(&path("0.ron"));
                with_effect += usize::from(base.is_ok_and(|base| described(&base.world, false) != found));
                good += 1;
            }
            // The order of the texts decides which further mistakes are found.
            (Err(_), Err(_)) => {}
            (Err(found), Ok(_)) => panic!("{found}\n{}", about()),
            (Ok(_), Err(expected)) => panic!("only by hand: {expected}\n{}", about()),
        }
    }
    assert!(
        good > CASES / 4 && with_effect > good / 2,
        "{good} are good, {with_effect} differ from their base"
    );
}
