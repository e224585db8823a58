//! `--part from-env`: the part that this process renders, from the environment variables of schedulers
//! and launchers.
//!
//! Job arrays number their tasks as the user says, cloud services and launchers from 0. The index of an
//! array goes before a launcher's rank, because the tasks of an array have a launcher's variables too.
//! Several arrays at once are refused unless they name the same part; of several launchers the first of
//! [`LAUNCHERS`] counts: `mpirun` within a Slurm job leaves `srun`'s variables in place.

use spherule_render::split::Part;
use std::fmt;

/// Environment variables of a scheduler or launcher.
struct TaskVariables {
    /// Name for messages.
    name: &'static str,
    /// The variable that holds the task's number.
    task: &'static str,
    /// A value that means that there is no task.
    none: &'static str,
    row: Row,
}

/// Numbering of tasks.
enum Row {
    /// From a first to a last number, in variables; by default the first is 1 and the step 1.
    Array { first: Option<&'static str>, last: &'static str, step: Option<&'static str> },
    /// From 0; a variable holds their number.
    Ranks { size: &'static str },
    /// From `first`; no variable holds their number.
    Unbounded { first: i64 },
}

use Row::{Array, Ranks, Unbounded};

/// Returns the variables of a scheduler or launcher without a value that means that there is no task.
const fn tasks(name: &'static str, task: &'static str, row: Row) -> TaskVariables {
    TaskVariables { name, task, none: "", row }
}

/// Number of tasks of Slurm's array, whose numbers may have gaps.
const SLURM_COUNT: &str = "SLURM_ARRAY_TASK_COUNT";

const ARRAYS: [TaskVariables; 7] = [
    tasks(
        "Slurm",
        "SLURM_ARRAY_TASK_ID",
        Array {
            first: Some("SLURM_ARRAY_TASK_MIN"),
            last: "SLURM_ARRAY_TASK_MAX",
            step: Some("SLURM_ARRAY_TASK_STEP"),
        },
    ),
    tasks("PBS", "PBS_ARRAY_INDEX", Unbounded { first: 1 }),
    tasks("Torque", "PBS_ARRAYID", Unbounded { first: 1 }),
    TaskVariables {
        name: "Grid Engine",
        task: "SGE_TASK_ID",
        none: "undefined",
        row: Array {
            first: Some("SGE_TASK_FIRST"),
            last: "SGE_TASK_LAST",
            step: Some("SGE_TASK_STEPSIZE"),
        },
    },
    TaskVariables {
        name: "LSF",
        task: "LSB_JOBINDEX",
        none: "0",
        row: Array { first: None, last: "LSB_JOBINDEX_END", step: Some("LSB_JOBINDEX_STEP") },
    },
    tasks("AWS Batch", "AWS_BATCH_JOB_ARRAY_INDEX", Ranks { size: "AWS_BATCH_JOB_ARRAY_SIZE" }),
    tasks("Kubernetes", "JOB_COMPLETION_INDEX", Unbounded { first: 0 }),
];

/// `PMIx` sets no size, but Slurm, which uses it, does.
const LAUNCHERS: [TaskVariables; 6] = [
    tasks("Open MPI", "OMPI_COMM_WORLD_RANK", Ranks { size: "OMPI_COMM_WORLD_SIZE" }),
    tasks("MVAPICH", "MV2_COMM_WORLD_RANK", Ranks { size: "MV2_COMM_WORLD_SIZE" }),
    tasks("PMI", "PMI_RANK", Ranks { size: "PMI_SIZE" }),
    tasks("PMIx", "PMIX_RANK", Ranks { size: "SLURM_NTASKS" }),
    tasks("srun", "SLURM_PROCID", Ranks { size: "SLURM_NTASKS" }),
    tasks("GNU parallel", "PARALLEL_SEQ", Unbounded { first: 1 }),
];

/// Errors of `--part from-env`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum TaskError {
    #[error("no scheduler or launcher sets the number of this task ({}); use --part K/N", names())]
    Nothing,
    #[error("{0} is `{1}`, which is not an integer")]
    NoNumber(&'static str, String),
    #[error(
        "{name} sets {task} for task {number}, but not the number of tasks; use --part from-env/N"
    )]
    NoCount { name: &'static str, task: &'static str, number: i64 },
    #[error(
        "{task} is {number}, but tasks are numbered from {first} to {last}{}; use --part from-env/N, and \
         number tasks from {first} to {first} + N - 1", steps(*.step)
    )]
    Beyond { task: &'static str, number: i64, first: i64, last: i64, step: i64 },
    #[error(
        "{SLURM_COUNT} is {count}, but there are {row} numbers from {first} to {last}{}; use --part \
         from-env/N, and number tasks from 1 to N", steps(*.step)
    )]
    Gaps { count: i64, row: i64, first: i64, last: i64, step: i64 },
    #[error(
        "{array} is set, and {rank} is {number}: several processes would render the same part; \
         start one process in each task of the array"
    )]
    Both { array: &'static str, rank: &'static str, number: i64 },
    #[error(
        "{first} and {second} are both set, and give different parts or no number of parts; unset one of \
         them, or use --part K/N"
    )]
    SeveralArrays { first: &'static str, second: &'static str },
}

fn names() -> String {
    let names: Vec<_> = ARRAYS.iter().chain(&LAUNCHERS).map(|dialect| dialect.task).collect();
    format!("none of {} is set", names.join(", "))
}

fn steps(step: i64) -> impl fmt::Display {
    if step == 1 { String::new() } else { format!(" in steps of {step}") }
}

/// Returns the part that this process renders; `variable` returns the value of an environment variable. There
/// are `count` parts, or as many as the environment says.
///
/// With a `count`, the tasks of arrays that users number are 1 to `count`, so that an array of some of
/// these numbers renders some of the parts again.
pub(super) fn part(
    variable: &dyn Fn(&str) -> Option<String>,
    count: Option<u32>,
) -> Result<Part, TaskError> {
    let is_set = |dialect: &&TaskVariables| {
        variable(dialect.task).is_some_and(|value| !value.is_empty() && value != dialect.none)
    };
    let launcher = LAUNCHERS.iter().find(is_set);
    let mut arrays = ARRAYS.iter().filter(is_set);
    let Some(array) = arrays.next() else {
        return launcher.ok_or(TaskError::Nothing)?.part(variable, count);
    };
    let part = array.part(variable, count);
    if let Some(other) = arrays.find(|other| part.is_err() || other.part(variable, count) != part) {
        return Err(TaskError::SeveralArrays { first: array.task, second: other.task });
    }
    if let Some(TaskVariables { task: rank, row: Ranks { .. }, .. }) = launcher {
        let number = number(variable, rank)?.unwrap_or(0);
        if number > 0 {
            return Err(TaskError::Both { array: array.task, rank, number });
        }
    }
    part
}

impl TaskVariables {
    fn part(
        &self,
        variable: &dyn Fn(&str) -> Option<String>,
        count: Option<u32>,
    ) -> Result<Part, TaskError> {
        let Self { name, task, .. } = *self;
        let read = |name: &'static str| number(variable, name);
        let optional = |name: Option<&'static str>| name.map_or(Ok(None), read);
        let number = read(task)?.unwrap_or(0);
        let (first, last, step) = match (&self.row, count) {
            (row, Some(count)) => {
                let first = row.first_of_counted();
                (first, Some(first + i64::from(count) - 1), 1)
            }
            (Ranks { size }, None) => (0, read(size)?.map(|size| size - 1), 1),
            (Unbounded { first }, None) => (*first, None, 1),
            (Array { first, last, step }, None) => {
                (optional(*first)?.unwrap_or(1), read(last)?, optional(*step)?.unwrap_or(1).max(1))
            }
        };
        let last = last.ok_or(TaskError::NoCount { name, task, number })?;
        let row = (last.saturating_sub(first) / step).saturating_add(1);
        if let (None, "Slurm", Some(count)) = (count, name, read(SLURM_COUNT)?)
            && count != row
        {
            return Err(TaskError::Gaps { count, row, first, last, step });
        }
        let place = number.saturating_sub(first);
        let within = |value: i64| u32::try_from(value).ok();
        let part = within((place / step).saturating_add(1)).zip(within(row));
        let part = part.filter(|_| place >= 0 && place % step == 0);
        part.and_then(|(number, count)| Part::new(number, count)).ok_or(TaskError::Beyond {
            task,
            number,
            first,
            last,
            step,
        })
    }
}

impl Row {
    /// Number of the first task if the user gives the number of parts.
    fn first_of_counted(&self) -> i64 {
        match *self {
            Self::Array { .. } => 1,
            Self::Ranks { .. } => 0,
            Self::Unbounded { first } => first,
        }
    }
}

/// Parses the number in a variable, if it is set.
fn number(
    variable: &dyn Fn(&str) -> Option<String>,
    name: &'static str,
) -> Result<Option<i64>, TaskError> {
    let Some(text) = variable(name).filter(|text| !text.is_empty()) else { return Ok(None) };
    text.trim().parse().map(Some).map_err(|_| TaskError::NoNumber(name, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads the part from variables, written as in a shell.
    fn optional(variables: &str, count: Option<u32>) -> Result<String, String> {
        let value = |name: &str| {
            let mut pairs = variables.split(' ').filter_map(|pair| pair.split_once('='));
            pairs.find(|pair| pair.0 == name).map(|pair| pair.1.to_owned())
        };
        part(&value, count).map(|part| part.to_string()).map_err(|error| error.to_string())
    }

    const SLURM: &str = "SLURM_ARRAY_TASK_MIN=2 SLURM_ARRAY_TASK_MAX=10 SLURM_ARRAY_TASK_STEP=4";

    #[test]
    fn every_scheduler_is_understood() {
        for (variables, expected) in [
            ("SLURM_ARRAY_TASK_ID=6 SLURM_ARRAY_TASK_COUNT=3 SLURM_PROCID=0 SLURM_NTASKS=1", "2/3"),
            ("SLURM_ARRAY_TASK_ID=10", "3/3"),
            ("SGE_TASK_ID=5 SGE_TASK_FIRST=1 SGE_TASK_LAST=9 SGE_TASK_STEPSIZE=2", "3/5"),
            ("SGE_TASK_ID=undefined SLURM_PROCID=3 SLURM_NTASKS=4", "4/4"),
            ("LSB_JOBINDEX=8 LSB_JOBINDEX_END=8", "8/8"),
            ("LSB_JOBINDEX=0 OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=2", "1/2"),
            ("PMI_RANK=1 PMI_SIZE=2 SLURM_PROCID=0 SLURM_NTASKS=1", "2/2"),
            ("MV2_COMM_WORLD_RANK=1 MV2_COMM_WORLD_SIZE=3", "2/3"),
            ("PMIX_RANK=2 SLURM_NTASKS=4", "3/4"),
            ("AWS_BATCH_JOB_ARRAY_INDEX=0 AWS_BATCH_JOB_ARRAY_SIZE=5", "1/5"),
            ("AWS_BATCH_JOB_ARRAY_INDEX=4 AWS_BATCH_JOB_ARRAY_SIZE=5", "5/5"),
        ] {
            assert_eq!(optional(&format!("{SLURM} {variables}"), None), Ok(expected.to_owned()));
        }
    }

    #[test]
    fn a_count_may_be_given() {
        for (variables, expected) in [
            ("PBS_ARRAY_INDEX=3", "3/7"),
            ("PBS_ARRAYID=7", "7/7"),
            ("PARALLEL_SEQ=1", "1/7"),
            ("PMIX_RANK=0", "1/7"),
            ("JOB_COMPLETION_INDEX=0", "1/7"),
            ("JOB_COMPLETION_INDEX=6", "7/7"),
            ("AWS_BATCH_JOB_ARRAY_INDEX=6 AWS_BATCH_JOB_ARRAY_SIZE=7", "7/7"),
            // Two of seven, once more.
            (
                "SLURM_ARRAY_TASK_ID=5 SLURM_ARRAY_TASK_MIN=5 SLURM_ARRAY_TASK_MAX=6 \
                 SLURM_ARRAY_TASK_COUNT=2",
                "5/7",
            ),
        ] {
            assert_eq!(optional(variables, Some(7)), Ok(expected.to_owned()));
        }
    }

    #[track_caller]
    fn refused(variables: &str, count: Option<u32>, words: &[&str]) {
        let message = optional(variables, count).expect_err("no part");
        assert!(words.iter().all(|word| message.contains(word)), "{variables}: {message}");
    }

    #[test]
    fn insufficient_variables_are_named() {
        refused("", None, &["SLURM_ARRAY_TASK_ID", "PARALLEL_SEQ", "--part K/N"]);
        refused("SLURM_ARRAY_TASK_ID=", None, &["no scheduler"]);
        refused("PMI_RANK=x PMI_SIZE=2", None, &["PMI_RANK is `x`"]);
        refused("PMI_RANK=1 PMI_SIZE=1e3", None, &["PMI_SIZE is `1e3`"]);
        for task in [
            "PBS_ARRAY_INDEX",
            "PARALLEL_SEQ",
            "PMIX_RANK",
            "SLURM_ARRAY_TASK_ID",
            "JOB_COMPLETION_INDEX",
            "AWS_BATCH_JOB_ARRAY_INDEX",
        ] {
            refused(&format!("{task}=3"), None, &[task, "task 3", "from-env/N"]);
        }
    }

    #[test]
    fn invalid_task_numbers_are_refused() {
        let at = |number: &str| format!("{SLURM} SLURM_ARRAY_TASK_ID={number}");
        for number in ["1", "3", "14", "-2", "99999999999"] {
            refused(&at(number), None, &[number, "from 2 to 10 in steps of 4"]);
        }
        refused("PMI_RANK=2 PMI_SIZE=2", None, &["PMI_RANK is 2", "from 0 to 1"]);
        refused("PMI_RANK=0 PMI_SIZE=0", None, &["PMI_RANK is 0"]);
        refused("PBS_ARRAY_INDEX=0", Some(7), &["from 1 to 7"]);
        refused("JOB_COMPLETION_INDEX=7", Some(7), &["JOB_COMPLETION_INDEX is 7", "from 0 to 6"]);
        refused("JOB_COMPLETION_INDEX=-1", Some(7), &["JOB_COMPLETION_INDEX is -1"]);
        let fifth = "AWS_BATCH_JOB_ARRAY_INDEX=5 AWS_BATCH_JOB_ARRAY_SIZE=5";
        refused(fifth, None, &["AWS_BATCH_JOB_ARRAY_INDEX is 5", "from 0 to 4"]);
        let list = format!("{} SLURM_ARRAY_TASK_COUNT=2", at("2"));
        refused(&list, None, &["SLURM_ARRAY_TASK_COUNT is 2", "3 numbers", "from-env/N"]);
        let wide = "SLURM_ARRAY_TASK_ID=9223372036854775807 SLURM_ARRAY_TASK_MIN=-9 \
                    SLURM_ARRAY_TASK_MAX=9223372036854775807";
        refused(wide, None, &["SLURM_ARRAY_TASK_ID is"]);
    }

    #[test]
    fn processes_of_one_task_do_not_render_the_same_part() {
        let second = format!("{SLURM} SLURM_ARRAY_TASK_ID=2 SLURM_PROCID=1 SLURM_NTASKS=2");
        refused(&second, None, &["SLURM_ARRAY_TASK_ID is set", "SLURM_PROCID is 1"]);
    }

    #[test]
    fn arrays_that_contradict_each_other_are_refused() {
        let both = "SLURM_ARRAY_TASK_ID=2 JOB_COMPLETION_INDEX=2";
        let names = ["SLURM_ARRAY_TASK_ID", "JOB_COMPLETION_INDEX", "--part K/N"];
        refused(both, Some(4), &names);
        refused(both, None, &names);
        assert_eq!(
            optional("SLURM_ARRAY_TASK_ID=3 JOB_COMPLETION_INDEX=2", Some(4)),
            Ok("3/4".into())
        );
        assert_eq!(optional("PBS_ARRAY_INDEX=2 PBS_ARRAYID=2", Some(4)), Ok("2/4".into()));
        assert_eq!(
            optional("SGE_TASK_ID=undefined JOB_COMPLETION_INDEX=0", Some(4)),
            Ok("1/4".into())
        );
    }
}
