"""Bodies on several machines, by PETSc over MPI: ``mpirun -n P python -m springfit.petsc SCENE``.

The first rank reads the scene and shares out slices of its mesh, which the ranks partition. Each rank fits its cells and fills its rows
of the matrices; the equations of the body and of each network are solved together. Requires petsc4py and mpi4py.
"""

#: Who partitions: what PETSc may have for a graph that is shared out, and recursive coordinate bisection.
PARTITIONERS = ("parmetis", "ptscotch", "bisection")
