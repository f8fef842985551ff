//! A table of text, as Markdown and for the page.

use maud::{Markup, html};

/// A heading for each column, and rows of as many cells. The first column holds names, the others numbers.
#[derive(Debug)]
pub(crate) struct Table {
    pub caption: String,
    pub headings: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = &str>| format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
        let mut text = format!("{}\n\n", self.caption);
        text += &line(&mut self.headings.iter().copied());
        text += &line(&mut (0..self.headings.len()).map(|i| if i == 0 { "---" } else { "---:" }));
        for row in &self.rows {
            text += &line(&mut row.iter().map(String::as_str));
        }
        text
    }

    pub fn html(&self) -> Markup {
        let class = |i: usize| if i == 0 { "word" } else { "number" };
        html! {
            p.small { (self.caption) }
            div.wide {
                table {
                    thead {
                        tr {
                            @for (i, heading) in self.headings.iter().enumerate() {
                                th class=(class(i)) { (heading) }
                            }
                        }
                    }
                    tbody {
                        @for row in &self.rows {
                            tr { @for (i, cell) in row.iter().enumerate() { td class=(class(i)) { (cell) } } }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_markdown() {
        let table = Table {
            caption: "Orders.".into(),
            headings: vec!["method", "map"],
            rows: vec![vec!["midpoint".into(), "2.00".into()]],
        };
        assert_eq!(table.markdown(), "Orders.\n\n| method | map |\n| --- | ---: |\n| midpoint | 2.00 |\n");
    }
}
