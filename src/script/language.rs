//! The language: Rhai with a library of its own, and nothing of the outside.

use rhai::packages::{BasicIteratorPackage, Package};
use rhai::{AST, ASTNode, Dynamic, Engine, Expr, OptimizationLevel, Position, Scope, Stmt};

use super::surroundings::{Read, Surroundings, unanswered, within};
use super::{Data, ScriptError, arithmetic, limits, lists, maths, noise, spawning, surroundings, work};
use crate::color::Transfer;

/// Compiles and runs programs.
///
/// ```
/// use rayreel::script::{Data, Language, Surroundings};
/// let language = Language::new(0);
/// let program = language.compile("let half = 1 / 2; [3 * cos(t), half, 3 * sin(t)]")?;
/// let mut surroundings = Surroundings::default();
/// assert_eq!(language.run(&program, &mut surroundings).unwrap(), Data::from([3.0, 0.5, 0.0]));
/// # Ok::<(), rayreel::script::ScriptError>(())
/// ```
pub struct Language {
    engine: Engine,
    /// What names from outside a program stand for; their values when it is compiled do not matter.
    outside: Scope<'static>,
}

/// A compiled program.
#[derive(Clone, Debug)]
pub struct Program {
    text: String,
    pub(super) ast: AST,
    /// The names of all functions that it can call.
    functions: Vec<String>,
}

/// The compiled programs of a scene.
#[derive(Debug)]
pub struct Programs {
    /// What they are run by.
    pub language: Language,
    /// All programs.
    pub list: Vec<Program>,
    /// What refers to them: to which, and what stands before the names of entities that it reads.
    pub uses: Vec<(usize, String)>,
    /// How their colours become light.
    pub transfer: Transfer,
}

impl Programs {
    /// None yet.
    #[must_use]
    pub fn new(language: Language, transfer: Transfer) -> Self {
        Self { language, list: Vec::new(), uses: Vec::new(), transfer }
    }

    /// The program of a use, and what stands before the names that it reads.
    #[must_use]
    pub fn used(&self, place: usize) -> Option<(&Program, &str)> {
        let (program, prefix) = self.uses.get(place)?;
        Some((self.list.get(*program)?, prefix))
    }
}

/// Why a program gave nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Stop {
    /// It went wrong.
    Error(Box<ScriptError>),
    /// It reads a value that is not [known](Surroundings::know): to be run again when it is.
    Needs(Read),
}

impl Language {
    /// The language with its randomness of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut engine = bare_engine();
        work::limit(&mut engine, || limits::OPERATIONS);
        noise::register(&mut engine, seed);
        surroundings::register(&mut engine);
        Self { engine, outside: outside(&Surroundings::NAMES) }
    }

    /// Reads a program: an expression, or statements of which the last is one.
    ///
    /// # Errors
    ///
    /// If it is not one.
    pub fn compile(&self, text: &str) -> Result<Program, ScriptError> {
        compile(&self.engine, &self.outside, &READING, text)
    }

    /// Runs a program.
    ///
    /// # Errors
    ///
    /// If it goes wrong, or reads what is not known yet.
    pub fn run(&self, program: &Program, surroundings: &mut Surroundings) -> Result<Data, Stop> {
        work::start();
        let result = within(surroundings, || {
            self.engine.eval_ast_with_scope::<Dynamic>(&mut Scope::new(), &program.ast)
        });
        surroundings.record_work(work::done());
        match result {
            Ok(value) => Ok(Data::of(&value)),
            Err(error) => Err(match unanswered(&program.text, &error) {
                Some(read) => Stop::Needs(read),
                None => Stop::Error(Box::new(program.explain(&error))),
            }),
        }
    }
}

impl Program {
    /// Its text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn explain(&self, error: &rhai::EvalAltResult) -> ScriptError {
        ScriptError::running(&self.text, error, &self.functions)
    }
}

impl std::fmt::Debug for Language {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Language").finish_non_exhaustive()
    }
}

pub(super) fn outside(names: &[&'static str]) -> Scope<'static> {
    let mut scope = Scope::new();
    for name in names.iter().copied().chain(maths::CONSTANTS.map(|(name, _)| name)) {
        scope.push_constant(name, ());
    }
    scope
}

/// `usages` are those of functions that the engine has besides the usual ones.
pub(super) fn compile(
    engine: &Engine,
    outside: &Scope<'_>,
    usages: &[&str],
    text: &str,
) -> Result<Program, ScriptError> {
    if text.len() > limits::PROGRAM {
        let message = format!("a script has at most {} bytes", limits::PROGRAM);
        return Err(ScriptError::whole(text, message, "too long", None));
    }
    let ast = engine.compile_with_scope(outside, text).map_err(|error| ScriptError::parsing(text, &error))?;
    let usual = USUAL.iter().chain(usages).map(|usage| name_in(usage).to_owned());
    let own = ast.iter_functions().map(|function| function.name.to_owned());
    let functions: Vec<String> = usual.chain(own).collect();
    if let Some(position) = endless_number(&ast) {
        return Err(ScriptError::endless_number(text, position));
    }
    match unknown_call(&ast, &functions) {
        Some((name, position)) => Err(ScriptError::unknown_function(text, &name, position, functions)),
        None => Ok(Program { text: text.to_owned(), ast, functions }),
    }
}

/// The first number that is too large to be one.
fn endless_number(ast: &AST) -> Option<Position> {
    let mut endless = None;
    ast.walk(&mut |path| {
        if let Some(ASTNode::Expr(Expr::FloatConstant(number, position))) = path.last()
            && !number.is_finite()
        {
            endless = Some(*position);
        }
        endless.is_none()
    });
    endless
}

/// The first call of a function that there is not, so that it is found where it would not be called, too.
fn unknown_call(ast: &AST, known: &[String]) -> Option<(String, Position)> {
    let mut unknown = None;
    ast.walk(&mut |path| {
        let call = match path.last() {
            Some(ASTNode::Expr(Expr::FnCall(call, position) | Expr::MethodCall(call, position))) => {
                Some((call, *position))
            }
            Some(ASTNode::Stmt(Stmt::FnCall(call, position))) => Some((call, *position)),
            _ => None,
        };
        if let Some((call, position)) = call
            && call.op_token.is_none()
            && call.name.starts_with(char::is_alphabetic)
            && !known.iter().any(|known| *known == call.name)
        {
            unknown = Some((call.name.to_string(), position));
        }
        unknown.is_none()
    });
    unknown
}

/// Limits, operators and functions, without randomness and surroundings.
pub(super) fn bare_engine() -> Engine {
    let mut engine = Engine::new_raw();
    engine
        .set_optimization_level(OptimizationLevel::None)
        .set_fast_operators(false)
        .set_strict_variables(true)
        .set_fail_on_invalid_map_property(true)
        .set_allow_anonymous_fn(false)
        .set_max_call_levels(limits::CALLS)
        .set_max_expr_depths(limits::NESTING, limits::NESTING_IN_FUNCTIONS)
        .set_max_functions(limits::FUNCTIONS)
        .set_max_variables(limits::VARIABLES)
        .set_max_string_size(limits::TEXT)
        .set_max_array_size(limits::LIST)
        .set_max_map_size(limits::MAP);
    for symbol in [
        "eval",
        "print",
        "debug",
        "Fn",
        "call",
        "curry",
        "type_of",
        "is_def_fn",
        "is_def_var",
        "exit",
        "this",
    ] {
        engine.disable_symbol(symbol);
    }
    engine.register_global_module(BasicIteratorPackage::new().as_shared_module());
    arithmetic::register(&mut engine);
    maths::register(&mut engine);
    lists::register(&mut engine);
    engine
}

/// How functions are called.
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

/// Of programs that give values.
const READING: [&str; 1] = ["value(name, channel)"];

fn name_in(usage: &str) -> &str {
    usage.split('(').next().unwrap_or(usage)
}

/// How a function is called, if it is one of the language's.
pub(super) fn usage(name: &str) -> Option<String> {
    let mut usages = USUAL.iter().chain(&READING).chain(&spawning::USAGES);
    let usage = usages.find(|usage| name_in(usage) == name)?;
    Some(format!("it is called as `{usage}`"))
}

/// The names of all that is given from outside.
pub(super) fn variables() -> impl Iterator<Item = &'static str> {
    Surroundings::NAMES.into_iter().chain(maths::CONSTANTS.map(|(name, _)| name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_description_has_every_function_every_name_and_every_limit() {
        let description = include_str!("language.md");
        for usage in USUAL.iter().chain(&READING).chain(&spawning::USAGES) {
            assert!(description.contains(&format!("`{usage}`")), "{usage}");
        }
        for name in variables() {
            assert!(description.contains(&format!("`{name}`")), "{name}");
        }
        let section = description.split("# Limits").nth(1).unwrap();
        for limit in [
            "100 000 operations".to_owned(),
            "200 000, and 100 more".to_owned(),
            format!("{} values, maps {}, texts {} bytes", limits::LIST, limits::MAP, limits::TEXT),
            format!("{} variables", limits::VARIABLES),
            format!("{} calls", limits::CALLS),
            format!("{} deep, {} in functions", limits::NESTING, limits::NESTING_IN_FUNCTIONS),
        ] {
            let text = section.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(text.contains(&limit), "{limit}");
        }
        assert_eq!(
            (limits::OPERATIONS, limits::SPAWNING_OPERATIONS, limits::OPERATIONS_PER_ENTITY),
            (100_000, 200_000, 100)
        );
        assert_eq!((limits::ENTITIES, limits::PROGRAM), (1_000_000, 1 << 20));
    }

    #[test]
    fn every_function_that_is_named_is_there_and_says_how_it_is_called() {
        let language = Language::new(0);
        for usage in USUAL.iter().chain(&READING) {
            let name = name_in(usage);
            let program = language.compile(&format!("{name}(1, 2, 3, 4, 5, 6, 7)")).unwrap();
            let Err(Stop::Error(error)) = language.run(&program, &mut Surroundings::default()) else {
                panic!("{name}");
            };
            assert_eq!(error.help, Some(format!("it is called as `{usage}`")));
            let arguments = usage.matches(',').count() + 1;
            let program =
                language.compile(&format!("{name}({})", vec!["#{}"; arguments].join(", "))).unwrap();
            let result = language.run(&program, &mut Surroundings::default());
            let missing = matches!(&result, Err(Stop::Error(error)) if error.message.contains("no function"));
            assert!(!missing, "{name}: {result:?}");
        }
    }
}
