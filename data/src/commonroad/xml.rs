//! Elements of a scenario as numbers and words.

use roxmltree::Node;

/// Where in the text something is wrong, and what.
pub(super) struct Fault(pub(super) usize, pub(super) String);

pub(super) fn fault(node: Node<'_, '_>, problem: String) -> Fault {
    Fault(node.range().start, problem)
}

/// The elements called `name` in `node`.
pub(super) fn children<'d, 'i>(
    node: Node<'d, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'d, 'i>> {
    node.children()
        .filter(move |child| child.has_tag_name(name))
}

/// The element at the end of `path` from `node`.
pub(super) fn find<'d, 'i>(node: Node<'d, 'i>, path: &[&str]) -> Option<Node<'d, 'i>> {
    path.iter().try_fold(node, |node, name| {
        node.children().find(|child| child.has_tag_name(*name))
    })
}

/// The same; an element without it is wrong.
pub(super) fn required<'d, 'i>(node: Node<'d, 'i>, path: &[&str]) -> Result<Node<'d, 'i>, Fault> {
    let missing = || {
        let (tag, path) = (node.tag_name().name(), path.join("/"));
        fault(node, format!("<{tag}> without <{path}>"))
    };
    find(node, path).ok_or_else(missing)
}

/// The word in `node`.
pub(super) fn word<'d>(node: Node<'d, '_>) -> &'d str {
    node.text().unwrap_or_default().trim()
}

/// The finite number at the end of `path` from `node`.
pub(super) fn number(node: Node<'_, '_>, path: &[&str]) -> Result<f64, Fault> {
    let element = required(node, path)?;
    let text = word(element);
    let value = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| {
        let name = path.join("/");
        fault(element, format!("<{name}> is `{text}`, not a number"))
    })
}

/// The attribute called `name`.
pub(super) fn attribute<'d>(node: Node<'d, '_>, name: &str) -> Result<&'d str, Fault> {
    let tag = node.tag_name().name();
    let missing = || fault(node, format!("<{tag}> without `{name}`"));
    node.attribute(name).ok_or_else(missing)
}

/// What the elements called `name` in `node` refer to.
pub(super) fn references<'d, 'i: 'd>(
    node: Node<'d, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Result<(Node<'d, 'i>, &'d str), Fault>> {
    children(node, name).map(|child| Ok((child, attribute(child, "ref")?)))
}

/// The points (m) of a bound or a stop line.
pub(super) fn points(node: Node<'_, '_>) -> Result<Vec<[f64; 2]>, Fault> {
    children(node, "point").map(point).collect()
}

/// A point (m) that single precision resolves to a millimetre.
pub(super) fn point(node: Node<'_, '_>) -> Result<[f64; 2], Fault> {
    let [x, y] = [number(node, &["x"])?, number(node, &["y"])?];
    if x.abs().max(y.abs()) > 8192.0 {
        let far = format!("({x}, {y}) m is farther than 8192 m from the origin");
        return Err(fault(node, far));
    }
    Ok([x, y])
}
