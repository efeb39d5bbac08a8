// Disc, 150 mm in diameter, flat over a sixth of that above and below, where the platens press.
// gmsh -2 -format msh41 disc.geo -o disc.msh
// gmsh -2 -format msh41 -setnumber flat 2 -setnumber round 4 -setnumber deep 5 disc.geo -o disc_coarse.msh
DefineConstant[ flat = 4, round = 7, deep = 8 ];
R = 75;  w = 12.5;  h = Sqrt(R*R - w*w);
a = R*Sqrt(0.5);  b = 0.52*R*Sqrt(0.5);   // corners of the outer and of the inner blocks
side = flat + 2*round;
Point(1) = {0, 0, 0};
Point(11) = {-b, -b, 0};  Point(12) = {b, -b, 0};  Point(13) = {b, b, 0};  Point(14) = {-b, b, 0};
Point(21) = {-a, -a, 0};  Point(22) = {a, -a, 0};  Point(23) = {a, a, 0};  Point(24) = {-a, a, 0};
Point(31) = {-w, -h, 0};  Point(32) = {w, -h, 0};  Point(33) = {w, h, 0};  Point(34) = {-w, h, 0};
Line(11) = {11, 12};  Line(12) = {12, 13};  Line(13) = {13, 14};  Line(14) = {14, 11};
Line(21) = {11, 21};  Line(22) = {12, 22};  Line(23) = {13, 23};  Line(24) = {14, 24};
Circle(31) = {21, 1, 31};  Line(32) = {31, 32};  Circle(33) = {32, 1, 22};
Circle(34) = {22, 1, 23};
Circle(35) = {23, 1, 33};  Line(36) = {33, 34};  Circle(37) = {34, 1, 24};
Circle(38) = {24, 1, 21};
Transfinite Curve {11, 12, 13, 14, 34, 38} = side + 1;
Transfinite Curve {21, 22, 23, 24} = deep + 1;
Transfinite Curve {31, 33, 35, 37} = round + 1;
Transfinite Curve {32, 36} = flat + 1;
Curve Loop(1) = {11, 12, 13, 14};                Plane Surface(1) = {1};
Curve Loop(2) = {21, 31, 32, 33, -22, -11};      Plane Surface(2) = {2};
Curve Loop(3) = {22, 34, -23, -12};              Plane Surface(3) = {3};
Curve Loop(4) = {23, 35, 36, 37, -24, -13};      Plane Surface(4) = {4};
Curve Loop(5) = {24, 38, -21, -14};              Plane Surface(5) = {5};
Transfinite Surface {1} = {11, 12, 13, 14};
Transfinite Surface {2} = {11, 21, 22, 12};
Transfinite Surface {3} = {12, 22, 23, 13};
Transfinite Surface {4} = {13, 23, 24, 14};
Transfinite Surface {5} = {14, 24, 21, 11};
Recombine Surface {1, 2, 3, 4, 5};
Physical Curve("bottom") = {32};
Physical Curve("top") = {36};
Physical Surface(10) = {1, 2, 3, 4, 5};
