// A bladed ring of steel, mm: the bore of radius 10 is clamped, the tips of its three blades, at radius 50, are inside a casing.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, -3, 0, 0, 6, 16};
Cylinder(2) = {0, 0, -3, 0, 0, 6, 10};
Box(3) = {12, -4, -1.5, 42, 8, 3};
Box(4) = {12, -4, -1.5, 42, 8, 3};
Box(5) = {12, -4, -1.5, 42, 8, 3};
Rotate {{0, 0, 1}, {0, 0, 0}, 2 * Pi / 3} { Volume{4}; }
Rotate {{0, 0, 1}, {0, 0, 0}, 4 * Pi / 3} { Volume{5}; }
Cylinder(6) = {0, 0, -3, 0, 0, 6, 50};
BooleanUnion(7) = { Volume{1}; Delete; }{ Volume{3}; Volume{4}; Volume{5}; Delete; };
BooleanDifference(8) = { Volume{7}; Delete; }{ Volume{2}; Delete; };
BooleanIntersection(9) = { Volume{8}; Delete; }{ Volume{6}; Delete; };
Mesh.MeshSizeMin = 11;
Mesh.MeshSizeMax = 11;
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 1;
Mesh.SaveGroupsOfNodes = 1;
e = 1e-2;
Physical Volume("ROTOR") = {9};
Physical Surface("FOOT") = Surface In BoundingBox {-10 - e, -10 - e, -3 - e, 10 + e, 10 + e, 3 + e};
tips[] = Surface In BoundingBox {49, -5, -2, 51, 5, 2};
For k In {1:2}
  c = Cos(2 * k * Pi / 3);
  s = Sin(2 * k * Pi / 3);
  tips[] += Surface In BoundingBox {50 * c - 5, 50 * s - 5, -2, 50 * c + 5, 50 * s + 5, 2};
EndFor
Physical Surface("TIPS") = {tips[]};
