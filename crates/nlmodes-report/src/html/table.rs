//! Tables of the page.

use crate::svg::escape;

/// Number of rows above which a table is laid out only when visible: thousands take a browser seconds.
const LONG: usize = 100;

/// A table with a title, as text.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataTable {
    /// Title; a table without rows is left out.
    pub title: String,
    /// Names of the columns, with their units.
    pub head: Vec<String>,
    /// Cells, row by row; those that begin like a number are right-aligned.
    pub rows: Vec<Vec<String>>,
    /// The branch of the page whose points are in the first column, where a click selects them.
    pub chooses: Option<usize>,
}

impl DataTable {
    /// An empty table.
    pub fn new(title: impl Into<String>, head: &[&str]) -> Self {
        let head = head.iter().map(|name| String::from(*name)).collect();
        Self { title: title.into(), head, ..Self::default() }
    }

    pub(super) fn html(&self) -> String {
        let plain = |text: &String| cell(text, &escape(text));
        let first = |text: &String| match (self.chooses, text.parse()) {
            (Some(branch), Ok(point)) => point_cell(branch, point),
            _ => plain(text),
        };
        let row = |row: &Vec<String>| row.iter().take(1).map(first).chain(row.iter().skip(1).map(plain)).collect();
        self.html_with(self.rows.iter().map(row).collect())
    }

    /// With rows of cells that are HTML already.
    pub(super) fn html_with(&self, rows: Vec<Vec<String>>) -> String {
        if rows.is_empty() {
            return String::new();
        }
        let is_number =
            |column: usize| rows.iter().any(|row| row.get(column).is_some_and(|c| c.contains("\"number\"")));
        let class = |column: usize| if is_number(column) { " class=\"number\"" } else { "" };
        let names = self.head.iter().enumerate();
        let head: String =
            names.map(|(k, name)| format!("<th scope=\"col\"{}>{}</th>", class(k), escape(name))).collect();
        let body: String = rows.iter().map(|cells| format!("<tr>{}</tr>\n", cells.concat())).collect();
        let title = escape(&self.title);
        let long = if rows.len() > LONG { " long" } else { "" };
        format!(
            "<section><h3>{title}</h3><div class=\"scroll{long}\" role=\"region\" tabindex=\"0\" \
                aria-label=\"{title}\"><table><thead><tr>{head}</tr></thead>\n\
                <tbody>\n{body}</tbody></table></div></section>\n"
        )
    }
}

/// Most letters of a cell that is kept on one line since it begins like a number; lists of ranges are longer.
const UNBROKEN: usize = 40;

/// A cell; `text` determines its alignment.
pub(super) fn cell(text: &str, html: &str) -> String {
    let is_short = text.chars().count() <= UNBROKEN;
    let number = is_short && text.trim_start_matches(['−', '+']).starts_with(|c: char| c.is_ascii_digit());
    let number = number || text == "–";
    let class = if number { " class=\"number\"" } else { "" };
    format!("<td{class}>{html}</td>")
}

/// A cell with the number of a point, which selects it.
pub(super) fn point_cell(branch: usize, point: usize) -> String {
    let button = format!("<button type=\"button\" data-branch=\"{branch}\" data-point=\"{point}\">{point}</button>");
    cell("0", &button)
}
