// A quarter of a plate with a hole of radius 1 m.
//   gmsh -2 -order 2 -format msh41 hole.geo -o hole.msh     triangles of 6 nodes
//   gmsh -2 -format msh41 hole.geo -o hole_t3.msh           triangles of 3
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0, 0.08};
Point(3) = {5, 0, 0, 0.9};
Point(4) = {5, 5, 0, 0.9};
Point(5) = {0, 5, 0, 0.9};
Point(6) = {0, 1, 0, 0.08};
Line(1) = {2, 3};
Line(2) = {3, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Circle(5) = {6, 1, 2};
Curve Loop(1) = {1:5};
Plane Surface(1) = {1};

Physical Surface("plate") = {1};
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Curve("hole") = {5};
