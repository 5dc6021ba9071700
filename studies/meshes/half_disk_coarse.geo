// A half disk of radius 8 with the pole at the origin, facing down; a small example in the older format.
// gmsh half_disk_coarse.geo -2 -format msh22 -o half_disk_coarse.msh
Point(1) = {-8, 8, 0, 2};
Point(2) = {0, 0, 0, 0.5};
Point(3) = {8, 8, 0, 2};
Point(4) = {0, 8, 0, 2};
Circle(1) = {1, 4, 2};
Circle(2) = {2, 4, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("disk") = {1};
Physical Curve("arc") = {1, 2};
Physical Curve("flat") = {3, 4};
Physical Point("pole") = {2};
