//! What engines are shown with.

/// Engines that share a panel and a palette of colours.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Group {
    /// Heading of their panel.
    pub name: &'static str,
    pub origin: Origin,
}

/// Whose engines they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// Another program's, which the ones of this are compared with.
    Foreign,
    Own,
    /// Of a report by another version, which this one does not have.
    Unknown,
}

/// Engines that this version does not have.
pub(crate) static OTHERS: Group = Group { name: "other engines", origin: Origin::Unknown };
