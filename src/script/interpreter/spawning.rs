//! Scripts that spawn entities when a scene is loaded.

use std::collections::HashSet;
use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rhai::{Dynamic, Engine, EvalAltResult, Map, NativeCallContext, Position, Scope};

use super::builtins::Purpose;
use super::dynamic::kind;
use super::result::failed;
use super::{Data, ScriptError, SpawnBudget, Spawned, budget, language, limits, noise};

impl SpawnBudget {
    /// Deducts an entity, or returns an error if the budget does not suffice.
    fn admit(&mut self, entity: &Data) -> Result<(), Box<EvalAltResult>> {
        let Some(entities) = self.entities.checked_sub(1) else {
            return failed(format!(
                "the scripts of a scene spawn at most {} entities\ndoes a loop never end?",
                limits::ENTITIES
            ));
        };
        let Some(text) = self.text.checked_sub(entity.text_length() as u64) else {
            return failed(format!(
                "the texts of all spawned entities come to more than {} MiB\nshorten their names: is one made longer in every turn of a loop?",
                limits::SPAWNED_TEXT >> 20
            ));
        };
        *self = Self { entities, text };
        Ok(())
    }
}

/// Runs a script that calls `spawn(#{ .. })`, and passes all spawned entities to `take` in order. If `take` rejects an entity, the call
/// fails with the returned message; its second line, if any, is the remedy. Spawned entities are deducted from `budget`.
///
/// # Errors
///
/// If the text is not a valid script, or if the script fails.
pub(crate) fn run_spawning(
    text: &str,
    seed: u64,
    budget: &mut SpawnBudget,
    take: impl FnMut(Spawned) -> Result<(), String> + Send + 'static,
) -> Result<(), ScriptError> {
    let script =
        language::compile(&language::parser(Purpose::Spawn), &language::outside(&[]), Purpose::Spawn, text)?;
    let mut engine = language::bare_engine();
    noise::register(&mut engine, seed);
    register_constructors(&mut engine);
    let left = register_spawn(&mut engine, text, *budget, take);
    budget::on_outside(&mut engine, |_| None);
    budget::start();
    let result = engine.eval_ast_with_scope::<Dynamic>(&mut Scope::new(), &script.ast);
    *budget = *left.lock().unwrap_or_else(PoisonError::into_inner);
    match result {
        Ok(_) => Ok(()),
        Err(error) => Err(script.explain(&error)),
    }
}

/// Registers `spawn`. Returns the remaining budget, which each call updates.
fn register_spawn(
    engine: &mut Engine,
    text: &str,
    budget: SpawnBudget,
    take: impl FnMut(Spawned) -> Result<(), String> + Send + 'static,
) -> Arc<Mutex<SpawnBudget>> {
    let count = Arc::new(AtomicU64::new(0));
    let spawned = Arc::clone(&count);
    budget::limit(engine, move |done| {
        let more = spawned.load(Ordering::Relaxed) * limits::OPERATIONS_PER_ENTITY;
        done > (limits::SPAWNING_OPERATIONS + more).min(limits::MOST_SPAWNING_OPERATIONS)
    });
    let left = Arc::new(Mutex::new(budget));
    let budget = Arc::clone(&left);
    let taking = Mutex::new((take, SpawnedNames::default()));
    let lines = LineIndex::of(text);
    engine.register_fn(
        "spawn",
        move |context: NativeCallContext<'_>, entity: Dynamic| -> Result<(), Box<EvalAltResult>> {
            if !entity.is_map() {
                return failed(format!(
                    "`spawn` takes a map, as #{{ shape: sphere(1), material: \"clay\" }}, not {}",
                    kind(&entity)
                ));
            }
            let entity = Data::of(&entity);
            let admitted = budget.lock().unwrap_or_else(PoisonError::into_inner).admit(&entity);
            let taken = admitted.and_then(|()| {
                let (take, names) = &mut *taking.lock().unwrap_or_else(PoisonError::into_inner);
                let is_new = names.add(&entity);
                take(Spawned { entity, at: lines.byte(context.call_position()) }).or_else(failed)?;
                Ok(is_new)
            });
            // A rejected entity takes as much work as an accepted one but adds no operations to the limit, however often the error is
            // caught. An entity with a duplicate name is a mistake and adds none either.
            match &taken {
                Ok(is_new) => _ = count.fetch_add(u64::from(*is_new), Ordering::Relaxed),
                Err(_) => budget::add(limits::REFUSAL),
            }
            taken.map(|_| ())
        },
    );
    left
}

/// Hashes of the names of the spawned entities.
#[derive(Default)]
struct SpawnedNames {
    hashes: HashSet<u64>,
    hasher: BuildHasherDefault<DefaultHasher>,
}

impl SpawnedNames {
    /// Adds the entity's name. Returns whether the name is new; entities without a name count as new.
    fn add(&mut self, entity: &Data) -> bool {
        let Data::Map(fields) = entity else { return true };
        let name = fields.iter().find(|(field, _)| field == "name");
        name.is_none_or(|(_, name)| match name {
            Data::Text(name) => self.hashes.insert(self.hasher.hash_one(name)),
            _ => true,
        })
    }
}

/// Byte offsets of all lines and columns of a text, for lookups in constant time regardless of line length.
struct LineIndex {
    /// Byte offset of each character, and of the end.
    bytes: Vec<usize>,
    /// Index of the first character of each line.
    lines: Vec<usize>,
}

impl LineIndex {
    fn of(text: &str) -> Self {
        let bytes = text.char_indices().map(|(byte, _)| byte).chain([text.len()]).collect();
        let ends = text.chars().enumerate().filter(|(_, character)| *character == '\n');
        let lines = std::iter::once(0).chain(ends.map(|(end, _)| end + 1)).collect();
        Self { bytes, lines }
    }

    /// Returns the byte offset of a position. Lines and columns count from 1, columns in characters.
    fn byte(&self, position: Position) -> usize {
        let line = position.line().and_then(|line| self.lines.get(line - 1)).copied().unwrap_or(0);
        let column = position.position().unwrap_or(1);
        self.bytes.get(line + column - 1).or(self.bytes.last()).copied().unwrap_or(0)
    }
}

fn tagged(variant: &str, fields: Dynamic) -> Dynamic {
    Dynamic::from_map(Map::from([(variant.into(), fields)]))
}

fn record(variant: &str, field: &str, value: Dynamic) -> Dynamic {
    tagged(variant, Dynamic::from_map(Map::from([(field.into(), value)])))
}

/// Registers constructors for the variants of the file format.
fn register_constructors(engine: &mut Engine) {
    engine.register_fn("sphere", |radius: Dynamic| record("Sphere", "radius", radius));
    engine.register_fn("plane", |normal: Dynamic| record("Plane", "normal", normal));
    engine.register_fn("box", |size: Dynamic| match size.as_array_ref() {
        Ok(_) => record("Box", "size", size.clone()),
        Err(_) => record("Box", "size", Dynamic::from_array(vec![size.clone(); 3])),
    });
    for (name, variant) in [("cylinder", "Cylinder"), ("capsule", "Capsule")] {
        engine.register_fn(name, move |radius: Dynamic, from: Dynamic, to: Dynamic| {
            let fields = Map::from([("radius".into(), radius), ("from".into(), from), ("to".into(), to)]);
            tagged(variant, Dynamic::from_map(fields))
        });
    }
    engine.register_fn("euler", |x: Dynamic, y: Dynamic, z: Dynamic| {
        tagged("Euler", Dynamic::from_array(vec![x, y, z]))
    });
    engine.register_fn("axis_angle", |axis: Dynamic, degrees: Dynamic| {
        tagged("AxisAngle", Dynamic::from_array(vec![axis, degrees]))
    });
    engine.register_fn("quaternion", |x: Dynamic, y: Dynamic, z: Dynamic, w: Dynamic| {
        tagged("Quat", Dynamic::from_array(vec![x, y, z, w]))
    });
    for (name, variant) in
        [("point", "Point"), ("spot", "Spot"), ("directional", "Directional"), ("area", "Area")]
    {
        engine.register_fn(name, move |fields: Map| tagged(variant, Dynamic::from_map(fields)));
    }
    engine.register_fn("rectangle", |width: Dynamic, height: Dynamic| {
        let fields = Map::from([("width".into(), width), ("height".into(), height)]);
        tagged("Rectangle", Dynamic::from_map(fields))
    });
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn spawned(text: &str) -> Result<Vec<Data>, (String, usize)> {
        spawned_into(text, &mut SpawnBudget::default())
    }

    fn spawned_into(text: &str, budget: &mut SpawnBudget) -> Result<Vec<Data>, (String, usize)> {
        let list = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
        let into = std::sync::Arc::clone(&list);
        let take = move |spawned: Spawned| {
            into.lock().unwrap().push(spawned.entity);
            Ok(())
        };
        run_spawning(text, 0, budget, take).map_err(|error| (error.message, error.span.start))?;
        let list = list.lock().unwrap();
        Ok(list.clone())
    }

    #[test]
    fn hundreds_of_entities_spawn_in_order() {
        let list =
            spawned("for i in 0..100 { spawn(#{ name: `ball ${i}`, shape: sphere(i / 2) }); }").unwrap();
        assert_eq!(list.len(), 100);
        let radius = Data::Map(vec![("radius".to_owned(), Data::Number(1.5))]);
        let shape = Data::Map(vec![("Sphere".to_owned(), radius)]);
        assert_eq!(
            list[3],
            Data::Map(vec![
                ("name".to_owned(), Data::Text("ball 3".to_owned())),
                ("shape".to_owned(), shape)
            ])
        );
        assert_eq!(spawned("1;\n  spawn(3)").unwrap_err().1, 5);
        for endless in ["", "let b = a;", "dot(a, a);", "let b = a + a;", "len(a);", "fn_with_a(a);"] {
            let start = Instant::now();
            let text = format!(
                "fn fn_with_a(a) {{ a }} let a = []; for i in 0..256 {{ a.push(i); }} loop {{ {endless} }}"
            );
            assert_eq!(spawned(&text).unwrap_err().0, "this takes too long");
            println!("{:>8.1?} {endless}", start.elapsed());
            assert!(start.elapsed() < Duration::from_secs(2));
        }
    }

    #[test]
    fn calls_in_long_lines_are_found_quickly() {
        let start = Instant::now();
        let text = format!(
            "/* {} */\n/* ß */ for i in 0..20000 {{ spawn(#{{}}); }}\nspawn(#{{}});",
            "ß".repeat(30_000)
        );
        let text = text.replacen('\n', "", 1);
        let list = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
        let into = std::sync::Arc::clone(&list);
        let take = move |spawned: Spawned| {
            into.lock().unwrap().push(spawned.at);
            Ok(())
        };
        run_spawning(&text, 0, &mut SpawnBudget::default(), take).unwrap();
        let calls: Vec<usize> = text.match_indices("spawn").map(|(at, _)| at).collect();
        let list = list.lock().unwrap();
        assert_eq!((list[0], list[19_999], list[20_000]), (calls[0], calls[0], calls[1]));
        assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
    }

    #[test]
    fn spawned_entities_share_one_limit() {
        let two = "spawn(#{ name: \"four\", other: [\"five5\", 1] }); spawn(#{ name: \"\" });";
        let mut budget = SpawnBudget { entities: 5, text: 20 };
        assert_eq!(spawned_into(two, &mut budget).unwrap().len(), 2);
        assert_eq!((budget.entities, budget.text), (3, 11));
        spawned_into(two, &mut budget).unwrap();
        let (message, _) = spawned_into(two, &mut budget).unwrap_err();
        assert_eq!(message, "the texts of all spawned entities come to more than 64 MiB");
        let (message, at) = spawned_into("spawn(#{});\nspawn(#{})", &mut budget).unwrap_err();
        assert_eq!((message.as_str(), at), ("the scripts of a scene spawn at most 1000000 entities", 12));
        let growing =
            "let s = \"x\"; for i in 0..11 { s += s; } for i in 0..1000000 { spawn(#{ name: s + i }); }";
        assert!(spawned(growing).unwrap_err().0.contains("64 MiB"));
    }

    #[test]
    fn rejected_spawns_do_not_extend_the_budget() {
        let attempts = std::sync::Arc::new(std::sync::atomic::AtomicUsize::new(0));
        let count = std::sync::Arc::clone(&attempts);
        let refuse = move |_: Spawned| {
            count.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            Err("no".to_owned())
        };
        let text = "loop { try { spawn(#{}); } catch { } }";
        let error = run_spawning(text, 0, &mut SpawnBudget::default(), refuse).unwrap_err();
        assert_eq!(error.message, "this takes too long");
        let attempts = attempts.load(std::sync::atomic::Ordering::Relaxed);
        assert!((1..=2000).contains(&attempts), "{attempts} entities are refused before it ends");
    }

    #[test]
    fn repeated_names_do_not_extend_the_budget() {
        let count = |fields: &str| {
            let mut budget = SpawnBudget::default();
            let text = format!("let i = 0; loop {{ i += 1; {} spawn(#{{ {fields} }}); }}", "i;".repeat(200));
            let error = spawned_into(&text, &mut budget).unwrap_err();
            assert_eq!(error.0, "this takes too long");
            limits::ENTITIES - budget.entities
        };
        let (repeated, named, unnamed) = (count("name: `ball`"), count("name: `ball ${i}`"), count(""));
        assert!((1..=1000).contains(&repeated), "{repeated}");
        assert!(named > repeated && unnamed > repeated, "{named} {unnamed}");
    }
}
