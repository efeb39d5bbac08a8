// A plate with four holes, in mm. gmsh -2 -order 2 -format msh41 plate.geo -o plate.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 240, 120};
Disk(2) = {60, 60, 0, 20};
Disk(3) = {120, 88, 0, 10};
Disk(4) = {120, 32, 0, 10};
Rectangle(5) = {165, 50, 0, 40, 20, 9.99}; // a slot
BooleanDifference(6) = { Surface{1}; Delete; }{ Surface{2:5}; Delete; };

MeshSize{ PointsOf{ Surface{6}; } } = 14;
holes() = Curve In BoundingBox {30, 15, -1, 215, 105, 1};
MeshSize{ PointsOf{ Curve{holes()}; } } = 6;
Mesh.MeshSizeFromCurvature = 20;

Physical Surface("plate") = {6};
Physical Curve("left") = {Curve In BoundingBox {-0.1, -1, -1, 0.1, 121, 1}};
Physical Curve("right") = {Curve In BoundingBox {239.9, -1, -1, 240.1, 121, 1}};
Physical Point("foot") = {Point In BoundingBox {-0.1, -0.1, -1, 0.1, 0.1, 1}};
