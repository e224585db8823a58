//! A self-contained HTML page of all reports, without scripts and external resources.

use super::draw::draw;
use super::{Machine, Report, Table};
use spherule_render::graphics::{Format, PageError};
use std::fmt::Write;

const HEAD: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
<meta name=\"viewport\" content=\"width=device-width\">\n<title>Spherule, measured</title>\n\
<style>\n\
body { font: 16px/1.5 sans-serif; color: #282828; max-width: 1100px; margin: 2em auto; \
padding: 0 1em; }\n\
h1, h2, h3 { line-height: 1.2; }\nh2 { margin-top: 3em; border-bottom: 2px solid #ddd; }\n\
svg { width: 100%; height: auto; margin: 1em 0; }\n\
table { border-collapse: collapse; font-size: 14px; margin: 1em 0; }\n\
.wide { overflow-x: auto; }\n\
th, td { padding: 0.15em 0.8em; text-align: right; white-space: nowrap; \
border-bottom: 1px solid #eee; }\n\
th { vertical-align: bottom; border-bottom: 2px solid #bbb; }\n\
th small { font-weight: normal; color: #666; }\n\
.left { text-align: left; }\ndl { font-size: 14px; }\ndt { font-weight: bold; }\n\
dd { margin: 0 0 0.3em 1.5em; }\n.note { color: #555; font-size: 14px; }\n\
</style>\n</head>\n<body>\n";

/// Attribute of text cells, which are aligned left.
const LEFT: &str = " class=\"left\"";

/// Returns the page.
///
/// # Errors
/// A plot cannot be drawn.
pub fn page(machine: &Machine, reports: &[Report]) -> Result<String, PageError> {
    let mut page = HEAD.to_owned();
    page += "<h1>Spherule, measured</h1>\n";
    page += &pairs(&machine.facts);
    page += "<ul>\n";
    for report in reports {
        let (name, title) = (escape(&report.name), escape(&report.title));
        let _ = writeln!(page, "<li><a href=\"#{name}\">{name}</a>: {title}</li>");
    }
    page += "</ul>\n";
    for report in reports {
        page += &section(report)?;
    }
    Ok(page + "</body>\n</html>\n")
}

/// Returns whether the content of a file is a page by [`page`], of this or another version.
pub fn is_page(content: &[u8]) -> bool {
    let start = String::from_utf8_lossy(&content[..content.len().min(HEAD.len())]);
    start.starts_with("<!DOCTYPE html>") && start.contains("<title>Spherule, measured</title>")
}

fn section(report: &Report) -> Result<String, PageError> {
    let [name, title, about] = [&report.name, &report.title, &report.about].map(|x| escape(x));
    // Writing to a string cannot fail.
    let mut text = format!("<h2 id=\"{name}\">{title}</h2>\n<p>{about}</p>\n");
    let _ = writeln!(text, "<p class=\"note\"><code>spherule bench {name}</code></p>");
    text += &pairs(&report.settings);
    for plot in &report.plots {
        text += &String::from_utf8_lossy(&draw(plot, Format::Svg)?);
    }
    for table in &report.tables {
        let _ = write!(text, "<h3>{}</h3>\n{}", escape(&table.title), grid(table));
    }
    Ok(text)
}

fn pairs(pairs: &[(String, String)]) -> String {
    let mut text = "<table>\n".to_owned();
    for (name, value) in pairs {
        let (name, value) = (escape(name), escape(value));
        let _ = writeln!(text, "<tr><td{LEFT}>{name}</td><td{LEFT}>{value}</td></tr>");
    }
    text + "</table>\n"
}

fn grid(table: &Table) -> String {
    let alignment = |i: usize| {
        let text = i == 0 || table.rows.iter().any(|row| row[i].is_text());
        if text { LEFT } else { "" }
    };
    let mut text = "<div class=\"wide\"><table>\n<tr>".to_owned();
    for (i, column) in table.columns.iter().enumerate() {
        let [group, name, unit] = [&column.group, &column.name, &column.unit].map(|x| escape(x));
        let group = if group.is_empty() { group } else { format!("<small>{group}</small><br>") };
        let _ = write!(text, "<th{}>{group}{name}<br><small>{unit}</small></th>", alignment(i));
    }
    text += "</tr>\n";
    for row in &table.rows {
        text += "<tr>";
        for (i, (cell, column)) in row.iter().zip(&table.columns).enumerate() {
            let _ = write!(text, "<td{}>{}</td>", alignment(i), escape(&cell.text(column.style)));
        }
        text += "</tr>\n";
    }
    text += "</table></div>\n";
    for note in &table.notes {
        let _ = writeln!(text, "<p class=\"note\">{}</p>", escape(note));
    }
    text + &descriptions(table)
}

/// Returns the descriptions of the columns.
fn descriptions(table: &Table) -> String {
    let mut text = "<details><summary class=\"note\">Columns</summary><dl>\n".to_owned();
    for column in &table.columns {
        let (heading, about) = (escape(&column.heading()), escape(&column.about));
        let _ = writeln!(text, "<dt>{heading}</dt><dd>{about}</dd>");
    }
    text + "</dl></details>\n"
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Axis, Column, Plot, Point, Series};

    #[test]
    fn the_page_is_self_contained() {
        let mut table = Table::new("a", "A < B", vec![Column::new("x", "what is <x>")]);
        table.push(["1 & 2".into()]);
        let plot = Plot {
            name: "p".into(),
            title: "P".into(),
            about: String::new(),
            note: String::new(),
            place: Axis::linear("threads", ""),
            value: Axis::log("time", "s"),
            series: vec![Series::marks("one", [Point::new(1.0, 2.0)])],
        };
        let report = Report {
            name: "test".into(),
            tables: vec![table],
            plots: vec![plot],
            ..Report::default()
        };
        let page = page(&Machine::this(1), &[report]).unwrap();
        assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
        for words in ["A &lt; B", "1 &amp; 2", "what is &lt;x&gt;", "<svg", "</svg>", "processor"] {
            assert!(page.contains(words), "{words}");
        }
        let namespaces = ["http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"];
        let outside = namespaces.iter().fold(page, |page, name| page.replace(name, ""));
        for reference in ["http:", "https:", "src=", "url(", "<script", "<link"] {
            assert!(!outside.contains(reference), "{reference}");
        }
    }
}
