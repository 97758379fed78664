// An angle bracket of steel, mm: the foot is on z = 0 and clamped there, the pad is the outer face of the upright's end.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 30, 20, 4};
Box(2) = {0, 0, 4, 4, 20, 36};
Coherence;
Mesh.MeshSizeMin = 10;
Mesh.MeshSizeMax = 10;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.SaveGroupsOfNodes = 1;
e = 1e-3;
Physical Volume("BRACKET") = {1, 2};
Physical Surface("FOOT") = Surface In BoundingBox {-e, -e, -e, 30 + e, 20 + e, e};
Physical Surface("PAD") = Surface In BoundingBox {4 - e, -e, 4 - e, 4 + e, 20 + e, 40 + e};
Physical Curve("EDGE") = Curve In BoundingBox {4 - e, -e, 40 - e, 4 + e, 20 + e, 40 + e};
