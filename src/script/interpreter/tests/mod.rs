//! Tests of the language: results and errors.

mod ends;
mod limits;
mod mistakes;
mod values;

use super::{Data, Language, NoResult, ScriptContext};

fn run(text: &str) -> Result<Data, NoResult> {
    let language = Language::new(0);
    let script = language.compile(text).map_err(|error| NoResult::Error(Box::new(error)))?;
    let mut context = ScriptContext::new(24.0, 5.0);
    context.set_time(2.5, 60.0);
    context.set_owner(3, "ball", Data::from([1.0, 2.0, 3.0]));
    language.run(&script, &mut context)
}

fn number(text: &str) -> f64 {
    match run(text) {
        Ok(Data::Number(number)) => number,
        #[expect(clippy::cast_precision_loss, reason = "small")]
        Ok(Data::Whole(whole)) => whole as f64,
        other => panic!("{text}: {other:?}"),
    }
}

/// Returns the error message of a script, and the text that the error marks.
fn mistake(text: &str) -> (String, String) {
    match run(text) {
        Err(NoResult::Error(error)) => (error.message.clone(), text[error.span.clone()].to_owned()),
        other => panic!("{text}: {other:?}"),
    }
}
