// Two cantilevers of steel that overlap at their tips, mm: the lower one is clamped on x = 0, the upper one, longer by a fifth, on x = 105.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 50, 6, 3};
Box(2) = {45, 0, 3.2, 60, 6, 3};
Transfinite Curve{:} = 2;
e = 1e-3;
For c In {1:24}
  box[] = BoundingBox Curve{c};
  If (box[3] - box[0] > 55)
    Transfinite Curve{c} = 13;
  ElseIf (box[3] - box[0] > 40)
    Transfinite Curve{c} = 11;
  EndIf
EndFor
Transfinite Surface{:};
Transfinite Volume{:};
Recombine Surface{:};
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1;
Mesh.SaveGroupsOfNodes = 1;
Physical Volume("BEAMS") = {1, 2};
lower[] = Surface In BoundingBox {-e, -e, -e, e, 6 + e, 3 + e};
upper[] = Surface In BoundingBox {105 - e, -e, 3.2 - e, 105 + e, 6 + e, 6.2 + e};
Physical Surface("FOOT") = {lower[], upper[]};
Physical Curve("TIP") = Curve In BoundingBox {50 - e, -e, 3 - e, 50 + e, 6 + e, 3 + e};
Physical Surface("UNDERSIDE") = Surface In BoundingBox {45 - e, -e, 3.2 - e, 105 + e, 6 + e, 3.2 + e};
