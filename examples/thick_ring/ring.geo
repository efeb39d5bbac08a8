// Quarter of a thick ring, mm, between the radii a and b.
// gmsh -2 -format msh41 ring.geo -o ring.msh
DefineConstant[ a = 100, b = 200, across = 20, around = 24 ];
Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0};  Point(3) = {b, 0, 0};  Point(4) = {0, b, 0};  Point(5) = {0, a, 0};
Line(1) = {2, 3};  Circle(2) = {3, 1, 4};  Line(3) = {4, 5};  Circle(4) = {5, 1, 2};
Transfinite Curve {1, 3} = across + 1;
Transfinite Curve {2, 4} = around + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Surface {1};
Recombine Surface {1};
Physical Curve("along_x") = {1};
Physical Curve("along_y") = {3};
Physical Curve("inner") = {4};
Physical Surface(10) = {1};
