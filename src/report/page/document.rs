//! What all pages are made of: the frame, findings, pictures, tables and origins.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::report::record::environment::{Machine, Versions};
use crate::report::words::summary::Words;

/// A chart to be put into the page.
#[derive(Debug)]
pub struct Picture {
    pub caption: &'static str,
    pub png: Vec<u8>,
}

/// A whole page: its title as heading, and what stands below.
pub(in crate::report) fn document(title: &str, body: Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " – rattlebench" }
                style { (PreEscaped(include_str!("page.css"))) }
            }
            body {
                main {
                    h1 { (title) }
                    (body)
                }
            }
        }
    }
    .into_string()
        + "\n"
}

/// The sentence that says what was found.
pub(in crate::report) fn finding_box(sentence: &str) -> Markup {
    html! { p.finding { (sentence.replace(" × ", "\u{a0}×\u{a0}")) } }
}

/// A chart with its caption, the picture inside the page.
pub(in crate::report) fn figure(picture: &Picture) -> Markup {
    html! {
        figure {
            img alt=(picture.caption) src={ "data:image/png;base64," (STANDARD.encode(&picture.png)) };
            figcaption { (picture.caption) "." }
        }
    }
}

/// A table of words.
pub(in crate::report) fn words(words: &Words) -> Markup {
    html! {
        div.wide {
            table.words {
                thead { tr { @for head in &words.head { th.word { (head) } } } }
                tbody { @for row in &words.rows { tr { @for cell in row { td.word { (cell) } } } } }
            }
        }
    }
}

pub(in crate::report) fn machine_list(machine: &Machine) -> Markup {
    html! {
        h2 { "Machine" }
        dl {
            @if let Some(cpu) = &machine.cpu { dt { "Processor" } dd { (cpu) } }
            @if let Some(cores) = machine.logical_cores { dt { "Logical cores" } dd { (cores) } }
            dt { "System" } dd { (machine.os) ", " (machine.architecture) }
        }
    }
}

pub(in crate::report) fn version_list(versions: &Versions) -> Markup {
    html! {
        h2 { "Versions" }
        dl {
            dt { "rattlebench" } dd { (versions.rattlebench) }
            @for (name, version) in &versions.crates { dt { (name) } dd { (version) } }
            dt { "rustc" } dd { (versions.rustc) ", " (versions.profile) " build" }
        }
    }
}

pub(in crate::report) fn command_line(command: &str) -> Markup {
    html! {
        h2 { "Command" }
        pre { code { (command) } }
    }
}
