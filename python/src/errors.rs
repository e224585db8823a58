//! Errors as Python exceptions, with the texts of the program.

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use spherule::particles::FileError;
use std::fmt::Display;

/// The name of scenes that keywords describe, in place of a file's.
pub(crate) const KEYWORDS: &str = "<keywords>";

/// The exception `spherule.Error`.
pub(crate) fn error(py: Python<'_>, text: &dyn Display) -> PyErr {
    with_place(py, &text.to_string(), None, None)
}

/// The exception for a file, with path and line; for keywords, with the faulty one.
pub(crate) fn of_file(py: Python<'_>, error: &FileError) -> PyErr {
    if error.path.as_os_str() != KEYWORDS {
        let path = error.path.to_string_lossy().into_owned();
        return with_place(py, &error.to_string(), Some(path), error.line());
    }
    let help = error.help.as_ref().map_or_else(String::new, |help| format!("\nhelp: {help}"));
    let place = error.place.as_ref().map_or_else(String::new, |place| {
        let lines: Vec<&str> = place.source_text.lines().collect();
        let line = lines.get(place.line - 1).copied().unwrap_or_default();
        let section = lines.iter().take(place.line - 1).rev().find(|line| line.starts_with('['));
        let section = section.filter(|_| !line.starts_with('['));
        let section = section.map_or_else(String::new, |section| format!("{section} "));
        format!("{section}{line}: ")
    });
    with_place(py, &format!("{place}{}{help}", error.message), None, None)
}

fn with_place(py: Python<'_>, text: &str, path: Option<String>, line: Option<usize>) -> PyErr {
    let made = py
        .import("spherule._errors")
        .and_then(|module| module.getattr("Error"))
        .and_then(|class| class.call1((text, path, line)));
    match made {
        Ok(made) => PyErr::from_value(made),
        // The package is broken: the text is what matters.
        Err(_) => PyValueError::new_err(text.to_owned()),
    }
}

/// The exception for a thread that died.
pub(crate) fn internal() -> PyErr {
    PyRuntimeError::new_err("a thread of Spherule died: this is a bug, please report it")
}
