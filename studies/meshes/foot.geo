// A foot, 4 wide and 2 high. Its sole is an arc of radius 12 that touches y = 0 at the origin.
//   gmsh -2 foot.geo -o foot.msh                             elements of size 0.2 at the sole
//   gmsh -2 -setnumber size 0.4 foot.geo -o foot_coarse.msh
//   gmsh -2 -setnumber size 0.1 foot.geo -o foot_fine.msh
If (!Exists(size)) size = 0.2; EndIf
R = 12;
h = R - Sqrt(R^2 - 4);
Point(1) = {-2, h, 0, size};
Point(2) = {0, 0, 0, size};
Point(3) = {2, h, 0, size};
Point(4) = {2, 2, 0, 2 * size};
Point(5) = {-2, 2, 0, 2 * size};
Point(6) = {0, R, 0};
Circle(1) = {1, 6, 2};
Circle(2) = {2, 6, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
Physical Curve("sole") = {1, 2};
Physical Curve("top") = {4};
Physical Surface("foot") = {1};
