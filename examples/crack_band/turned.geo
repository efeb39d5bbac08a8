// Bar, mm, of square cells turned by 45 degrees; half cells at its edges. The cells across its middle are `weak`.
// gmsh -2 -format msh41 -setnumber n 4 turned.geo -o turned_10.msh      (n 2: cells of 20 mm, n 8: of 5 mm)
DefineConstant[ n = 4, width = 56.569, height = 113.137 ];
d = width/n;                      // diagonal of a cell
m = Round(height/d);
a = 1000;  b = 20000;             // numbers of the corners i, j of squares of the side d, and of their centres
For j In {0 : m}
  For i In {0 : n}
    Point(a + 100*j + i) = {i*d, j*d, 0};
  EndFor
EndFor
For j In {0 : m - 1}
  For i In {0 : n - 1}
    Point(b + 100*j + i) = {(i + 0.5)*d, (j + 0.5)*d, 0};
  EndFor
EndFor
// lines from the centre i, j to its four corners: 4 of 100 j + i, counted counter-clockwise from below left
l = 100000;
For j In {0 : m - 1}
  For i In {0 : n - 1}
    k = 100*j + i;
    Line(l + 4*k) = {b + k, a + k};
    Line(l + 4*k + 1) = {b + k, a + k + 1};
    Line(l + 4*k + 2) = {b + k, a + k + 101};
    Line(l + 4*k + 3) = {b + k, a + k + 100};
  EndFor
EndFor
all[] = {};  weak[] = {};  low[] = {};  high[] = {};
// upright cells, on the line from the corner i, j to i, j + 1
For j In {0 : m - 1}
  For i In {0 : n}
    k = 100*j + i;  right = l + 4*k;  left = l + 4*(k - 1);  c = newll;
    If (i == 0)
      e = newl;  Line(e) = {a + k + 100, a + k};
      Curve Loop(c) = {-right, right + 3, e};
    ElseIf (i == n)
      e = newl;  Line(e) = {a + k, a + k + 100};
      Curve Loop(c) = {left + 1, e, -(left + 2)};
    Else
      Curve Loop(c) = {-right, right + 3, -(left + 2), left + 1};
    EndIf
    s = news;  Plane Surface(s) = {c};  Transfinite Surface {s};  all[] += s;
    If (i > 0 && i < n)
      Recombine Surface {s};
    EndIf
  EndFor
EndFor
// level cells, on the line from the corner i, j to i + 1, j
For j In {0 : m}
  For i In {0 : n - 1}
    k = 100*j + i;  above = l + 4*k;  below = l + 4*(k - 100);  c = newll;
    If (j == 0)
      e = newl;  Line(e) = {a + k, a + k + 1};  low[] += e;
      Curve Loop(c) = {e, -(above + 1), above};
    ElseIf (j == m)
      e = newl;  Line(e) = {a + k + 1, a + k};  high[] += e;
      Curve Loop(c) = {e, -(below + 3), below + 2};
    Else
      Curve Loop(c) = {-(below + 3), below + 2, -(above + 1), above};
    EndIf
    s = news;  Plane Surface(s) = {c};  Transfinite Surface {s};
    If (j > 0 && j < m)
      Recombine Surface {s};
    EndIf
    If (2*j == m)
      weak[] += s;
    Else
      all[] += s;
    EndIf
  EndFor
EndFor
Transfinite Curve {:} = 2;
Physical Curve("bottom") = low[];
Physical Curve("top") = high[];
Physical Surface(10) = all[];
Physical Surface("weak") = weak[];
