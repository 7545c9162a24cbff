//! `rayreel lsp`: a language server for scenes, on standard input and output.
//!
//! ```text
//! editor -> messages -> server -> answers to requests (completion, hover, definition, symbols)
//!                          |
//!                          +----> checker (its own thread) -> diagnostics, those of `rayreel check`
//! ```
//!
//! The protocol is that of <https://microsoft.github.io/language-server-protocol>, of which the server needs little: messages are JSON values
//! as they are, without types of their own.

mod checker;
mod messages;
mod positions;
mod server;

use std::io::stdin;
use std::ops::ControlFlow;

use super::args::LspArguments;
use super::exit::Failure;
use checker::Checker;
use server::LanguageServer;

pub(super) fn run(arguments: &LspArguments) -> Result<(), Failure> {
    let mut server = LanguageServer::new(Checker::start(arguments.allowed.clone()));
    let mut input = stdin().lock();
    while let Some(message) = messages::read(&mut input)? {
        if let ControlFlow::Break(result) = server.receive(message)? {
            return result;
        }
    }
    Ok(())
}
