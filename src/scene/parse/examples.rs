//! Examples of values with several forms: the type name in the format, the noun, and an example of each form. Forms that are single words
//! may be numerous; only a few of them are listed.

/// A type of value, and the forms in which it is written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Example {
    /// The type name in the format.
    name: &'static str,
    pub(super) noun: &'static str,
    pub(super) forms: &'static [&'static str],
}

const EXAMPLES: [Example; 21] = [
    Example {
        name: "Rotation",
        noun: "a rotation",
        forms: &["Euler(0, 90, 0)", "AxisAngle((0, 1, 0), 90)", "Quat(0, 0, 0, 1)"],
    },
    Example {
        name: "Shape",
        noun: "a shape",
        forms: &[
            "Sphere(radius: 1)",
            "Plane(normal: (0, 1, 0))",
            "Box(size: (1, 1, 1))",
            "Cylinder(radius: 0.2, from: (0, 0, 0), to: (0, 2, 0))",
            "Capsule(radius: 0.2, from: (0, 0, 0), to: (0, 2, 0))",
        ],
    },
    Example {
        name: "Pattern",
        noun: "a pattern",
        forms: &[
            "Checker(color: (20, 20, 20), size: 1)",
            "Stripes(color: (20, 20, 20), size: 1)",
            "Bricks(color: (180, 180, 170), size: (0.5, 0.15, 0.25), mortar: 0.02)",
            "Gradient(color: (20, 20, 20), size: 2)",
            "Noise(color: (20, 20, 20), size: 1)",
        ],
    },
    Example {
        name: "AreaShape",
        noun: "a shape of an area light",
        forms: &["Sphere(radius: 0.5)", "Rectangle(width: 2, height: 1)"],
    },
    Example {
        name: "Light",
        noun: "a light",
        forms: &[
            "Point(intensity: (1, 1, 1))",
            "Directional(intensity: (1, 1, 1), direction: (0, -1, 0))",
            "Spot(intensity: (1, 1, 1), angle: 40)",
            "Area(shape: Sphere(radius: 0.5), intensity: (1, 1, 1))",
        ],
    },
    Example {
        name: "Track",
        noun: "a track",
        forms: &[
            "Keys([(0, ..), (2, ..)])",
            "Path(points: [(0, 1, 0), (4, 1, 2)], duration: 10)",
            "Orbit(center: (0, 1, 0), radius: 5, duration: 10)",
            "Turns(turns: 2, duration: 4)",
            "Along",
            "Script(\"sin(t)\")",
            "ScriptFile(\"wave.rhai\")",
        ],
    },
    Example { name: "Script", noun: "a script", forms: &["Script(\"..\")", "File(\"stars.rhai\")"] },
    Example {
        name: "Easing",
        noun: "an easing",
        forms: &[
            "Linear",
            "EaseInOut",
            "Hold",
            "Steps(8)",
            "Bezier(0.25, 0.1, 0.25, 1)",
            "Handles(0.5, -0.5)",
        ],
    },
    Example { name: "Repeat", noun: "a way to repeat", forms: &["Clamp", "Loop", "PingPong"] },
    Example { name: "Transfer", noun: "a transfer", forms: &["Classic", "Srgb"] },
    Example { name: "Space", noun: "a space", forms: &["LeftHanded", "RightHanded"] },
    Example { name: "Style", noun: "a style", forms: &["BallAndStick", "Licorice", "Cell"] },
    Example {
        name: "ScaleBy",
        noun: "a scale of particles",
        forms: &["Column(\"r\")", "VanDerWaals", "Covalent"],
    },
    Example {
        name: "ColorBy",
        noun: "a colouring",
        forms: &["Element", "Category(\"type\")", "Map(column: \"speed\", map: Viridis, range: (0, 3))"],
    },
    Example { name: "ColorMap", noun: "a colour map", forms: &["Viridis", "Inferno", "Turbo", "CoolWarm"] },
    Example { name: "Between", noun: "a way between frames", forms: &["Hold", "Linear"] },
    Example { name: "End", noun: "an end", forms: &["Hold", "Loop"] },
    Example {
        name: "OverlayItem",
        noun: "an overlay",
        forms: &[
            "Text(text: \"t = {time} s\")",
            "ScaleBar(length: 10, label: \"10 nm\")",
            "Legend(cloud: \"gas\")",
        ],
    },
    Example { name: "Anchor", noun: "an anchor", forms: &["TopLeft", "Top", "BottomRight"] },
    Example { name: "Norm", noun: "a norm of errors", forms: &["Rms", "Max", "P99"] },
    Example { name: "Noise", noun: "a kind of noise", forms: &["Fixed", "PerFrame"] },
];

/// Returns the example for a type of the format; by default, the example for channels.
pub(super) fn of(name: &str) -> Example {
    let channel =
        Example { name: "Channel", noun: "a channel", forms: &["Translation", "Rotation", "Color", "Fov"] };
    EXAMPLES.into_iter().find(|example| example.name == name).unwrap_or(channel)
}

/// Returns the example of a variant; `None` for a word that stands alone.
pub(in crate::scene) fn form_of(name: &str, word: &str) -> Option<&'static str> {
    of(name).form(word)
}

impl Example {
    /// Returns the noun without its article.
    pub(super) fn kind(self) -> &'static str {
        self.noun.split_once(' ').map_or(self.noun, |(_, kind)| kind)
    }

    /// Returns the form that starts with a word.
    pub(super) fn form(self, word: &str) -> Option<&'static str> {
        self.forms.iter().copied().find(|form| form.split('(').next() == Some(word))
    }

    /// Returns the fields of a form. The fields in its example come first.
    pub(super) fn ordered(self, word: &str, fields: &[&'static str]) -> Vec<&'static str> {
        let form = self.form(word).unwrap_or_default();
        let mut ordered = fields.to_vec();
        ordered.sort_by_key(|field| form.find(&format!("{field}:")).unwrap_or(form.len()));
        ordered
    }

    /// Lists the forms, for example `Sphere(radius: 1), Plane(normal: (0, 1, 0)) or Box(size: (1, 1, 1))`.
    pub(super) fn listed(self) -> String {
        match self.forms {
            [] => String::new(),
            [only] => (*only).to_owned(),
            [first @ .., last] => format!("{} or {last}", first.join(", ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use serde::de::DeserializeOwned;

    use super::*;
    use crate::scene::document::{
        AreaShapeDocument, BetweenDocument, ChannelDocument, ColorByDocument, ColorMapDocument,
        EasingDocument, EndDocument, LightDocument, NoiseDocument, NormDocument, PatternDocument,
        RepeatDocument, RotationDocument, ScaleByDocument, ScriptDocument, ShapeDocument, SpaceDocument,
        StyleDocument, TrackDocument, TransferDocument,
    };
    use crate::scene::parse::options;

    /// Checks that every example is valid, and that every word that takes a bracket has an example.
    fn check<T: DeserializeOwned>(name: &str) {
        use ron::Error;
        let example = of(name);
        assert_eq!(example.name, name);
        for form in example.forms {
            let text = form.replace("..)", "1)");
            assert!(options().from_str::<T>(&text).is_ok(), "{name}: {form}");
        }
        let unknown = options().from_str::<T>("NobodyKnows").err().map(|error| error.code);
        let Some(Error::NoSuchEnumVariant { expected, outer, .. }) = unknown else { panic!("{name}") };
        assert_eq!(outer.as_deref(), Some(name));
        for word in expected {
            let is_alone = options().from_str::<T>(word).is_ok();
            assert!(is_alone || example.form(word).is_some(), "{name} has no example of {word}");
        }
    }

    #[test]
    fn every_type_has_valid_examples() {
        check::<RotationDocument>("Rotation");
        check::<ShapeDocument>("Shape");
        check::<PatternDocument>("Pattern");
        check::<AreaShapeDocument>("AreaShape");
        check::<LightDocument>("Light");
        check::<TrackDocument<f64>>("Track");
        check::<ScriptDocument>("Script");
        check::<EasingDocument>("Easing");
        check::<RepeatDocument>("Repeat");
        check::<TransferDocument>("Transfer");
        check::<SpaceDocument>("Space");
        check::<StyleDocument>("Style");
        check::<ScaleByDocument>("ScaleBy");
        check::<ColorByDocument>("ColorBy");
        check::<ColorMapDocument>("ColorMap");
        check::<BetweenDocument>("Between");
        check::<EndDocument>("End");
        check::<NormDocument>("Norm");
        check::<NoiseDocument>("Noise");
        check::<ChannelDocument>("Channel");
    }
}
