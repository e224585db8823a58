//! The machine that measurements run on.

use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

/// Properties of a machine and of the program. They identify no user and no host.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Machine {
    /// Names and values, in display order.
    pub facts: Vec<(String, String)>,
}

impl Machine {
    /// Returns this machine, with the number of threads used.
    pub fn this(threads: usize) -> Self {
        let cpus = CpuRefreshKind::nothing();
        let refresh = RefreshKind::nothing().with_cpu(cpus);
        let system = System::new_with_specifics(
            refresh.with_memory(MemoryRefreshKind::nothing().with_ram()),
        );
        let processor = system.cpus().first().map_or("unknown", |cpu| cpu.brand().trim());
        let gibibytes = system.total_memory() as f64 / f64::from(1 << 30);
        let name = System::name().unwrap_or_else(|| std::env::consts::OS.to_owned());
        let facts = [
            ("version", format!("Spherule {}", env!("CARGO_PKG_VERSION"))),
            ("processor", processor.to_owned()),
            ("logical processors", system.cpus().len().to_string()),
            ("threads used", threads.to_string()),
            ("lanes compiled for", lanes().to_owned()),
            ("memory", format!("{gibibytes:.1} GiB")),
            ("system", format!("{name}, {}", std::env::consts::ARCH)),
        ];
        Self { facts: facts.map(|(name, fact)| (name.to_owned(), fact)).to_vec() }
    }

    /// Returns a property by name; empty if it is unknown.
    pub fn fact(&self, name: &str) -> &str {
        self.facts.iter().find(|fact| fact.0 == name).map_or("", |fact| &fact.1)
    }

    /// Returns processor and threads, for the note of a plot.
    pub fn line(&self) -> String {
        format!("{}, {} threads", self.fact("processor"), self.fact("threads used"))
    }
}

/// Returns the widest instruction set that the program is compiled for.
fn lanes() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(target_feature = "avx2") {
        "AVX2"
    } else if cfg!(target_feature = "sse2") {
        "SSE2"
    } else {
        std::env::consts::ARCH
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facts_are_known() {
        let machine = Machine::this(3);
        assert_eq!(machine.fact("threads used"), "3");
        assert!(machine.fact("version").contains(env!("CARGO_PKG_VERSION")));
        assert!(machine.facts.iter().all(|(_, fact)| !fact.is_empty()));
        assert_eq!(machine.fact("name of the user"), "");
    }
}
