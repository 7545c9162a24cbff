//! Tests of random scripts, many of them hostile: they end soon, in little memory, and their errors have positions.
//!
//! `RAYREEL_SCRIPTS=DIR` writes the scenes of these scripts into a folder, for trials of the command itself.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use proptest::prelude::*;

use super::fuzz::{fuzz, variable};
use super::read;
use super::spent::Spent;
use rayreel::{Engine, EngineError};

/// Time limit of a script, far beyond what a working machine needs.
const TIME: Duration = Duration::from_secs(10);
/// Memory limit of the whole process, in KiB.
const MEMORY: u64 = 1 << 20;

/// A generator of random scripts.
struct Author {
    state: u64,
    /// Set if the script spawns entities.
    spawns: bool,
}

impl Author {
    /// Returns a random number below `most`, by SplitMix64 (Steele, Lea and Flood, 2014).
    fn below(&mut self, most: u64) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) % most
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[usize::try_from(self.below(list.len() as u64)).unwrap()]
    }

    fn name(&mut self) -> &'static str {
        self.one_of(&["a", "b", "c", "d", "m", "s"])
    }

    fn number(&mut self) -> &'static str {
        self.one_of(&[
            "0",
            "1",
            "2",
            "3",
            "-1",
            "0.5",
            "1e300",
            "1e-300",
            "255",
            "256",
            "5e-324",
            "9223372036854775807",
            "4000",
            "1e61",
            "-0.0",
            "90",
        ])
    }

    /// Returns the number of turns of a loop, rarely so large that spawning in it takes long.
    fn count(&mut self) -> &'static str {
        self.one_of(&["0", "3", "12", "30", "60", "250", "256", "257", "1000", "5000", "20000"])
    }

    fn function(&mut self) -> (&'static str, u64) {
        let own: &[(&str, u64)] = if self.spawns {
            &[("sphere", 1), ("box", 1), ("euler", 3), ("plane", 1)]
        } else {
            &[("value", 2), ("value", 3)]
        };
        match self.below(200) {
            0 => ("nothing", 1),
            1..20 => self.one_of(own),
            20..60 => self.one_of(&[("f", 1), ("g", 2)]),
            60..120 => self.one_of(&[
                ("append", 2),
                ("reverse", 1),
                ("keys", 1),
                ("contains", 2),
                ("push", 2),
                ("pop", 1),
                ("len", 1),
                ("range", 3),
            ]),
            120..160 => self.one_of(&[
                ("sum", 1),
                ("length", 1),
                ("normalize", 1),
                ("dot", 2),
                ("cross", 2),
                ("distance", 2),
                ("mix", 3),
                ("max", 3),
            ]),
            _ => self.one_of(&[
                ("sin", 1),
                ("sqrt", 1),
                ("floor", 1),
                ("abs", 1),
                ("random", 1),
                ("noise", 3),
                ("pow", 2),
            ]),
        }
    }

    fn values(&mut self, count: u64, depth: u32) -> String {
        let values: Vec<String> = (0..count).map(|_| self.value(depth)).collect();
        values.join(", ")
    }

    fn value(&mut self, depth: u32) -> String {
        if depth == 0 {
            return match self.below(6) {
                0 => self.number().to_owned(),
                1 => format!("\"{}\"", self.one_of(&["", "x", "ball", "ß", "Radius", "key", "\\n"])),
                2 if !self.spawns && self.below(4) == 0 => self.read(),
                2 if !self.spawns => self.one_of(&["t", "frame", "base", "name", "index", "pi"]).to_owned(),
                _ => self.name().to_owned(),
            };
        }
        let depth = depth - 1;
        match self.below(15) {
            0 | 1 => {
                let operator =
                    self.one_of(&["+", "-", "*", "/", "%", "**", "==", "!=", "<", ">=", "in", "..", "??"]);
                format!("({} {operator} {})", self.value(depth), self.value(depth))
            }
            2 | 3 => {
                let (name, count) = self.function();
                let count = if self.below(20) == 0 { self.below(20) } else { count };
                format!("{name}({})", self.values(count, depth))
            }
            4 | 5 => {
                let count = self.one_of(&[0, 1, 2, 3, 3, 3, 8, 40]);
                format!("[{}]", self.values(count, depth.min(1)))
            }
            6 => {
                let fields: Vec<String> =
                    (0..self.below(5)).map(|field| format!("f{field}: {}", self.value(depth))).collect();
                format!("#{{ {} }}", fields.join(", "))
            }
            7 => format!("{}[{}]", self.name(), self.value(depth)),
            8 => format!("{}[{}][{}]", self.name(), self.value(depth), self.value(0)),
            9 => format!("`{}${{{}}}${{{}}}`", self.name(), self.value(depth), self.value(0)),
            10 => format!("{}.{}", self.name(), self.one_of(&["f0", "f1", "len()", "pop()", "x"])),
            11 => format!(
                "if {} {{ {} }} else {{ {} }}",
                self.condition(),
                self.value(depth),
                self.value(depth)
            ),
            12 => format!("-({})", self.value(depth)),
            13 => format!("({} {} {})", self.condition(), self.one_of(&["&&", "||"]), self.condition()),
            _ => self.value(0),
        }
    }

    /// Returns a valid read of the script's own entity, often without an end.
    fn read(&mut self) -> String {
        let channel = self.one_of(&["Radius", "Translation", "Scale", "Kd"]);
        let moment =
            self.one_of(&["t - 0.1", "t / 2", "t", "-t", "2 * t + 1", "-3", "random(t)", "1e60 * t"]);
        format!("value(name, \"{channel}\", {moment})")
    }

    /// Returns a condition that is visibly true or false. Any other is refused before the script runs.
    fn condition(&mut self) -> String {
        match self.below(5) {
            0 => "true".to_owned(),
            1 => format!("len({}) < {}", self.name(), self.count()),
            2 => format!("random({}) < 0.{}", self.name(), self.below(10)),
            3 => format!("!({} == {})", self.value(1), self.value(1)),
            _ => format!("{} {} {}", self.value(1), self.one_of(&["<", ">=", "==", "!="]), self.value(0)),
        }
    }

    fn place(&mut self) -> String {
        let name = self.name();
        match self.below(6) {
            0 | 1 => format!("{name}[{}]", self.value(1)),
            2 => format!("{name}[{}][{}]", self.value(0), self.value(0)),
            3 => format!("{name}.f{}", self.below(3)),
            4 => format!("{name}[`k${{{}}}`]", self.value(0)),
            _ => name.to_owned(),
        }
    }

    fn block(&mut self, depth: u32) -> String {
        let mut block = String::new();
        for _ in 0..=self.below(4) {
            block.push_str(&self.statement(depth));
        }
        block
    }

    fn statement(&mut self, depth: u32) -> String {
        if depth > 0 && self.below(3) == 0 {
            let block = self.block(depth - 1);
            return match self.below(8) {
                0 | 1 => format!("for i in 0..{} {{ {block} }} ", self.count()),
                2 => format!("for x in {} {{ {block} }} ", self.name()),
                3 => format!("if {} {{ {block} }} ", self.condition()),
                4 => format!("while {} {{ {block} }} ", self.condition()),
                5 => format!("try {{ {block} }} catch (error) {{ {} }} ", self.block(0)),
                6 => format!("do {{ {block} }} while {}; ", self.condition()),
                _ => format!("loop {{ {block} if {} {{ break; }} }} ", self.condition()),
            };
        }
        if self.below(3) > 0 {
            // An error in it does not end the script.
            return format!("try {{ {} }} catch {{ }} ", self.simple_statement());
        }
        self.simple_statement()
    }

    fn simple_statement(&mut self) -> String {
        match self.below(10) {
            0 | 1 => format!("let {} = {}; ", self.name(), self.value(2)),
            2..=4 => {
                let operator = self.one_of(&["=", "=", "=", "+=", "-=", "*=", "/="]);
                format!("{} {operator} {}; ", self.place(), self.value(2))
            }
            5 => format!("{}.push({}); ", self.name(), self.value(1)),
            6 => self.growth(),
            7 if self.spawns => self.spawning(),
            8 => format!("throw {}; ", self.value(1)).repeat(usize::from(self.below(8) == 0)),
            _ => format!("{}; ", self.value(3)),
        }
    }

    /// Returns code that makes a value as large as allowed, or larger.
    fn growth(&mut self) -> String {
        let (name, other, count) = (self.name(), self.name(), self.count());
        match self.below(8) {
            0 => format!("{name} = []; for i in 0..{count} {{ {name}.push({other}); }} "),
            1 => format!("for i in 0..{count} {{ {name}[i] = {other}; }} "),
            2 => format!("for i in 0..{count} {{ for j in 0..{count} {{ {name}[i][j] = {other}; }} }} "),
            3 => format!("{name} = \"x\"; for i in 0..{} {{ {name} += {name}; }} ", self.below(14)),
            4 => format!("{name} = #{{}}; for i in 0..{count} {{ {name}[`k${{i}}`] = {other}; }} "),
            5 => format!(
                "{name} = [{other}, {other}]; for i in 0..{count} {{ {name} = append({name}, {name}); }} "
            ),
            6 => format!("for i in 0..{count} {{ {name} = [{name}]; }} "),
            _ => format!("for i in 0..{count} {{ {name} += {other}; }} "),
        }
    }

    fn spawning(&mut self) -> String {
        let mut fields = String::new();
        for (field, value) in [
            ("name", "`ball ${a}`".to_owned()),
            ("name", self.value(1)),
            ("shape", format!("sphere({})", self.value(0))),
            ("shape", self.value(1)),
            ("material", "\"clay\"".to_owned()),
            ("translation", format!("[{}]", self.values(3, 0))),
            ("rotation", self.value(1)),
            ("scale", self.value(0)),
            ("parent", self.value(0)),
            ("light", format!("point(#{{ intensity: [{}] }})", self.values(3, 0))),
        ] {
            if self.below(3) == 0 && !fields.contains(field) {
                let _ = write!(fields, "{field}: {value}, ");
            }
        }
        format!("spawn(#{{ {fields} }}); ")
    }

    fn script(mut self) -> String {
        let (f, g) = (self.block(1), self.value(2));
        let mut text =
            format!("fn f(a) {{ let b = a; let c = [a]; let d = 1; let m = #{{}}; let s = \"\"; {f} {g} }} ");
        let (g, again) = (self.value(2), self.condition());
        let _ = write!(
            text,
            "fn g(a, b) {{ let c = b; let d = a; let m = #{{}}; let s = \"\"; if {again} {{ g({g}, a) }} else {{ f(b) }} }} "
        );
        for name in ["a", "b", "c", "d", "m", "s"] {
            let _ = write!(
                text,
                "let {name} = {}; ",
                match self.below(5) {
                    0 => "[]".to_owned(),
                    1 => "[0, 0, 0]".to_owned(),
                    2 => "#{ f0: [1], f1: 2 }".to_owned(),
                    3 => "\"x\"".to_owned(),
                    _ => self.number().to_owned(),
                }
            );
        }
        for _ in 0..=self.below(8) {
            text.push_str(&self.statement(2));
        }
        text.push_str(&self.value(2));
        text
    }
}

/// Returns a scene with a script that drives a value, or with a script that spawns entities.
fn scene(seed: u64) -> String {
    let mut author = Author { state: seed, spawns: seed.is_multiple_of(2) };
    let channel = author.one_of(&["Radius", "Translation", "Rotation", "Scale", "Color", "Kd"]);
    let spawns = author.spawns;
    let script = author.script();
    let script = if spawns {
        format!("spawn: [Script(r####\"{script}\"####)]")
    } else {
        format!("animate: [(target: \"ball\", channel: {channel}, track: Script(r####\"{script}\"####))]")
    };
    format!(
        "(timeline: (fps: 10, duration: 4), camera: (position: (0, 0, -8), target: (0, 0, 0)),
        materials: {{ \"clay\": (k_a: 1) }},
        entities: [(name: \"ball\", shape: Sphere(radius: 1), material: \"clay\")],
        {script})"
    )
}

/// Returns the peak memory of this process, in KiB, where the system reports it.
fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim_end_matches("kB").trim().parse().ok()
}

#[test]
fn random_scripts_do_not_panic() {
    let folder = std::env::var_os("RAYREEL_SCRIPTS").map(PathBuf::from);
    let written = AtomicUsize::new(0);
    let good = AtomicUsize::new(0);
    fuzz("random scripts", 400, &any::<u64>().no_shrink(), |seed| {
        let text = scene(seed);
        if let Some(folder) = &folder {
            let number = written.fetch_add(1, Ordering::Relaxed);
            fs::write(folder.join(format!("{number:05}.ron")), text).unwrap();
            return Ok(());
        }
        let start = Spent::now();
        if let Some(scene) = read(&text)? {
            let mut engine = Engine::from_scene(scene);
            let sought = ["0", "1", "2.5"].iter().try_for_each(|time| engine.seek(time.parse().unwrap()));
            match sought {
                Err(EngineError::Script(mistake)) => {
                    prop_assert!(mistake.position().is_some(), "{}", mistake);
                }
                other => prop_assert!(other.is_ok(), "{:?}", other),
            }
            good.fetch_add(1, Ordering::Relaxed);
        }
        let spent = Spent::now().since(start);
        prop_assert!(spent < TIME, "{:?} for seed {seed}: {}", spent, text);
        Ok(())
    });
    println!("{} random scripts can be run", good.into_inner());
    if let Some(peak) = peak_memory() {
        println!("peak memory {} MiB", peak >> 10);
        assert!(variable("RAYREEL_FUZZ_SECONDS").is_some() || peak < MEMORY, "{peak} KiB");
    }
}
