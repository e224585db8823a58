//! The instructions that the program was compiled for, and those that this processor has.
//!
//! The standard library's `is_x86_feature_detected!` does not help: it returns true for features that the
//! program was compiled with. So the check queries the processor itself.

use super::failure::Failure;
use spherule_levels::Level;
use std::env;

/// Returns an error if the program would stop at an illegal instruction.
#[inline(never)]
pub(super) fn check() -> Result<(), Failure> {
    let missing = missing(&required());
    if missing.is_empty() { Ok(()) } else { Err(Failure::Processor(missing.join(", "))) }
}

/// Returns the level of the program, and why it is this one.
pub(super) fn level() -> String {
    let (compiled, available) = (Level::compiled(), Level::of_processor());
    if compiled >= available {
        format!("{compiled}, the highest that this processor has")
    } else if is_forced(compiled) {
        format!("{compiled}, as SPHERULE_LEVEL says; this processor has {available}")
    } else {
        format!("{compiled}, which it was compiled for; this processor has {available}")
    }
}

/// Returns how to get a faster program, if this processor has a higher level than this one was compiled for.
pub(super) fn advice() -> Option<String> {
    let (compiled, available) = (Level::compiled(), Level::of_processor());
    (compiled < available && !is_forced(compiled)).then(|| {
        format!(
            "this program was compiled for {compiled}, and this processor has {available}, with which renders \
             are faster and give the same images: install the archive or package of Spherule, or compile it \
             with RUSTFLAGS=\"-C target-cpu=native\""
        )
    })
}

/// Returns whether the user asked for a level by the variable that the launcher of packages reads.
fn is_forced(level: Level) -> bool {
    env::var("SPHERULE_LEVEL").is_ok_and(|name| name == level.name())
}

/// An instruction set: its name, whether the program was compiled for it, whether the processor has
/// it.
type Requirement = (&'static str, bool, bool);

fn missing(required: &[Requirement]) -> Vec<&'static str> {
    required.iter().filter(|(_, compiled, has)| *compiled && !has).map(|row| row.0).collect()
}

#[cfg(target_arch = "x86_64")]
fn required() -> Vec<Requirement> {
    macro_rules! requirements {
        ($($leaf:ident { $($name:literal $has:ident)+ })+) => {
            vec![$($((
                $name,
                cfg!(target_feature = $name),
                $leaf.as_ref().is_some_and(|leaf| leaf.$has()),
            ),)+)+]
        };
    }
    let processor = raw_cpuid::CpuId::new();
    let basic = processor.get_feature_info();
    let extended = processor.get_extended_feature_info();
    let vendor = processor.get_extended_processor_and_feature_identifiers();
    requirements! {
        basic {
            "sse3" has_sse3
            "ssse3" has_ssse3
            "sse4.1" has_sse41
            "sse4.2" has_sse42
            "popcnt" has_popcnt
            "avx" has_avx
            "fma" has_fma
            "f16c" has_f16c
            "movbe" has_movbe
        }
        extended {
            "avx2" has_avx2
            "bmi1" has_bmi1
            "bmi2" has_bmi2
            "avx512f" has_avx512f
            "avx512bw" has_avx512bw
            "avx512cd" has_avx512cd
            "avx512dq" has_avx512dq
            "avx512vl" has_avx512vl
            "avx512ifma" has_avx512_ifma
            "avx512vbmi" has_avx512vbmi
            "avx512vbmi2" has_avx512vbmi2
            "avx512bitalg" has_avx512bitalg
            "avx512vpopcntdq" has_avx512vpopcntdq
            "gfni" has_gfni
        }
        vendor {
            "lzcnt" has_lzcnt
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn required() -> Vec<Requirement> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_features_compiled_for_can_be_missing() {
        let rows = [("a", true, true), ("b", true, false), ("c", false, false), ("d", false, true)];
        assert_eq!(missing(&rows), ["b"]);
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn the_processor_agrees_with_the_standard_library() {
        let has = |name| required().iter().any(|row| row.0 == name && row.2);
        assert_eq!(has("avx2"), is_x86_feature_detected!("avx2"));
        assert_eq!(has("fma"), is_x86_feature_detected!("fma"));
        assert_eq!(has("avx512f"), is_x86_feature_detected!("avx512f"));
        assert_eq!(has("lzcnt"), is_x86_feature_detected!("lzcnt"));
    }
}
