// A plate of steel, mm: the edge on x = 0 is clamped, a stop stands above the corner at (80, 50, 2).
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 80, 50, 2};
Mesh.MeshSizeMin = 14;
Mesh.MeshSizeMax = 14;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.SaveGroupsOfNodes = 1;
e = 1e-3;
Physical Volume("PLATE") = {1};
Physical Surface("FOOT") = Surface In BoundingBox {-e, -e, -e, e, 50 + e, 2 + e};
Physical Point("CORNER") = Point In BoundingBox {80 - e, 50 - e, 2 - e, 80 + e, 50 + e, 2 + e};
