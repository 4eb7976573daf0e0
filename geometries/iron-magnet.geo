// A quarter (x > 0, y > 0) of an iron magnet whose pole faces are those of `iron_magnet` with half_distance 4 mm, convex 3.2 mm and
// concave 8 mm, of poles that end: along the beam, y, at 20 mm, and at the sides. Lengths in mm, z up, the beam at z = 4.8.
SetFactory("OpenCASCADE");
half_length = 20; far_x = 30; far_y = 40; bottom = -14; top = 16; e = 0.01;
Box(1) = {0, 0, bottom, far_x, far_y, top - bottom};

// The convex pole: a block whose head is half a cylinder. Circles through (4, 0) and (0, h) have the radius (h^2 + 16)/2h.
Box(2) = {0, 0, bottom, 4.1, half_length, -0.9 - bottom};
Cylinder(3) = {0, 0, -0.9, 0, half_length, 0, 4.1};
Box(4) = {0, 0, -5.9, 5, half_length, 10};
BooleanIntersection(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };
BooleanUnion(6) = { Volume{2}; Delete; }{ Volume{5}; Delete; };
// The concave pole: a block with a groove.
Box(7) = {0, 0, 3, 11, half_length, top - 3};
Cylinder(8) = {0, -1, 3, 0, half_length + 2, 0, 5};
BooleanDifference(9) = { Volume{7}; Delete; }{ Volume{8}; Delete; };
// A field clamp 6 mm behind the poles: a plate with a round hole for the beam.
Box(10) = {0, 26, bottom + 2, far_x, 10, top - bottom - 4};
Cylinder(11) = {0, 25, 4.8, 0, 12, 0, 2.5};
BooleanDifference(12) = { Volume{10}; Delete; }{ Volume{11}; Delete; };
pieces() = BooleanFragments{ Volume{1}; Delete; }{ Volume{6, 9, 12}; Delete; };

convex() = Volume In BoundingBox{-e, -e, bottom - e, 5 + e, half_length + e, 3.2 + e};
concave() = Volume In BoundingBox{-e, -e, 3 - e, 11 + e, half_length + e, top + e};
clamp() = Volume In BoundingBox{-e, 26 - e, bottom + 2 - e, far_x + e, 36 + e, top - 2 + e};
air() = Volume{:};
air() -= {convex(), concave(), clamp()};
Physical Volume("air", 1) = air();
Physical Volume("iron", 2) = {convex(), concave(), clamp()};
Physical Surface("below", 3) = Surface In BoundingBox{-e, -e, bottom - e, 4.1 + e, half_length + e, bottom + e};
Physical Surface("above", 4) = Surface In BoundingBox{-e, -e, top - e, 11 + e, half_length + e, top + e};

// Fine around the beam, coarse far from it; tetrahedra of second order.
Field[1] = Box;
Field[1].XMin = 0; Field[1].XMax = 2.2; Field[1].YMin = 0; Field[1].YMax = 40; Field[1].ZMin = 2.8; Field[1].ZMax = 7;
Field[1].VIn = 0.45; Field[1].VOut = 7; Field[1].Thickness = 30;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.ElementOrder = 2;
