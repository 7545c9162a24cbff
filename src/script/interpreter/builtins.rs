//! Names available to scripts, and the signatures of functions.

use super::context::ScriptContext;
use super::maths;

/// Signatures of the functions of spawning scripts.
const SPAWNING: [&str; 12] = [
    "spawn(map)",
    "sphere(radius)",
    "plane(normal)",
    "box(size)",
    "rectangle(width, height)",
    "euler(x, y, z)",
    "axis_angle(axis, degrees)",
    "quaternion(x, y, z, w)",
    "point(map)",
    "spot(map)",
    "directional(map)",
    "area(map)",
];

/// The purpose of a script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Computes the value of a channel.
    Drive,
    /// Spawns entities.
    Spawn,
}

/// The functions that a script can call.
pub(super) struct KnownFunctions<'a> {
    pub(super) own: &'a [String],
    pub(super) purpose: Purpose,
}

impl KnownFunctions<'_> {
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let usages = USUAL.iter().chain(self.purpose.usages());
        usages.map(|usage| name_in(usage)).chain(self.own.iter().map(String::as_str))
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.names().any(|known| known == name)
    }
}

impl Purpose {
    /// Returns the signatures of the functions that only scripts with this purpose have.
    fn usages(self) -> &'static [&'static str] {
        match self {
            Self::Drive => &READING,
            Self::Spawn => &SPAWNING,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Drive => Self::Spawn,
            Self::Spawn => Self::Drive,
        }
    }

    /// Returns the names of the variables and constants provided to scripts with this purpose.
    pub(super) fn variables(self) -> impl Iterator<Item = &'static str> {
        let given: &[&str] = match self {
            Self::Drive => &ScriptContext::NAMES,
            Self::Spawn => &[],
        };
        given.iter().copied().chain(maths::CONSTANTS.map(|(name, _)| name))
    }

    /// Returns the remedy for a name that only scripts with the other purpose, or scripts of other programs, know.
    pub(super) fn elsewhere(self, name: &str) -> Option<&'static str> {
        let functions = |purpose: Self| purpose.usages().iter().any(|usage| name_in(usage) == name);
        match self {
            Self::Drive if functions(self.other()) => {
                Some("it is for scripts in the scene's `spawn` list, which make entities")
            }
            Self::Spawn if functions(self.other()) || ScriptContext::NAMES.contains(&name) => Some(
                "it is for scripts that drive a value; one that spawns runs once, before there is a time",
            ),
            Self::Drive => match name {
                "clock" => Some("write `t / duration`, from 0 to 1, or `t`, in seconds"),
                "frame_number" | "frame_current" => Some("write `frame`, from 0"),
                "time" | "dt" => Some("write `t`, in seconds"),
                "fmod" => Some("write `mod(x, y)`"),
                _ => None,
            },
            Self::Spawn => None,
        }
    }
}

/// Signatures of the functions of all scripts.
const USUAL: [&str; 50] = [
    "sin(x)",
    "cos(x)",
    "tan(x)",
    "asin(x)",
    "acos(x)",
    "atan(x)",
    "atan2(y, x)",
    "sinh(x)",
    "cosh(x)",
    "tanh(x)",
    "exp(x)",
    "ln(x)",
    "log(x)",
    "log2(x)",
    "sqrt(x)",
    "cbrt(x)",
    "pow(x, y)",
    "hypot(x, y)",
    "abs(x)",
    "sign(x)",
    "floor(x)",
    "ceil(x)",
    "round(x)",
    "trunc(x)",
    "fract(x)",
    "mod(x, y)",
    "min(a, b)",
    "max(a, b)",
    "clamp(x, low, high)",
    "mix(a, b, share)",
    "step(edge, x)",
    "smoothstep(low, high, x)",
    "radians(x)",
    "degrees(x)",
    "random(i)",
    "noise(x)",
    "length(v)",
    "distance(a, b)",
    "normalize(v)",
    "dot(a, b)",
    "cross(a, b)",
    "sum(list)",
    "len(list)",
    "push(list, value)",
    "pop(list)",
    "append(a, b)",
    "reverse(list)",
    "contains(list, value)",
    "keys(map)",
    "range(from, to, step)",
];

/// Signatures of the functions of scripts that compute values.
const READING: [&str; 1] = ["value(name, channel, seconds)"];

fn name_in(usage: &str) -> &str {
    usage.split('(').next().unwrap_or(usage)
}

/// Returns the remedy that shows the signature of a function.
pub(super) fn usage(name: &str) -> Option<String> {
    let mut usages = USUAL.iter().chain(&READING).chain(&SPAWNING);
    let usage = usages.find(|usage| name_in(usage) == name)?;
    Some(format!("it is called as `{usage}`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::{Language, NoResult, limits};

    #[test]
    fn language_description_is_complete() {
        let description = include_str!("../language.md");
        for usage in USUAL.iter().chain(&READING).chain(&SPAWNING) {
            assert!(description.contains(&format!("`{usage}`")), "{usage}");
        }
        for name in Purpose::Drive.variables() {
            assert!(description.contains(&format!("`{name}`")), "{name}");
        }
        let section = description.split("# Limits").nth(1).unwrap();
        for limit in [
            "100 000 operations".to_owned(),
            "200 000, and 100 more".to_owned(),
            format!("{} values, maps {}, texts {} bytes", limits::LIST, limits::MAP, limits::TEXT),
            format!("{} variables", limits::VARIABLES),
            format!("{} values", limits::ARGUMENTS),
            format!("{} functions", limits::FUNCTIONS),
            format!("{} KiB", limits::SCRIPT >> 10),
            format!("{} MiB", limits::SPAWNED_TEXT >> 20),
            format!("{} calls", limits::CALLS),
            format!("{} deep, {} in functions", limits::NESTING, limits::NESTING_IN_FUNCTIONS),
        ] {
            let text = section.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(text.contains(&limit), "{limit}");
        }
        assert_eq!(
            (
                limits::OPERATIONS,
                limits::SPAWNING_OPERATIONS,
                limits::OPERATIONS_PER_ENTITY,
                limits::MOST_SPAWNING_OPERATIONS
            ),
            (100_000, 200_000, 100, 40_000_000)
        );
        assert_eq!((limits::ENTITIES, limits::SCRIPT, limits::SPAWNED_TEXT), (1_000_000, 64 << 10, 64 << 20));
    }

    #[test]
    fn described_functions_exist_with_their_signatures() {
        let language = Language::new(0);
        for usage in USUAL.iter().chain(&READING) {
            let name = name_in(usage);
            let script = language.compile(&format!("{name}(1, 2, 3, 4, 5, 6, 7)")).unwrap();
            let Err(NoResult::Error(error)) = language.run(&script, &mut ScriptContext::default()) else {
                panic!("{name}");
            };
            assert_eq!(error.help, Some(format!("it is called as `{usage}`")));
            let arguments = usage.matches(',').count() + 1;
            let script = language.compile(&format!("{name}({})", vec!["#{}"; arguments].join(", "))).unwrap();
            let result = language.run(&script, &mut ScriptContext::default());
            let missing =
                matches!(&result, Err(NoResult::Error(error)) if error.message.contains("no function"));
            assert!(!missing, "{name}: {result:?}");
        }
    }
}
