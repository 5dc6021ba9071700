// Two quarter rings that share an arc, one of 8-node quadrangles and one of 6-node triangles.
//   gmsh quadratic_ring.geo -2 -format msh22 -o quadratic_ring_22.msh
//   gmsh quadratic_ring.geo -2 -format msh41 -o quadratic_ring_41.msh
Mesh.ElementOrder = 2;
Mesh.SecondOrderIncomplete = 1; // 8 nodes a quadrangle
Mesh.Binary = 0;
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {2, 0, 0};
Point(4) = {0, 2, 0};
Point(5) = {0, 1, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Point(6) = {3, 0, 0};
Point(7) = {0, 3, 0};
Line(5) = {3, 6};
Circle(6) = {6, 1, 7};
Line(7) = {7, 4};
Curve Loop(2) = {5, 6, 7, -2};
Plane Surface(2) = {2};
Transfinite Curve{1, 3, 5, 7} = 3;
Transfinite Curve{2, 4, 6} = 5;
Transfinite Surface{1, 2};
Recombine Surface{1};
Physical Surface("quads") = {1};
Physical Surface("triangles") = {2};
Physical Curve("inside") = {4};
Physical Curve("between") = {2};
Physical Curve("outside") = {6};
