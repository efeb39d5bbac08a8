// A plate with three round holes and a slot, in mm.
//   gmsh -2 -order 2 -format msh41 plate.geo -o plate.msh     triangles of 6 nodes
//   gmsh -2 -format msh41 plate.geo -o plate_t3.msh           triangles of 3
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 240, 120};
Disk(2) = {60, 60, 0, 20};
Disk(3) = {120, 88, 0, 10};
Disk(4) = {120, 32, 0, 10};
Rectangle(5) = {175, 50, 0, 20, 20}; // a slot, with round ends
Disk(6) = {175, 60, 0, 10};
Disk(7) = {195, 60, 0, 10};
BooleanUnion(8) = { Surface{5}; Delete; }{ Surface{6:7}; Delete; };
BooleanDifference(9) = { Surface{1}; Delete; }{ Surface{2:4, 8}; Delete; };

MeshSize{ PointsOf{ Surface{9}; } } = 14;
holes() = Curve In BoundingBox {30, 15, -1, 215, 105, 1};
MeshSize{ PointsOf{ Curve{holes()}; } } = 6;
Mesh.MeshSizeFromCurvature = 20;

Physical Surface("plate") = {9};
Physical Curve("left") = {Curve In BoundingBox {-0.1, -1, -1, 0.1, 121, 1}};
Physical Curve("right") = {Curve In BoundingBox {239.9, -1, -1, 240.1, 121, 1}};
Physical Point("foot") = {Point In BoundingBox {-0.1, -0.1, -1, 0.1, 0.1, 1}};
