//! Labels and meshes as text.

use std::fs;

use nlmodes_io::{LabelTable, Mesh};

use super::{cut, damage, head, line, refused};
use crate::writers;

#[test]
fn tables_of_labels() {
    let good = writers::dof();
    let dof = vec![
        damage("no point", line(&good, 2, "10"), ":2: found `10`; expected `node.direction`"),
        damage("a fraction", line(&good, 2, "10.25"), ":2: found `10.25`"),
        damage("direction 0", line(&good, 2, "10.0"), ":2: found `10.0`"),
        damage("direction 7", line(&good, 2, "10.7"), ":2: found `10.7`"),
        damage("two points", line(&good, 2, "10.2.3"), ":2: found `10.2.3`"),
        damage("an exponent", line(&good, 2, "1e1.2"), ":2: found `1e1.2`"),
        damage("a sign", line(&good, 2, "-10.2"), ":2: found `-10.2`"),
        damage("an empty line", line(&good, 2, " "), ":2: found nothing"),
        damage("cut", cut(&good, 1), ":24: the file ends here"),
        damage("two labels", line(&good, 2, "10.2 10.3"), ":2: found `10.2 10.3`"),
    ];
    refused("x.dof", dof, LabelTable::read);
    let good = writers::mapping();
    let mapping = vec![
        damage("an equation left out", line(&good, 4, ""), ":4: found `4`; expected equation 3"),
        damage("a temperature", line(&good, 4, "3 10 TEMP"), ":4: found `TEMP`; expected a direction UX"),
        damage("a number as direction", line(&good, 4, "3 10 3"), ":4: found `3`; expected a direction UX"),
        damage("no direction", line(&good, 4, "3 10"), ":4: found nothing"),
        damage("no node", line(&good, 4, "3 x UZ"), ":4: found `x`; expected a whole number, the number of the node"),
        damage("a label twice", line(&good, 4, "3 10 UX"), ":4: found ux of node 10 a second time, after line 2"),
        damage("a fourth field", line(&good, 4, "3 10 UZ 1"), ":4: found `1`; expected the end of the line"),
        damage("a heading alone", head(&good, 1), ":2: the file ends here; expected equation 1"),
        damage("cut", cut(&good, 2), ":25: the file ends here"),
        damage("text within", line(&good, 4, "* 10 UZ"), ":4: found `*`; expected equation 3"),
        damage("a fraction", line(&good, 4, "3.0 10 UZ"), ":4: found `3.0`; expected equation 3"),
    ];
    refused("x.mapping", mapping, LabelTable::read);
    let good = writers::table();
    let table = vec![
        damage(
            "another heading",
            line(&good, 1, "row,node,dof,x,y,z"),
            ":1: found `dof`; expected the column `component`",
        ),
        damage("four columns", line(&good, 1, "row,node,component,x"), ":1: found"),
        damage("a column less", line(&good, 3, "22,80,2,1,2"), ":3: found `22,80,2,1,2`; expected 6 columns"),
        damage("no component", line(&good, 3, "22,80,up,20.0,0.5,-2"), ":3: found `up`; expected a component 1 to 6"),
        damage("component 7", line(&good, 3, "22,80,7,20.0,0.5,-2"), ":3: found `7`; expected a component 1 to 6"),
        damage(
            "a negative row",
            line(&good, 3, "-22,80,2,20.0,0.5,-2"),
            ":3: found `-22`; expected a whole number, the row",
        ),
        damage(
            "a row twice",
            line(&good, 3, "21,80,2,20.0,0.5,-2"),
            ": found row 21; expected each row from 0 to 23 once, so row 22 next",
        ),
        damage(
            "a label twice",
            line(&good, 3, "22,80,3,20.0,0.5,-2"),
            ":3: found uz of node 80 a second time, after line 2",
        ),
        damage(
            "a node at two places",
            line(&good, 3, "22,80,2,20.5,0.5,-2"),
            ":3: found `22,80,2,20.5,0.5,-2`; expected node 80 at the place",
        ),
        damage("a coordinate", line(&good, 3, "22,80,2,20.0,?,-2"), ":3: found `?`; expected a number, the coordinate"),
        damage("a heading alone", head(&good, 1), ":2: the file ends here; expected a line row,node,component"),
        damage("semicolons", good.replace(',', ";"), ":1: found"),
    ];
    refused("x.csv", table, LabelTable::read);
}

#[test]
fn decks() {
    let good = "*NODE, NSET=ALL\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1, \
        2, 3, 4\n*NSET, NSET=TIP\n3, 4\n*SURFACE, NAME=S\nE, S1\n";
    assert!(
        Mesh::read(&{
            let path = tempfile::tempdir().unwrap().keep().join("good.inp");
            fs::write(&path, good).unwrap();
            path
        })
        .is_ok()
    );
    let cases = vec![
        damage(
            "seven coordinates",
            line(good, 3, "2, 1, 0, 0, 0, 0, 1, 5"),
            ":3: found `2, 1, 0, 0, 0, 0, 1, 5`; expected a node: number, x, y, z",
        ),
        damage("a letter", line(good, 3, "2, 1, o, 0"), ":3: found `o`; expected a number, the coordinate"),
        damage(
            "a node moved",
            line(good, 3, "1, 1, 0, 0"),
            ":3: found `1, 1, 0, 0`; expected node 1 at [0.0, 0.0, 0.0]",
        ),
        damage("not finite", line(good, 3, "2, nan, 0, 0"), ":3: the coordinate `nan` is not a finite number"),
        damage(
            "no type",
            line(good, 6, "*ELEMENT, ELSET=E"),
            ":6: found `*ELEMENT, ELSET=E`; expected TYPE=… with *ELEMENT",
        ),
        damage(
            "a node too few",
            line(good, 7, "1, 1, 2, 3"),
            ":8: found 3 before this line; expected 4 nodes of element 1",
        ),
        damage(
            "a node too many",
            line(good, 7, "1, 1, 2, 3, 4, 5"),
            ":7: found `1, 1, 2, 3, 4, 5`; expected 4 nodes of element 1",
        ),
        damage(
            "a node that is not there",
            line(good, 7, "1, 1, 2, 3, 9"),
            ":7: found node 9, which is not there; expected nodes of the deck",
        ),
        damage("a set's node that is not there", line(good, 9, "3, 44"), ":9: found node 44, which is not there"),
        damage(
            "a set that is not there",
            line(good, 9, "EDGE"),
            ":9: there is no set `EDGE`; expected one of `ALL`, `TIP`",
        ),
        damage("a face that is not there", line(good, 11, "E, S5"), ":11: found `E, S5`; expected a face"),
        damage("a part", line(good, 1, "*PART, NAME=P"), ":1: found *PART; expected a flat deck in global axes"),
        damage("generated nodes", line(good, 1, "*NGEN"), ":1: found *NGEN; expected a flat deck"),
        damage(
            "turned axes",
            line(good, 1, "*NODE, SYSTEM=C"),
            ":1: found `*NODE, SYSTEM=C`; expected coordinates along global axes",
        ),
        damage(
            "an element twice",
            line(good, 8, "1, 1, 2, 3, 4"),
            ":8: found `1, 1, 2, 3, 4`; expected element 1 once",
        ),
        damage("a deck that is not there", line(good, 1, "*INCLUDE, INPUT=none.inp"), ":1: found"),
        damage("no nodes", "*HEADING\nx\n".into(), "the file ends here; expected nodes (*NODE)"),
    ];
    refused("x.inp", cases, Mesh::read);
}

#[test]
fn gmsh() {
    let good = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 \
        1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
    let cases = vec![
        damage("another beginning", line(good, 1, "$Format"), ":1: found `$Format`; expected $MeshFormat"),
        damage("another version", line(good, 2, "3 0 8"), ":2: found `3`; expected version 4.1 or 2.2"),
        damage("binary", line(good, 2, "4.1 1 8"), ":2: found a binary file; expected a file of text"),
        damage("a node too many", line(good, 6, "3 1 0 5"), ":11: found"),
        damage("a node too few", line(good, 6, "3 1 0 3"), ":10: found"),
        damage("two coordinates", line(good, 12, "1 0"), ":12: found `1 0`; expected three coordinates"),
        damage("a letter", line(good, 12, "1 o 0"), ":12: found `o`; expected a number, the coordinate"),
        damage("a node twice", line(good, 8, "1"), ":12: found `1 0 0`; expected node 1 once"),
        damage(
            "a type beyond",
            line(good, 18, "3 1 29 1"),
            ":18: found `29`; expected an element type of first or second order",
        ),
        damage(
            "a node of an element missing",
            line(good, 19, "1 1 2 3"),
            ":19: found `1 1 2 3`; expected 4 nodes of the element",
        ),
        damage("a node that is not there", line(good, 19, "1 1 2 3 7"), ":19: found node 7, which is not there"),
        damage("another end", line(good, 15, "$EndElements"), ":15: found `$EndElements`; expected $EndNodes"),
        damage("cut", head(good, 13), ":14: the file ends here"),
        damage("no nodes", head(good, 3), ":4: the file ends here; expected the section $Nodes"),
    ];
    refused("x.msh", cases, Mesh::read);
}
