//! The machine and the program version of a measurement.

use serde_json::{Value, json};

/// The machine and the program version.
pub(super) struct Machine {
    /// Name of the processor, or its architecture if the name is unknown.
    processor: String,
    system: String,
    threads: usize,
    version: &'static str,
}

impl Machine {
    /// Returns the current machine with the given number of threads.
    pub(super) fn this(threads: usize) -> Self {
        let system = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
        let processor = processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned());
        Self { processor, system, threads, version: env!("CARGO_PKG_VERSION") }
    }

    pub(super) fn describe(&self) -> String {
        let threads = match self.threads {
            1 => "1 thread".to_owned(),
            count => format!("{count} threads"),
        };
        format!("rayreel {}, {}, {}, {threads}", self.version, self.processor, self.system)
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "rayreel": self.version,
            "processor": self.processor,
            "system": self.system,
            "threads": self.threads,
        })
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
