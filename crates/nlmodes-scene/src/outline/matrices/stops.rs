//! Which stop is at which node, for many of them.

use nlmodes_io::NodeContact;

/// Characters of a line, without its last range.
const WIDTH: usize = 90;

/// All stops in ranges, some to a line: `stops 0–11: nodes 33–44 before 133–144; 12: node 7`.
pub fn lines(contacts: &[NodeContact]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut first = 0;
    while first < contacts.len() {
        let count = run(&contacts[first..]);
        let range = range(first, count, &contacts[first]);
        match lines.last_mut().filter(|line| line.chars().count() < WIDTH) {
            Some(line) => line.push_str(&format!("; {range}")),
            None => lines.push(range),
        }
        first += count;
    }
    lines
}

/// How many of these stops follow each other with nodes, and what they touch, one by one.
fn run(contacts: &[NodeContact]) -> usize {
    let follows = |[a, b]: &[NodeContact; 2]| {
        let partner = match (a.against, b.against) {
            (Some(a), Some(b)) => a + 1 == b,
            (a, b) => a == b,
        };
        a.node + 1 == b.node && partner && a.origin == b.origin
    };
    1 + contacts.array_windows().take_while(|pair| follows(pair)).count()
}

fn range(first: usize, count: usize, contact: &NodeContact) -> String {
    let last = count - 1;
    let span = |from: u64| if last == 0 { from.to_string() } else { format!("{from}–{}", from + last as u64) };
    let before = contact.against.map_or_else(String::new, |other| format!(" before {}", span(other)));
    let (stops, nodes) = if last == 0 { ("stop", "node") } else { ("stops", "nodes") };
    format!("{stops} {}: {nodes} {}{before}", span(first as u64), span(contact.node))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(node: u64, against: Option<u64>, origin: usize) -> NodeContact {
        NodeContact { node, against, normal: [1.0, 0.0, 0.0], gap: 0.0, stiffness: None, damping: None, origin }
    }

    #[test]
    fn each_stop_is_in_one_range() {
        let walls = (7..10).map(|node| stop(node, None, 0));
        let pairs = [(20, 50), (21, 51), (22, 53)].map(|(a, b)| stop(a, Some(b), 1));
        // The next node, but of another table.
        let all: Vec<NodeContact> = walls.chain([stop(10, None, 2)]).chain(pairs).collect();
        let expected =
            "stops 0–2: nodes 7–9; stop 3: node 10; stops 4–5: nodes 20–21 before 50–51; stop 6: node 22 before 53";
        assert_eq!(lines(&all), [expected]);
    }

    #[test]
    fn many_ranges_are_several_lines() {
        let all: Vec<NodeContact> = (0..40).map(|k| stop(3 * k, None, 0)).collect();
        let lines = lines(&all);
        assert!(lines.len() > 3 && lines.iter().all(|line| line.chars().count() < WIDTH + 30), "{lines:?}");
        assert_eq!(lines.join("; ").matches("stop ").count(), 40);
    }
}
