//! Programs that spawn entities when a scene is loaded.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rhai::{Dynamic, Engine, EvalAltResult, Map, NativeCallContext, Position, Scope, Token};

use super::arithmetic::failed;
use super::data::kind;
use super::{Data, ScriptError, language, limits, noise, work};

/// How the functions of programs that spawn are called.
pub(super) const USAGES: [&str; 12] = [
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

/// What a program spawns: a map that mirrors an entity of the file format.
#[derive(Clone, Debug, PartialEq)]
pub struct Spawned {
    /// The map.
    pub entity: Data,
    /// Where in the program's text `spawn` is called, in bytes.
    pub at: usize,
}

/// Runs a program that calls `spawn(#{ .. })`, and gives all that it spawns to `take`, in this order. What `take` refuses is an error
/// at the call; a second line of its message is the remedy. `room` is how many entities may be spawned.
///
/// # Errors
///
/// If the text is not a program, or it goes wrong.
pub fn run_spawning(
    text: &str,
    seed: u64,
    room: u64,
    take: impl FnMut(Spawned) -> Result<(), String> + Send + 'static,
) -> Result<(), ScriptError> {
    let mut engine = language::bare_engine();
    noise::register(&mut engine, seed);
    register_constructors(&mut engine);
    register_spawn(&mut engine, text, room, take);
    work::on_outside(&mut engine, |_| None);
    let program = language::compile(&engine, &language::outside(&[]), &USAGES, text)?;
    work::start();
    match engine.eval_ast_with_scope::<Dynamic>(&mut Scope::new(), &program.ast) {
        Ok(_) => Ok(()),
        Err(error) => Err(program.explain(&error)),
    }
}

fn register_spawn(
    engine: &mut Engine,
    text: &str,
    room: u64,
    take: impl FnMut(Spawned) -> Result<(), String> + Send + 'static,
) {
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_parse_token(|token, _, _| match token {
        // Kept by Rhai for later.
        Token::Reserved(word) if *word == "spawn" => Token::Identifier(word),
        token => token,
    });
    let count = Arc::new(AtomicU64::new(0));
    let spawned = Arc::clone(&count);
    work::limit(engine, move || {
        limits::SPAWNING_OPERATIONS + spawned.load(Ordering::Relaxed) * limits::OPERATIONS_PER_ENTITY
    });
    let take = Mutex::new(take);
    let places = Places::of(text);
    engine.register_fn(
        "spawn",
        move |context: NativeCallContext<'_>, entity: Dynamic| -> Result<(), Box<EvalAltResult>> {
            if !entity.is_map() {
                return failed(format!(
                    "`spawn` takes a map, as #{{ shape: sphere(1), material: \"clay\" }}, not {}",
                    kind(&entity)
                ));
            }
            if count.fetch_add(1, Ordering::Relaxed) >= room {
                return failed(format!(
                    "the scripts of a scene spawn at most {} entities\ndoes a loop never end?",
                    limits::ENTITIES
                ));
            }
            let spawned = Spawned { entity: Data::of(&entity), at: places.byte(context.call_position()) };
            let mut take = take.lock().unwrap_or_else(PoisonError::into_inner);
            take(spawned).or_else(failed)
        },
    );
}

/// Where lines start.
struct Places {
    lines: Vec<usize>,
    /// The bytes of characters in a line differ from their count where it is not ASCII.
    text: String,
}

impl Places {
    fn of(text: &str) -> Self {
        let after = text.match_indices('\n').map(|(at, _)| at + 1);
        Self { lines: std::iter::once(0).chain(after).collect(), text: text.to_owned() }
    }

    fn byte(&self, position: Position) -> usize {
        let start = position.line().and_then(|line| self.lines.get(line - 1)).copied().unwrap_or(0);
        let rest = &self.text[start..];
        let column = position.position().unwrap_or(1);
        start + rest.char_indices().nth(column - 1).map_or(rest.len(), |(offset, _)| offset)
    }
}

fn tagged(variant: &str, fields: Dynamic) -> Dynamic {
    Dynamic::from_map(Map::from([(variant.into(), fields)]))
}

fn record(variant: &str, field: &str, value: Dynamic) -> Dynamic {
    tagged(variant, Dynamic::from_map(Map::from([(field.into(), value)])))
}

/// What has a name in the file format.
fn register_constructors(engine: &mut Engine) {
    engine.register_fn("sphere", |radius: Dynamic| record("Sphere", "radius", radius));
    engine.register_fn("plane", |normal: Dynamic| record("Plane", "normal", normal));
    engine.register_fn("box", |size: Dynamic| match size.as_array_ref() {
        Ok(_) => record("Box", "size", size.clone()),
        Err(_) => record("Box", "size", Dynamic::from_array(vec![size.clone(); 3])),
    });
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
