//! What is asked of an element while a URDF file is walked, and what is noted down.

use roxmltree::Node;

use super::error::{ModelError, Position, Problem};
use crate::model::robot::Ignored;

/// A URDF file whose form is right.
pub(super) struct Document {
    /// The elements that a model is made from, and no others, as XML for urdf-rs.
    pub essence: String,
    /// For each link of the file whether it has an `<inertial>`.
    pub has_inertial: Vec<bool>,
    /// In the order of the file.
    pub ignored: Vec<Ignored>,
    pub remarks: Vec<String>,
}

/// A walk through a file, with what has been found so far.
pub(super) struct Walk<'a> {
    pub file: &'a str,
    pub xml: &'a roxmltree::Document<'a>,
    pub found: Document,
}

impl<'a> Walk<'a> {
    pub(super) fn fault(&self, node: Node, problem: Problem) -> ModelError {
        let pos = self.xml.text_pos_at(node.range().start);
        let position = Some(Position { line: pos.row, column: pos.col });
        ModelError { file: self.file.to_owned(), position, problem: Box::new(problem) }
    }

    pub(super) fn name(&self, node: Node<'a, 'a>) -> Result<&'a str, ModelError> {
        let name = node.attribute("name").filter(|name| !name.trim().is_empty());
        name.ok_or_else(|| self.fault(node, Problem::Unnamed { tag: tag(node) }))
    }

    /// The child element of that name, if there is one.
    pub(super) fn only(
        &self,
        node: Node<'a, 'a>,
        element: &str,
        name: &str,
    ) -> Result<Option<Node<'a, 'a>>, ModelError> {
        let mut all = elements(node).filter(|child| tag(*child) == name);
        let first = all.next();
        match all.next() {
            Some(second) => {
                Err(self.fault(second, Problem::Repeated { element: element.to_owned(), tag: name.to_owned() }))
            }
            None => Ok(first),
        }
    }

    pub(super) fn required(&self, node: Node<'a, 'a>, element: &str, name: &str) -> Result<Node<'a, 'a>, ModelError> {
        let problem = || Problem::MissingElement { element: element.to_owned(), tag: name.to_owned() };
        self.only(node, element, name)?.ok_or_else(|| self.fault(node, problem()))
    }

    pub(super) fn required_attribute(
        &self,
        node: Node<'a, 'a>,
        element: &str,
        name: &str,
    ) -> Result<&'a str, ModelError> {
        let problem =
            || Problem::MissingAttribute { element: element.to_owned(), tag: tag(node), attribute: name.to_owned() };
        node.attribute(name).ok_or_else(|| self.fault(node, problem()))
    }

    pub(super) fn required_numbers(
        &self,
        node: Node<'a, 'a>,
        element: &str,
        name: &str,
        count: usize,
    ) -> Result<&'a str, ModelError> {
        self.required_attribute(node, element, name)?;
        Ok(self.numbers(node, element, name, count)?.unwrap_or_default())
    }

    /// An attribute that holds `count` finite numbers, if it is there.
    pub(super) fn numbers(
        &self,
        node: Node<'a, 'a>,
        element: &str,
        name: &str,
        count: usize,
    ) -> Result<Option<&'a str>, ModelError> {
        let Some(value) = node.attribute(name) else { return Ok(None) };
        let (element, tag, attribute) = (element.to_owned(), tag(node), name.to_owned());
        if value.split_whitespace().count() != count || parse(value).count() != count {
            let expected = if count == 1 { "a number".to_owned() } else { format!("{count} numbers") };
            let problem = Problem::NotANumber { element, tag, attribute, value: value.to_owned(), expected };
            return Err(self.fault(node, problem));
        }
        if parse(value).any(|x| !x.is_finite()) {
            let problem = Problem::NotFinite { element, tag, attribute, value: value.to_owned() };
            return Err(self.fault(node, problem));
        }
        Ok(Some(value))
    }

    pub(super) fn ignore(&mut self, element: &str, what: &str, value: String) {
        self.found.ignored.push(Ignored { element: element.to_owned(), what: what.to_owned(), value });
    }

    pub(super) fn ignore_other_attributes(&mut self, node: Node, element: &str, known: &[&str]) {
        for attribute in node.attributes().filter(|a| !known.contains(&a.name())) {
            let what = format!("attribute {} of <{}>", attribute.name(), tag(node));
            self.ignore(element, &what, attribute.value().to_owned());
        }
    }

    pub(super) fn ignore_other_children(&mut self, node: Node, element: &str, known: &[&str]) {
        for child in elements(node).filter(|c| !known.contains(&tag(*c).as_str())) {
            self.ignore(element, &format!("<{}> in <{}>", tag(child), tag(node)), attributes_text(child));
        }
    }

    pub(super) fn open(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.found.essence.push('>');
    }

    pub(super) fn leaf(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.found.essence.push_str("/>");
    }

    fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        let out = &mut self.found.essence;
        out.push('<');
        out.push_str(tag);
        for (name, value) in attributes {
            let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
            out.push_str(&format!(" {name}=\"{value}\""));
        }
    }

    pub(super) fn close(&mut self, tag: &str) {
        self.found.essence.push_str(&format!("</{tag}>"));
    }
}

pub(super) fn elements<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(Node::is_element)
}

/// Name of an element as written, with its prefix where it is not in the namespace of the root.
pub(super) fn tag(node: Node) -> String {
    let name = node.tag_name().name();
    let root = node.document().root_element().tag_name().namespace();
    match node.tag_name().namespace() {
        Some(namespace) if Some(namespace) != root => {
            format!("{}:{name}", node.lookup_prefix(namespace).unwrap_or_default())
        }
        _ => name.to_owned(),
    }
}

pub(super) fn attributes_text(node: Node) -> String {
    node.attributes().map(|a| format!("{} {}", a.name(), a.value())).collect::<Vec<_>>().join(", ")
}

pub(super) fn count_of(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

pub(super) fn parse(value: &str) -> impl Iterator<Item = f64> {
    value.split_whitespace().filter_map(|x| x.parse().ok())
}
