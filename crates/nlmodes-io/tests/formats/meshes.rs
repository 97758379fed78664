//! Small meshes with known properties.

use std::fs;
use std::path::PathBuf;

use nlmodes_io::{ElementKind, Mesh, Skin};

fn mesh(name: &str, text: &str) -> nlmodes_io::Result<Mesh> {
    let directory = tempfile::tempdir().unwrap();
    let path: PathBuf = directory.path().join(name);
    fs::write(&path, text).unwrap();
    Mesh::read(&path)
}

const TWO_BRICKS: &str = "** two unit cubes side by side
*Heading
 anything, *NODE
*Node, nset=all
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, 0,0,1
6, 1,0,1
7, 1,1,1
8, 0,1,1
9, 2,0,0
10, 2,1,0
11, 2,0,1.0E0
12, 2,1,1
*Element, type=C3D8I,
 elset=left
1, 1,2,3,4,
5,6,7,8
*ELEMENT, TYPE=C3D8R, ELSET=Right
2, 2,9,10,3,6,11,12,7
*ELEMENT, TYPE=SPRINGA, ELSET=K
3, 1, 2
*Elset, elset=BOTH
LEFT, right
*Nset, nset=EVEN, generate
2, 12, 2
*Nset, nset=some
1, EVEN
*Nset, nset=ofright, elset=right
*Surface, name=END
right, S4
*SURFACE, NAME=POINTS, TYPE=NODE
1
EVEN
*BOUNDARY
1, 1, 3
";

#[test]
fn decks_give_nodes_elements_and_sets() {
    let mesh = mesh("x.inp", TWO_BRICKS).unwrap();
    assert_eq!((mesh.numbers.len(), mesh.elements.len()), (12, 2));
    assert_eq!(mesh.place_of(11), Some([2.0, 0.0, 1.0]));
    let set = |name: &str| mesh.node_set(name).unwrap().to_vec();
    assert_eq!(set("EVEN"), [2, 4, 6, 8, 10, 12]);
    assert_eq!(set("some"), [1, 2, 4, 6, 8, 10, 12]);
    assert_eq!(set("ofright"), [2, 3, 6, 7, 9, 10, 11, 12]);
    assert_eq!(set("ALL").len(), 12);
    assert_eq!(set("END"), [9, 10, 11, 12], "S4 of the right brick is its face x = 2");
    assert_eq!(set("POINTS"), [1, 2, 4, 6, 8, 10, 12]);
    assert_eq!(mesh.passed_over.get("SPRINGA"), Some(&1));
}

#[test]
fn the_face_between_two_bricks_is_no_skin() {
    let mesh = mesh("x.inp", TWO_BRICKS).unwrap();
    let skin = Skin::of(&mesh);
    assert_eq!(skin.cells.len(), 10);
    assert_eq!(skin.nodes().len(), 12);
    assert_eq!(skin.edges().len(), 20);
    // The four edges between the two bricks lie in flat faces.
    assert_eq!(skin.sharp_edges(&mesh, 0.5).len(), 16);
    assert_eq!(skin.sharp_edges(&mesh, 2.0).len(), 0);
    let normals = skin.normals(&mesh);
    let at = |number: u64| normals[mesh.index_of(number).unwrap()];
    // Each corner node has a quarter of each adjacent unit face.
    assert_eq!(at(12), [0.25, 0.25, 0.25]);
    assert_eq!(at(1), [-0.25, -0.25, -0.25]);
    assert_eq!(at(7), [0.0, 0.5, 0.5]);
    let area: f64 = normals.iter().map(|n| n[0].abs() + n[1].abs() + n[2].abs()).sum();
    assert!((area - 10.0).abs() < 1e-14, "{area}");
}

/// Mirrored parts have elements that are numbered the other way round; outward is outward all the same.
#[test]
fn normals_of_a_mirrored_mesh_are_the_mirrored_normals() {
    let mesh = mesh("x.inp", TWO_BRICKS).unwrap();
    let normals = Skin::of(&mesh).normals(&mesh);
    for axis in 0..3 {
        let mut mirrored = mesh.clone();
        mirrored.places.iter_mut().for_each(|place| place[axis] = -place[axis]);
        let mut expected = normals.clone();
        expected.iter_mut().for_each(|normal| normal[axis] = -normal[axis]);
        assert_eq!(Skin::of(&mirrored).normals(&mirrored), expected);
    }
}

#[test]
fn normals_of_a_set_do_not_tilt_at_its_edges() {
    let mesh = mesh("x.inp", TWO_BRICKS).unwrap();
    let skin = Skin::of(&mesh);
    let within = |numbers: &[u64]| -> Vec<[f64; 3]> {
        let nodes: Vec<u32> = numbers.iter().map(|n| mesh.index_of(*n).unwrap() as u32).collect();
        let normals = skin.normals_within(&mesh, &nodes);
        nodes.iter().map(|node| normals[*node as usize]).collect()
    };
    assert_eq!(within(mesh.node_set("END").unwrap()), [[0.25, 0.0, 0.0]; 4]);
    // Nodes that hold no face have those around them.
    assert_eq!(within(&[12]), [[0.25, 0.25, 0.25]]);
    // On two faces that meet, the common edge lies between both.
    let all: Vec<u64> = (1..=12).collect();
    assert_eq!(within(&all), all.iter().map(|n| skin.normals(&mesh)[mesh.index_of(*n).unwrap()]).collect::<Vec<_>>());
}

#[test]
fn the_area_of_a_face_is_that_of_its_nodes_together_as_seen_along_their_direction() {
    let mesh = mesh("x.inp", TWO_BRICKS).unwrap();
    let skin = Skin::of(&mesh);
    let areas = |numbers: &[u64], direction: [f64; 3]| {
        let nodes: Vec<_> = numbers.iter().map(|n| (mesh.index_of(*n).unwrap() as u32, direction)).collect();
        skin.tributary_areas(&mesh, &nodes)
    };
    let end = mesh.node_set("END").unwrap();
    assert_eq!(areas(end, [1.0, 0.0, 0.0]), [0.25; 4]);
    // An oblique wall has a smaller projected area, one behind it none; an edge is not a face.
    assert_eq!(areas(end, [0.6, 0.8, 0.0]), [0.6 * 0.25; 4]);
    assert_eq!(areas(end, [-1.0, 0.0, 0.0]), [0.0; 4]);
    assert_eq!(areas(&end[..2], [1.0, 0.0, 0.0]), [0.0; 2]);
    // All around the box: along x its two ends, along z top and bottom, each with two unit squares.
    let all: Vec<u64> = (1..=12).collect();
    let sum = |direction| areas(&all, direction).iter().sum::<f64>();
    assert_eq!([sum([1.0, 0.0, 0.0]), sum([0.0, 0.0, 1.0])], [1.0, 2.0]);
}

/// A tetrahedron with ten nodes and a brick with twenty, each over a face in the plane z = 0, of area 1/2 and 1,
/// oriented downward.
#[test]
fn nodes_in_the_middle_of_edges_have_the_pieces_around_them() {
    let triangle = "1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 0.5, 0, 0\n6, 0.5, 0.5, 0\n7, 0, 0.5, 0\n\
                    8, 0, 0, 0.5\n9, 0.5, 0, 0.5\n10, 0, 0.5, 0.5\n*ELEMENT, TYPE=C3D10, ELSET=E\n1, 1, 2, 3, 4, 5, 6, \
                    7, 8, 9, 10\n";
    let corners = ["0, 0, 0", "1, 0, 0", "1, 1, 0", "0, 1, 0", "0, 0, 1", "1, 0, 1", "1, 1, 1", "0, 1, 1"];
    let middles = [
        "0.5, 0, 0",
        "1, 0.5, 0",
        "0.5, 1, 0",
        "0, 0.5, 0",
        "0.5, 0, 1",
        "1, 0.5, 1",
        "0.5, 1, 1",
        "0, 0.5, 1",
        "0, 0, 0.5",
        "1, 0, 0.5",
        "1, 1, 0.5",
        "0, 1, 0.5",
    ];
    let places = corners.iter().chain(&middles).enumerate();
    let square = places.map(|(k, place)| format!("{}, {place}\n", k + 1)).collect::<String>()
        + "*ELEMENT, TYPE=C3D20, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,\n16, 17, 18, 19, 20\n";
    let cases = [
        (triangle.to_owned(), vec![1, 2, 3], vec![5, 6, 7], [0.5 / 12.0, 0.5 / 4.0]),
        (square, vec![1, 2, 3, 4], vec![9, 10, 11, 12], [1.0 / 24.0, 5.0 / 24.0]),
    ];
    for (text, corners, middles, [corner, middle]) in cases {
        let mesh = mesh("x.inp", &format!("*NODE\n{text}")).unwrap();
        let index = |number: &u64| (mesh.index_of(*number).unwrap() as u32, [0.0, 0.0, -1.0]);
        let nodes: Vec<_> = corners.iter().chain(&middles).map(index).collect();
        let areas = Skin::of(&mesh).tributary_areas(&mesh, &nodes);
        let (at_corners, at_middles) = areas.split_at(corners.len());
        assert!(at_corners.iter().all(|area| (area - corner).abs() < 1e-15), "{areas:?}");
        assert!(at_middles.iter().all(|area| (area - middle).abs() < 1e-15), "{areas:?}");
        // Corners alone: their pieces stay theirs.
        let alone = Skin::of(&mesh).tributary_areas(&mesh, &nodes[..corners.len()]);
        assert_eq!(alone, at_corners);
    }
}

#[test]
fn coordinates_that_are_left_out_are_zero() {
    let text = "*NODE\n1\n2, 1.5\n3, , 2\n4, 1, 2,\n5, 1, 2, , 3.0\n6, 1, , 3, 0, 0, 1\n*ELEMENT, TYPE=S3, ELSET=E\n1, \
        1, 2, 3\n";
    let mesh = mesh("x.inp", text).unwrap();
    let expected = [[0.0; 3], [1.5, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 2.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 3.0]];
    assert_eq!(mesh.places, expected);
}

/// CalculiX keeps three inner nodes with each such element, and passes over numbers that it does not need.
#[test]
fn bricks_with_incompatible_modes_may_have_eleven_numbers() {
    for kind in ["C3D8I", "C3D8"] {
        let text = TWO_BRICKS.replace(
            "*ELEMENT, TYPE=C3D8R, ELSET=Right\n2, 2,9,10,3,6,11,12,7\n",
            &format!("*ELEMENT, TYPE={kind}, ELSET=Right\n2, 2,9,10,3,6,11,12,7,101,102,103\n"),
        );
        match mesh("x.inp", &text) {
            Ok(found) => assert_eq!((kind, &found.elements), ("C3D8I", &mesh("x.inp", TWO_BRICKS).unwrap().elements)),
            Err(refused) => {
                assert!(kind == "C3D8" && refused.to_string().contains("8 nodes of element 2"), "{refused}")
            }
        }
    }
}

/// `*TRANSFORM` turns what a deck holds, not the matrices of CalculiX.
#[test]
fn supports_along_other_axes_are_known_where_they_hold_all() {
    let lines = "*TRANSFORM, NSET=END\n0.8,0.6,0.,-0.6,0.8,0.\n*BOUNDARY\n9, 1, 3\n10, 1\n1, 1\n";
    let mesh = mesh("x.inp", &format!("{TWO_BRICKS}{lines}")).unwrap();
    let supports: Vec<_> = mesh.supports.unwrap().into_iter().collect();
    assert_eq!(supports, [(1, [true; 3]), (9, [true; 3])]);
}

#[test]
fn decks_say_what_they_hold() {
    let lines = "*BOUNDARY\n1, 1, 3\nEND, 2\n 12, 1\n3, ENCASTRE\n4, ZSYMM\n*STEP\n*BOUNDARY, OP=MOD\n5, 3, 3, \
        0.0\nnobody, 1\n6, 4, 6\n*END STEP\n";
    let mesh = mesh("x.inp", &format!("{TWO_BRICKS}{lines}")).unwrap();
    let supports = mesh.supports.unwrap();
    let expected = [
        (1, [true; 3]),
        (3, [true; 3]),
        (4, [false, false, true]),
        (5, [false, false, true]),
        (6, [false; 3]),
        (9, [false, true, false]),
        (10, [false, true, false]),
        (11, [false, true, false]),
        (12, [true, true, false]),
    ];
    assert_eq!(supports.into_iter().collect::<Vec<_>>(), expected);
}

#[test]
fn included_decks_are_read_where_they_stand() {
    let directory = tempfile::tempdir().unwrap();
    fs::create_dir(directory.path().join("parts")).unwrap();
    let (head, tail) = TWO_BRICKS.split_at(TWO_BRICKS.find("*Element").unwrap());
    fs::write(directory.path().join("parts/nodes.inp"), head).unwrap();
    let path = directory.path().join("x.inp");
    fs::write(&path, format!("*INCLUDE, INPUT=parts/nodes.inp\n{tail}")).unwrap();
    let split = Mesh::read(&path).unwrap();
    assert_eq!(split, mesh("x.inp", TWO_BRICKS).unwrap());
    // With a comma the keyword continues on the next line, which does not exist.
    for line in ["*INCLUDE, INPUT=x.inp\n", "*INCLUDE, INPUT=x.inp,\n"] {
        fs::write(&path, line).unwrap();
        let circle = Mesh::read(&path).unwrap_err().to_string();
        assert!(circle.contains("number of decks that include each other: found 17, expected at most 16"), "{circle}");
    }
    // Fifteen decks each of which includes the next one twice.
    for k in 0..15 {
        let twice = format!("*INCLUDE, INPUT={0}.inp\n*INCLUDE, INPUT={0}.inp\n", k + 1);
        fs::write(directory.path().join(format!("{k}.inp")), twice).unwrap();
    }
    fs::write(directory.path().join("15.inp"), "*NODE\n1, 0, 0, 0\n").unwrap();
    let many = Mesh::read(&directory.path().join("0.inp")).unwrap_err().to_string();
    assert!(many.contains("number of decks that are included: found 10001, expected at most 10000"), "{many}");
}

/// A set that names itself twice a line doubles with each, and a range may have any length.
#[test]
fn sets_that_name_more_than_fits_into_memory_are_refused_at_their_line() {
    let doubling = format!("{TWO_BRICKS}*NSET, NSET=SOME\n{}", "SOME, SOME\n".repeat(60));
    let first = doubling.lines().position(|line| line == "SOME, SOME").unwrap() + 1;
    let refused = mesh("x.inp", &doubling).unwrap_err().to_string();
    // Seven numbers are three times as many after each line: the fourteenth names 2 · 7 · 3^13 = 2.2e7.
    assert!(refused.contains("sets that name at most 50000000 numbers in all"), "{refused}");
    assert!((first..first + 20).any(|line| refused.contains(&format!(":{line}"))), "{refused}");
    for range in ["1, 999999999999999", "0, 999999999999999, 7", "1, 60000000"] {
        for keyword in ["*NSET, NSET=LONG, GENERATE", "*ELSET, ELSET=LONG, GENERATE"] {
            let refused = mesh("x.inp", &format!("{TWO_BRICKS}{keyword}\n{range}\n")).unwrap_err().to_string();
            assert!(refused.contains("at most 50000000"), "{range}: {refused}");
        }
    }
    let falling = mesh("x.inp", &format!("{TWO_BRICKS}*NSET, NSET=LONG, GENERATE\n9, 2\n")).unwrap_err().to_string();
    assert!(falling.contains("a range that ascends"), "{falling}");
    // Several long ranges whose numbers no node has are no mistake.
    let sparse =
        format!("{TWO_BRICKS}*NSET, NSET=LONG, GENERATE\n1, 9000000\n1, 9000000, 3\n*NSET, NSET=AGAIN\nLONG\n");
    let mesh = mesh("x.inp", &sparse).unwrap();
    assert_eq!(mesh.node_set("AGAIN").map(<[u64]>::len), mesh.node_set("LONG").map(<[u64]>::len));
}

#[test]
fn both_versions_of_gmsh_give_the_same_mesh() {
    let four = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"PAD face\"\n3 \
        1 \"BODY\"\n$EndPhysicalNames\n$Entities\n0 0 1 1\n\
                1 0 0 0 1 1 0 1 7 0\n1 0 0 0 1 1 1 1 1 1 1\n$EndEntities\n$Nodes\n2 4 1 9\n2 1 0 3\n1\n2\n3\n0 0 0\n1 \
                0 0\n0 1 0\n\
                3 1 0 1\n9\n0 0 1\n$EndNodes\n$Elements\n2 2 1 2\n2 1 2 1\n1 1 3 2\n3 1 4 1\n2 1 2 3 \
                9\n$EndElements\n$Comments\nx\n$EndComments\n";
    let two = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"PAD face\"\n3 \
        1 \"BODY\"\n$EndPhysicalNames\n$Nodes\n4\n1 0 0 0\n\
               2 1 0 0\n3 0 1 0\n9 0 0 1\n$EndNodes\n$Elements\n2\n1 2 2 7 1 1 3 2\n2 4 2 1 1 1 2 3 9\n$EndElements\n";
    let (four, two) = (mesh("x.msh", four).unwrap(), mesh("x.msh", two).unwrap());
    assert_eq!(four, two);
    assert_eq!(four.node_set("PAD face"), Some(&[1, 2, 3][..]));
    assert_eq!(four.node_set("BODY"), Some(&[1, 2, 3, 9][..]));
    // The triangle on the face of the tetrahedron shows what the tetrahedron shows.
    let skin = Skin::of(&four);
    assert_eq!(skin.cells.len(), 4);
    assert!(skin.cells.iter().all(|cell| cell.kind == ElementKind::Triangle));
}

/// Materials are those of the sets of solid sections; none of an element without a section, of one whose material
/// depends on the temperature, is not isotropic, or is not there.
#[test]
fn decks_give_the_type_and_the_material_of_each_element() {
    let nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n";
    let element = |k: usize| format!("*ELEMENT, TYPE=C3D4, ELSET=E{k}\n{k},1,2,3,4\n");
    let elements: Vec<String> = (1..=6).map(element).collect();
    let materials = "*MATERIAL, NAME=Steel\n*ELASTIC\n210000., .3\n*DENSITY\n7.8e-9\n\
        *MATERIAL, NAME=HOT\n*ELASTIC\n210000., .3, 20.\n180000., .3, 300.\n\
        *MATERIAL, NAME=WOOD\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1.,2.,3.,.1,.1,.1,1.,1.,\n1.,\n\
        *MATERIAL, NAME=RUBBER\n*ELASTIC, TYPE=ISO\n1.5, .5\n";
    let section = |k: usize, name: &str| format!("*SOLID SECTION, ELSET=E{k}, MATERIAL={name}\n");
    let sections =
        [section(1, "STEEL"), section(2, "HOT"), section(3, "WOOD"), section(4, "RUBBER"), section(5, "NONE")];
    let found = mesh("m.inp", &(nodes.to_owned() + &elements.concat() + materials + &sections.concat())).unwrap();
    assert_eq!(found.elasticity(0), Some(("C3D4", [210000.0, 0.3])));
    assert!((1..7).all(|k| found.elasticity(k).is_none()));
}
