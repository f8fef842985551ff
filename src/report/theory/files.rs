//! Writes the folder of the theory: JSON, Markdown and pictures of each topic, and one page.

use std::path::{Path, PathBuf};

use maud::html;
use serde::Serialize;

use super::super::files::{WriteError, prepare, write_whole};
use super::super::record::Versions;
use super::super::{environment, page};
use super::{Data, Section, Topic};

/// Name and version of the JSON files.
pub const FILE_SCHEMA: &str = "rattlebench/theory/1";

/// One topic as JSON. It holds no timing and is the same whenever the same program writes it by the same command.
#[derive(Serialize)]
struct File<'a> {
    schema: &'static str,
    topic: &'static str,
    title: &'static str,
    finding: &'a str,
    versions: &'a Versions,
    command: &'a str,
    data: &'a Data,
}

/// Writes `<topic>.json`, `<topic>.md` where it has tables, its pictures, and `index.html` with all topics given. Returns
/// the sections and the page's path.
///
/// # Errors
/// A chart that cannot be drawn, a file that cannot be written.
pub fn write(topics: &[(&Topic, Data)], command: &str, folder: &Path) -> Result<(Vec<Section>, PathBuf), WriteError> {
    prepare(folder)?;
    let versions = environment::versions();
    let mut sections = Vec::new();
    for (topic, data) in topics {
        let section = data.section(topic.name)?;
        let (title, finding) = (section.title, section.finding.as_str());
        let file = File { schema: FILE_SCHEMA, topic: topic.name, title, finding, versions: &versions, command, data };
        let json = serde_json::to_string(&file)? + "\n";
        write_whole(&folder.join(format!("{}.json", topic.name)), json.as_bytes())?;
        if !section.tables.is_empty() {
            write_whole(&folder.join(format!("{}.md", topic.name)), markdown(&section).as_bytes())?;
        }
        for (name, picture) in &section.charts {
            write_whole(&folder.join(name), &picture.png)?;
        }
        sections.push(section);
    }
    let index = folder.join("index.html");
    write_whole(&index, html(&sections, &versions, command).as_bytes())?;
    Ok((sections, index))
}

fn markdown(section: &Section) -> String {
    let mut text = format!("# {}\n\n{}\n\n{}\n", section.title, section.finding, section.explanation);
    for table in &section.tables {
        text += "\n";
        text += &table.markdown();
    }
    text
}

fn html(sections: &[Section], versions: &Versions, command: &str) -> String {
    let body = html! {
        p.description {
            "The claims of J. E. Marsden and M. West, “Discrete mechanics and variational integrators”, Acta Numerica 10 \
             (2001), and of G. W. Patrick and C. Cuell, “Error analysis of variational integrators of unconstrained \
             Lagrangian systems” (2008/09), as computed here."
        }
        @for section in sections {
            h2 { (section.title) }
            (page::finding_box(&section.finding))
            p { (section.explanation) }
            @for (_, picture) in &section.charts { (page::figure(picture)) }
            @for table in &section.tables { (table.html()) }
        }
        (page::version_list(versions))
        (page::command_line(command))
    };
    page::document("Discrete mechanics", body)
}
