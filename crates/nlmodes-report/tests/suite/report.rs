//! Contents of the files and figures of this crate, read back.

mod branches;
mod convergences;
mod histories;
mod motions;
mod pages;
pub(crate) mod samples;
mod tables;

use nlmodes_report::Figure;
use roxmltree::{Document, Node};

/// Parses a figure and checks what every one must be: well-formed, on white, in finite pixels.
fn checked(figure: &Figure) -> Document<'_> {
    let document = Document::parse(figure.as_svg()).expect("well-formed XML");
    let root = document.root_element();
    assert_eq!(root.tag_name().name(), "svg");
    let background = root.children().find(Node::is_element).unwrap();
    assert_eq!((background.tag_name().name(), background.attribute("fill")), ("rect", Some("white")));
    for attribute in root.descendants().flat_map(|node| node.attributes()) {
        let value = attribute.value();
        assert!(!value.contains("NaN") && !value.contains("inf"), "{}: {value}", attribute.name());
    }
    document
}

fn of_class<'d>(document: &'d Document<'_>, class: &str) -> Vec<Node<'d, 'd>> {
    document.descendants().filter(|node| node.attribute("class") == Some(class)).collect()
}

/// Points of a polyline or of a path of cubic pieces, without the control points between them, pixels.
fn points(node: Node<'_, '_>) -> Vec<(f64, f64)> {
    let pair = |text: &str| text.split_once(',').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).unwrap();
    if let Some(points) = node.attribute("points") {
        return points.split(' ').map(pair).collect();
    }
    let course = node.attribute("d").unwrap().trim_start_matches('M');
    course.split('C').map(|piece| pair(piece.rsplit(' ').next().unwrap())).collect()
}

fn texts(document: &Document<'_>) -> Vec<String> {
    let texts = document.descendants().filter(|node| node.tag_name().name() == "text");
    texts.filter_map(|node| node.text().map(String::from)).collect()
}
