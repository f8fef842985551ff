//! The page of the theory and its Markdown, of all topics that are there.

use std::path::Path;

use maud::{Markup, html};

use super::section::Section;
use super::{energy, long_time, orders, small_steps};
use crate::report::charts::ChartError;
use crate::report::page::document as page;
use crate::report::record::environment::Versions;
use crate::report::record::theory::{Data, TheoryFile};

/// Tables, charts and words of a topic.
///
/// # Errors
/// A chart that cannot be drawn.
pub fn section(data: &Data, topic: &str) -> Result<Section, ChartError> {
    match data {
        Data::Orders(problems) => orders::section(problems),
        Data::Energy(record) => energy::section(record, topic),
        Data::LongTime(rows) => long_time::section(rows),
        Data::SmallSteps(problems) => small_steps::section(problems),
    }
}

pub(crate) fn markdown(section: &Section) -> String {
    let mut text = format!("# {}\n\n{}\n\n{}\n", section.title, section.finding, section.explanation);
    for table in &section.tables {
        text += "\n";
        text += &table.markdown();
    }
    text
}

pub fn html(sections: &[(&TheoryFile, Section)], folder: &Path) -> String {
    let body = html! {
        p.description {
            "The claims of J. E. Marsden and M. West, “Discrete mechanics and variational integrators”, Acta \
             Numerica 10 (2001), and of G. W. Patrick and C. Cuell, “Error analysis of variational integrators of \
             unconstrained Lagrangian systems” (2008/09), as computed here."
        }
        @if sections.len() > 1 {
            ul { @for (file, section) in sections { li { a href={ "#" (file.topic) } { (section.title) } } } }
        }
        @for (file, section) in sections {
            h2 id=(file.topic) { (section.title) }
            (page::finding_box(&section.finding))
            p { (section.explanation) }
            @for (_, picture) in &section.charts { (page::figure(picture)) }
            @for table in &section.tables { (table.html()) }
            (links(file, section, folder))
        }
        (origin(sections))
    };
    page::document("Discrete mechanics", body)
}

/// The files of a topic that stand beside the page.
fn links(file: &TheoryFile, section: &Section, folder: &Path) -> Markup {
    let json = format!("{}.json", file.topic);
    let text = format!("{}.md", file.topic);
    html! {
        p.small {
            @if folder.join(&json).exists() { "Data: " a href=(json) { (json) } ". " }
            @if !section.tables.is_empty() { "Tables: " a href=(text) { (text) } "." }
        }
    }
}

/// Versions and command lines that the topics come from, each once.
fn origin(sections: &[(&TheoryFile, Section)]) -> Markup {
    let mut versions: Vec<&Versions> = Vec::new();
    let mut commands: Vec<&str> = Vec::new();
    for (file, _) in sections {
        if !versions.contains(&&file.versions) {
            versions.push(&file.versions);
        }
        if !commands.contains(&file.command.as_str()) {
            commands.push(&file.command);
        }
    }
    html! {
        @for versions in versions { (page::version_list(versions)) }
        (page::command_line(&commands.join("\n")))
    }
}
