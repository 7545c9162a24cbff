//! The scripting language: Rhai with a custom library and without access to the outside.

use std::cell::Cell;
use std::collections::HashSet;

use rhai::packages::{BasicIteratorPackage, Package};
use rhai::{AST, ASTNode, Dynamic, Engine, Expr, LexError, OptimizationLevel, Position, Scope, Stmt, Token};

use super::builtins::{KnownFunctions, Purpose};
use super::context::{ScriptContext, unknown_read, within};
use super::messages::LONG_HEAD;
use super::{Data, NoResult, ScriptError, arithmetic, budget, context, limits, lists, maths, noise};

/// The compiler and interpreter of scripts.
pub(crate) struct Language {
    parser: Engine,
    engine: Engine,
    /// Names provided to scripts. Their values are irrelevant during compilation.
    outside: Scope<'static>,
}

/// A compiled script.
#[derive(Clone, Debug)]
pub(crate) struct Script {
    text: String,
    pub(super) ast: AST,
    /// Names of the functions that the script defines.
    functions: Vec<String>,
    purpose: Purpose,
}

impl Language {
    /// Creates the language with random functions seeded by `seed`.
    #[must_use]
    pub(crate) fn new(seed: u64) -> Self {
        let mut engine = bare_engine();
        budget::limit(&mut engine, |done| done > limits::OPERATIONS);
        noise::register(&mut engine, seed);
        context::register(&mut engine);
        Self { parser: parser(Purpose::Drive), engine, outside: outside(&ScriptContext::NAMES) }
    }

    /// Compiles a script: an expression, or statements that end with an expression.
    ///
    /// # Errors
    ///
    /// If the text is not a valid script.
    pub(crate) fn compile(&self, text: &str) -> Result<Script, ScriptError> {
        compile(&self.parser, &self.outside, Purpose::Drive, text)
    }

    /// Runs a script.
    ///
    /// # Errors
    ///
    /// If the script fails, or reads a value that is not known yet.
    pub(crate) fn run(&self, script: &Script, context: &mut ScriptContext) -> Result<Data, NoResult> {
        budget::start();
        let result =
            within(context, || self.engine.eval_ast_with_scope::<Dynamic>(&mut Scope::new(), &script.ast));
        context.record_operations(budget::done());
        match result {
            Ok(value) => Ok(Data::of(&value)),
            Err(error) => Err(match unknown_read(&script.text, &error) {
                Some(read) => NoResult::Needs(read),
                None => NoResult::Error(Box::new(script.explain(&error))),
            }),
        }
    }
}

impl Script {
    /// Returns the script's text.
    #[must_use]
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    pub(super) fn explain(&self, error: &rhai::EvalAltResult) -> ScriptError {
        ScriptError::running(
            &self.text,
            error,
            &KnownFunctions { own: &self.functions, purpose: self.purpose },
        )
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

pub(super) fn compile(
    parser: &Engine,
    outside: &Scope<'_>,
    purpose: Purpose,
    text: &str,
) -> Result<Script, ScriptError> {
    if text.len() > limits::SCRIPT {
        let message = format!("a script has at most {} KiB", limits::SCRIPT >> 10);
        let help = "what it holds as data can be made by loops, or be entities of the scene file".to_owned();
        return Err(ScriptError::new(text, message, "too long", Some(help)));
    }
    COMMAS.set(None);
    let ast = parser
        .compile_with_scope(outside, text)
        .map_err(|error| ScriptError::parsing(text, &error, purpose))?;
    let functions: Vec<String> = ast.iter_functions().map(|function| function.name.to_owned()).collect();
    if let Some(position) = endless_number(&ast) {
        return Err(ScriptError::endless_number(text, position));
    }
    let known = KnownFunctions { own: &functions, purpose };
    match bad_call(&ast, &known) {
        Some((Call::UnknownName(name), position)) => {
            Err(ScriptError::unknown_function(text, &name, position, &known))
        }
        Some((Call::Long(name), position)) => Err(ScriptError::long_call(text, &name, position)),
        None => Ok(Script { text: text.to_owned(), ast, functions, purpose }),
    }
}

/// Returns the position of the first number literal that is too large to be finite.
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

/// An invalid call.
enum Call {
    UnknownName(String),
    Long(String),
}

/// Finds the first call of an unknown function or with too many arguments, including calls that would never run.
fn bad_call(ast: &AST, known: &KnownFunctions<'_>) -> Option<(Call, Position)> {
    let names: HashSet<&str> = known.names().collect();
    let mut bad = None;
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
        {
            let name = || call.name.to_string();
            if !names.contains(call.name.as_str()) {
                bad = Some((Call::UnknownName(name()), position));
            } else if call.args.len() > limits::ARGUMENTS {
                bad = Some((Call::Long(name()), position));
            }
        }
        bad.is_none()
    });
    bad
}

/// Creates the engine that compiles scripts, with the permitted syntax and the limits of the text.
pub(super) fn parser(purpose: Purpose) -> Engine {
    let mut engine = Engine::new_raw();
    engine
        .set_optimization_level(OptimizationLevel::None)
        .set_strict_variables(true)
        .set_allow_anonymous_fn(false)
        .set_max_expr_depths(limits::NESTING, limits::NESTING_IN_FUNCTIONS)
        .set_max_functions(limits::FUNCTIONS)
        .set_max_string_size(limits::TEXT)
        // Rhai counts one element too many before it reaches the end of a literal.
        .set_max_array_size(limits::LIST + 1)
        .set_max_map_size(limits::MAP + 1);
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
    // Checked during compilation, since many variables take long to compile.
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_def_var(|_, variable, context| {
        Ok(variable.will_shadow || context.scope().len() < limits::VARIABLES)
    });
    #[expect(deprecated, reason = "marked so because it may change, not because it will go")]
    engine.on_parse_token(move |token, _, _| match token {
        // `spawn` is a reserved word of Rhai.
        Token::Reserved(word) if *word == "spawn" && purpose == Purpose::Spawn => Token::Identifier(word),
        token if is_endless_head(&token) => Token::LexError(LexError::Runtime(LONG_HEAD.to_owned()).into()),
        token => token,
    });
    engine
}

thread_local! {
    /// Number of commas in the function head that is being parsed on this thread; `None` outside function heads.
    static COMMAS: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Returns whether a token gives a function head more than [`limits::ARGUMENTS`] commas, so that no call can match it. Rhai would compare
/// all pairs of parameters before rejecting the head.
fn is_endless_head(token: &Token) -> bool {
    let commas = match token {
        Token::Fn => Some(0),
        Token::Comma => COMMAS.get().map(|commas| commas + 1),
        Token::RightParen => None,
        _ => COMMAS.get(),
    };
    COMMAS.set(commas);
    commas.is_some_and(|commas| commas > limits::ARGUMENTS)
}

/// Creates the engine that runs scripts, with limits, operators and functions, but without randomness and context.
pub(super) fn bare_engine() -> Engine {
    let mut engine = Engine::new_raw();
    engine
        .set_fast_operators(false)
        .set_fail_on_invalid_map_property(true)
        .set_max_call_levels(limits::CALLS)
        .set_max_variables(limits::VARIABLES)
        .set_max_string_size(limits::TEXT)
        .set_max_array_size(limits::LIST)
        .set_max_map_size(limits::MAP);
    engine.register_global_module(BasicIteratorPackage::new().as_shared_module());
    arithmetic::register(&mut engine);
    maths::register(&mut engine);
    lists::register(&mut engine);
    engine
}
