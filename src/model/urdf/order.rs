//! The order of a model: one root, every parent before its child.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use super::error::Problem;

/// A joint of the file, by the names of what it joins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge<'a> {
    pub joint: &'a str,
    pub parent: &'a str,
    pub child: &'a str,
}

/// Links and joints in tree order, by their index in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Order {
    /// `None` is the ground, under the name `world`, that joints name as a parent and no link defines.
    pub root: Option<usize>,
    /// Each joint carries one link: place `k` here carries the link at place `k + 1` of the model, the root being 0.
    pub joints: Vec<usize>,
    /// The link that each joint of `joints` carries.
    pub children: Vec<usize>,
}

/// The parent that means the ground where no link has that name.
pub(in crate::model) const WORLD: &str = "world";

/// Orders links and joints: parents before children, otherwise as in the file.
///
/// # Errors
/// Duplicate names, undefined links, a link with two parents, a cycle, more than one root.
pub(super) fn order(links: &[&str], edges: &[Edge]) -> Result<Order, Problem> {
    let places = unique("link", links.iter().copied())?;
    unique("joint", edges.iter().map(|e| e.joint))?;
    let undefined = |edge: &Edge, role, link: &str| Problem::UndefinedLink {
        joint: edge.joint.to_owned(),
        role,
        link: link.to_owned(),
        links: links.iter().map(|l| (*l).to_owned()).collect(),
    };
    // Index links by place; the ground that is only named as a parent comes after them.
    let ground = links.len();
    let mut carried_by: Vec<Option<usize>> = vec![None; links.len()];
    let mut carries: Vec<Vec<usize>> = vec![Vec::new(); links.len() + 1];
    for (j, edge) in edges.iter().enumerate() {
        let parent = match places.get(edge.parent) {
            Some(&place) => place,
            None if edge.parent == WORLD => ground,
            None => return Err(undefined(edge, "parent", edge.parent)),
        };
        let &child = places.get(edge.child).ok_or_else(|| undefined(edge, "child", edge.child))?;
        if let Some(first) = carried_by[child].replace(j) {
            let first = edges[first].joint.to_owned();
            return Err(Problem::TwoParents { link: edge.child.to_owned(), first, second: edge.joint.to_owned() });
        }
        carries[parent].push(j);
    }

    let on_ground = !carries[ground].is_empty();
    let mut roots: Vec<usize> = (0..links.len()).filter(|l| carried_by[*l].is_none()).collect();
    if on_ground {
        roots.insert(0, ground);
    }
    let Some(&root) = roots.first() else { return Err(cycle(0, &carried_by, &places, edges)) };

    let mut ready: BinaryHeap<Reverse<usize>> = roots.iter().flat_map(|r| &carries[*r]).map(|j| Reverse(*j)).collect();
    let (mut joints, mut children) = (Vec::with_capacity(edges.len()), Vec::with_capacity(edges.len()));
    while let Some(Reverse(j)) = ready.pop() {
        let child = places[edges[j].child];
        joints.push(j);
        children.push(child);
        ready.extend(carries[child].iter().map(|j| Reverse(*j)));
    }
    if joints.len() < edges.len() {
        let mut reached = vec![false; links.len()];
        roots.iter().chain(&children).filter(|l| **l != ground).for_each(|l| reached[*l] = true);
        let lost = reached.iter().position(|r| !r).unwrap_or_default();
        return Err(cycle(lost, &carried_by, &places, edges));
    }
    if roots.len() > 1 {
        let name = |r: &usize| links.get(*r).copied().unwrap_or(WORLD).to_owned();
        return Err(Problem::SeveralRoots { roots: roots.iter().map(name).collect() });
    }
    Ok(Order { root: (!on_ground).then_some(root), joints, children })
}

fn unique<'a>(tag: &str, names: impl Iterator<Item = &'a str>) -> Result<HashMap<&'a str, usize>, Problem> {
    let mut places = HashMap::new();
    for (place, name) in names.enumerate() {
        if places.insert(name, place).is_some() {
            return Err(Problem::Duplicate { element: format!("{tag} '{name}'") });
        }
    }
    Ok(places)
}

/// Climbs from a link that no root reaches until a link comes again: those links are the cycle.
fn cycle(start: usize, carried_by: &[Option<usize>], places: &HashMap<&str, usize>, edges: &[Edge]) -> Problem {
    let mut climbed: Vec<usize> = Vec::new();
    let mut seen = vec![false; carried_by.len()];
    let mut link = start;
    while let Some(joint) = carried_by[link] {
        if seen[link] {
            break;
        }
        seen[link] = true;
        climbed.push(joint);
        link = places[edges[joint].parent];
    }
    let first = climbed.iter().position(|j| places[edges[*j].child] == link).unwrap_or_default();
    let mut around: Vec<usize> = climbed[first..].iter().rev().copied().collect();
    let earliest = around.iter().enumerate().min_by_key(|(_, j)| **j).map_or(0, |(place, _)| place);
    around.rotate_left(earliest);
    // The joint of the cycle that stands last in the file is the one that closes it.
    let closing = around.iter().max().map(|j| edges[*j].joint.to_owned()).unwrap_or_default();
    let mut path: Vec<String> = around.iter().map(|j| edges[*j].parent.to_owned()).collect();
    path.extend(around.first().map(|j| edges[*j].parent.to_owned()));
    Problem::Cycle { joint: closing, path }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge<'a>(joint: &'a str, parent: &'a str, child: &'a str) -> Edge<'a> {
        Edge { joint, parent, child }
    }

    #[test]
    fn file_order_is_kept_where_parents_come_first() {
        let edges = [edge("j1", "a", "b"), edge("j2", "a", "c"), edge("j3", "b", "d")];
        let order = order(&["a", "b", "c", "d"], &edges).unwrap();
        assert_eq!(order, Order { root: Some(0), joints: vec![0, 1, 2], children: vec![1, 2, 3] });
    }

    #[test]
    fn a_joint_waits_for_its_parent() {
        let edges = [edge("leaf", "b", "c"), edge("stem", "a", "b"), edge("other", "a", "d")];
        let order = order(&["c", "b", "d", "a"], &edges).unwrap();
        assert_eq!(order, Order { root: Some(3), joints: vec![1, 0, 2], children: vec![1, 0, 2] });
    }

    #[test]
    fn an_undefined_world_is_the_root() {
        let order = order(&["a", "b"], &[edge("j1", "world", "a"), edge("j2", "world", "b")]).unwrap();
        assert_eq!(order, Order { root: None, joints: vec![0, 1], children: vec![0, 1] });
    }

    #[test]
    fn a_cycle_beside_a_tree_is_found() {
        let edges = [edge("j1", "a", "b"), edge("j2", "d", "c"), edge("j3", "c", "d"), edge("j4", "d", "e")];
        match order(&["e", "a", "b", "c", "d"], &edges) {
            Err(Problem::Cycle { joint, path }) => {
                assert_eq!(joint, "j3");
                assert_eq!(path, ["d", "c", "d"]);
            }
            other => panic!("{other:?}"),
        }
    }
}
