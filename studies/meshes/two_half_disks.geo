// One quarter of two half disks of radius 8 that touch at the origin: the right half of "upper", which faces down.
// two_half_disks.py meshes it and mirrors the mesh into the other three quarters.

R = 8;          // radius
c = 1.2;        // half width of the contact curves
n = 38;         // elements on half of a contact curve: size 0.032 = 0.68 / 21.5, for Hertz's half width 0.68
growth = 0.08;  // of the element size per distance, far from the contact curve; none at it
h = c / n;

Point(1) = {0, 0, 0};
Point(2) = {c, R - Sqrt(R^2 - c^2), 0};
Point(3) = {R, R, 0};
Point(4) = {0, R, 0};
Circle(1) = {1, 4, 2};
Circle(2) = {2, 4, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Transfinite Curve {1} = n + 1;
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Physical Curve("contact") = {1};
Physical Curve("rest") = {2};
Physical Curve("flat") = {3};
Physical Surface("quarter") = {1};

// square of the distance from the segment |x| < c, y = 0
squared = Str(Sprintf("(((abs(x) - %g + abs(abs(x) - %g)) / 2)^2 + y^2)", c, c));
Field[1] = MathEval;
Field[1].F = StrCat(Sprintf("%g + %g * ", h, growth), squared, "/ (sqrt", squared, Sprintf(" + %g)", c / 2));
Background Field = 1;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;
