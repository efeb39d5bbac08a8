// Dog-bone, mm: D wide at its ends, 0.6 D at its neck, 1.5 D high; arcs of the radius 0.725 D over the middle D.
// gmsh -2 -format msh41 -setnumber D 100 dog_bone.geo -o b.msh
// gmsh -2 -format msh41 -setnumber D 400 -setnumber columns 40 -setnumber straight 13 -setnumber round 66 dog_bone.geo -o d.msh
DefineConstant[ D = 100, columns = 10, straight = 3, round = 16 ];
r = 0.725*D;
x = D/2;  y = 0.75*D;  c = 0.5*D;
m = 0.3*D + r;                    // centre of an arc
Point(1) = {-x, -y, 0};  Point(2) = {x, -y, 0};  Point(3) = {x, -c, 0};  Point(4) = {x, c, 0};
Point(5) = {x, y, 0};    Point(6) = {-x, y, 0};  Point(7) = {-x, c, 0};  Point(8) = {-x, -c, 0};
Point(9) = {m, 0, 0};    Point(10) = {-m, 0, 0};
Line(1) = {1, 2};  Line(2) = {2, 3};  Circle(3) = {3, 9, 4};  Line(4) = {4, 5};
Line(5) = {5, 6};  Line(6) = {6, 7};  Circle(7) = {7, 10, 8};  Line(8) = {8, 1};
Transfinite Curve {1, 5} = columns + 1;
Transfinite Curve {2, 4, 6, 8} = straight + 1;
Transfinite Curve {3, 7} = round + 1 Using Bump 1.45;  // rows of one height: the arcs stand aslant at their ends
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Plane Surface(1) = {1};
Transfinite Surface {1} = {1, 2, 5, 6};
Recombine Surface {1};
Physical Curve("bottom") = {1};
Physical Curve("top") = {5};
Physical Surface(10) = {1};
