//! Tables of fixed-width columns for the terminal.

use serde_json::Value;

/// Lines of a table: the first column to the left, the others to the right, as wide as their widest cell.
pub(super) fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([header[column].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: Vec<&str>| {
        let place = |(column, cell): (usize, &&str)| {
            let width = widths[column];
            if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        };
        cells.iter().enumerate().map(place).collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    let mut lines = vec![line(header.to_vec())];
    lines.push(widths.iter().map(|&width| "─".repeat(width)).collect::<Vec<_>>().join("  "));
    lines.extend(rows.iter().map(|row| line(row.iter().map(String::as_str).collect())));
    lines.join("\n")
}

/// A number of a report as text: whole numbers as they are, others with three decimals, absent ones as `–`.
pub(super) fn cell(value: &Value) -> String {
    match value {
        Value::Null => "–".to_owned(),
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(String::new, |number| format!("{number:.3}")),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// The lines of a report that people read first.
pub(super) fn summary(report: &Value) -> String {
    let result = &report["result"];
    let mut rows = Vec::new();
    let mut add = |name: String, value: &Value| {
        if !value.is_array() && !value.is_object() {
            rows.push(vec![name, cell(value)]);
        }
    };
    for (part, name) in
        [("/counts", "simulation"), ("/association/counts", "association"), ("/tfa/counts", "tfa"), ("/tfa/probability", "tfa probability")]
    {
        for (key, value) in result.pointer(part).and_then(Value::as_object).into_iter().flatten() {
            add(format!("{name} {}", key.replace('_', " ")), value);
        }
    }
    for (key, value) in report["timing"].as_object().into_iter().flatten() {
        add(format!("time {}", key.trim_end_matches("_s")), value);
    }
    let mut text = table(&["quantity", "value"], &rows);
    for warning in report["warnings"].as_array().into_iter().flatten() {
        text.push_str(&format!("\nwarning: {}", cell(warning)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = vec![vec!["radar".to_owned(), "7".to_owned()], vec!["é".to_owned(), "12.500".to_owned()]];
        assert_eq!(table(&["name", "n"], &rows), "name        n\n─────  ──────\nradar       7\né      12.500");
    }

    #[test]
    fn absent_numbers_are_a_dash_and_fractions_have_three_decimals() {
        assert_eq!([cell(&Value::Null), cell(&json!(3)), cell(&json!(0.56338)), cell(&json!("x"))], ["–", "3", "0.563", "x"]);
    }
}
