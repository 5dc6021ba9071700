// Three bodies in space: a block of hexahedra, 2 x 1 x 1, with a surface inside; a cylinder and a ball of tetrahedra.
//   gmsh -3 -format msh22 solids.geo -o solids_22.msh
//   gmsh -3 -format msh41 solids.geo -o solids_41.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {1, 0, 0, 1, 1, 1};
Coherence;
Transfinite Curve {:} = 3;
Transfinite Surface {:};
Recombine Surface {:};
Transfinite Volume {1, 2};
Cylinder(3) = {4, 0, 0, 0, 0, 1, 0.5};
Sphere(4) = {7, 0, 1, 1};
Mesh.MeshSizeMax = 0.7;
Physical Volume("block") = {1, 2};
Physical Volume("cylinder") = {3};
Physical Volume("ball") = {4};
Physical Surface("left") = Surface In BoundingBox {-0.1, -0.1, -0.1, 0.1, 1.1, 1.1};
Physical Surface("inside") = Surface In BoundingBox {0.9, -0.1, -0.1, 1.1, 1.1, 1.1};
Physical Surface("foot") = Surface In BoundingBox {3.4, -0.6, -0.1, 4.6, 0.6, 0.1};
Physical Surface("mantle") = Surface In BoundingBox {3.4, -0.6, -0.1, 4.6, 0.6, 1.1};
Physical Surface("mantle") -= Surface In BoundingBox {3.4, -0.6, -0.1, 4.6, 0.6, 0.1};
Physical Surface("mantle") -= Surface In BoundingBox {3.4, -0.6, 0.9, 4.6, 0.6, 1.1};
Physical Surface("sphere") = Surface In BoundingBox {5.9, -1.1, -0.1, 8.1, 1.1, 2.1};
Physical Curve("edge") = Curve In BoundingBox {-0.1, -0.1, -0.1, 0.1, 1.1, 0.1};
Physical Point("corner") = Point In BoundingBox {-0.1, -0.1, -0.1, 0.1, 0.1, 0.1};
