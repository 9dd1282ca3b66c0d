//! Small scenes that together have every key with a number.

/// Small deformation: every kind of load, frequencies, moduli, a gauge, measured displacements, several fits.
pub const LINEAR: &str = r#"
[mesh]
box = { element = "hex8", size = [1, 1, 1], cells = [1, 1, 1], origin = [0, 0, 0] }
scale = 1.0
[material]
young = 10e3
poisson = 0.3
density = 1000.0
[[fit]]
objective = "modal"
higher = 0.3
springs = ["edge", "face diagonal", "body diagonal", "bulk"]
[[fit]]
objective = "divergence"
balance = 0.5
[[fit]]
objective = "spectral"
gap = 1e-9
[[fit]]
objective = "exact"
energy = "stable-mooney-rivlin"
share = 0.5
[[fix]]
group = "zmin"
[[load]]
group = "zmax"
traction = [0, 0, 1.0]
[[load]]
group = "zmax"
traction = [0, 0, "2.0*x"]
[[load]]
group = "zmax"
force = [0, 0, 1.0]
[[load]]
body = [0, 0, 1.0]
[[load]]
group = "zmax"
displacement = ["free", "free", 0.01]
measured = { file = "measured.csv", scale = 1.0, sigma = 0.0001 }
reactions = [{ group = "zmax", force = ["free", 0, 1.0], sigma = 0.01 }]
[calibrate]
refinements = 0
[[load]]
sum = ["load 1", "load 3"]
[[load]]
group = "xmax"
pressure = 1.0
[solver]
method = "multigrid"
tolerance = 1e-9
iterations = 300
[sweep]
design = "random"
samples = 3
seed = 1
[sweep.over]
material.young = [1.0, 2.0]
material.poisson = [0.1, 0.3]
[output]
frequencies = 2
moduli = true
"#;

/// A plane gauge, and the general solvers of a fit.
pub const PLANE: &str = r#"
[mesh]
box = { element = "quad4", size = [2, 1], cells = [2, 1] }
[material]
young = "10 kPa"
poisson = 0.3
plane = "stress"
thickness = 0.1
[[fit]]
objective = "frobenius"
solver = "particle-swarm"
topology = true
sparsity = 0.1
iterations = 20
[[fix]]
group = "xmin"
[[load]]
group = "xmax"
traction = [1.0, 0]
[gauge]
group = "body"
axis = "x"
area = 0.1
"#;

/// Regions with values of their own and from a file.
pub const REGIONS: &str = r#"
[mesh]
box = { element = "quad4", size = [2, 1], cells = [2, 1] }
[[material]]
where = "x < 1.5"
young = 10e3
poisson = 0.3
thickness = 0.1
density = 1000.0
[[material]]
young = { file = "young.csv", scale = 1.0, missing = -7.0 }
poisson = 0.2
thickness = 0.2
density = 900.0
[[fit]]
objective = "exact"
[[fix]]
group = "xmin"
[[load]]
group = "xmax"
traction = [1.0, 0]
[[load]]
name = "weight"
gravity = [0, -9.81]
"#;

/// Anisotropic materials of every kind, with axes.
pub const ANISOTROPIC: &str = r#"
[mesh]
box = { element = "hex8", size = [4, 1, 1], cells = [4, 1, 1] }
[[material]]
where = "x < 1.1"
orthotropic = { young = [9e3, 4e3, 2e3], poisson = [0.3, 0.2, 0.3], shear = [1.5e3, 1e3, 2e3] }
axes = [[1.0, 1.0, 0], [0, 1.0, 1.0]]
[[material]]
where = "x > 0.9 && x < 2.1"
transversely-isotropic = { young = [9e3, 3e3], poisson = [0.3, 0.4], shear = 1e3 }
axes = [{ file = "fibres.csv", scale = 1.0, missing = -7.0 }]
[[material]]
where = "x > 1.9 && x < 3.1"
cubic = { c11 = 5e3, c12 = 2e3, c44 = 3e3 }
[[material]]
stiffness = [[3600.0, 1200.0, 1200.0, 0, 0, 0], [1200.0, 3600.0, 1200.0, 0, 0, 0], [1200.0, 1200.0, 3600.0, 0, 0, 0], [0, 0, 0, 1200.0, 0, 0], [0, 0, 0, 0, 1200.0, 0], [0, 0, 0, 0, 0, 1200.0]]
[[fit]]
objective = "offdiag"
[[fix]]
group = "xmin"
[[load]]
group = "xmax"
traction = [1.0, 0, 0]
"#;

/// Rods, from a file.
pub const RODS: &str = r#"
[mesh]
file = "rods.msh"
space = 3
quality = { least = 1e-4 }
[material]
shear_modulus = 4e3
bulk_modulus = 8e3
area = 0.01
[[fit]]
objective = "frobenius"
[[fix]]
where = "x < 0.5"
[[fix]]
where = "x > -1"
axes = ["y", "z"]
[[load]]
where = "x > 0.5"
force = [1.0, 0, 0]
"#;

/// Large deformation and sampled forces.
pub const LARGE: &str = r#"
[mesh]
box = { element = "tri3", size = [1, 1], cells = [1, 1] }
[material]
young = 10e3
poisson = 0.3
law = "neo-hookean"
[[fit]]
objective = "sampled"
higher = 0.5
norm = "huber"
huber = 0.5
shapes = { families = ["uniaxial"], count = 4, held_out = 2, stretch = [-0.1, 0.2], perturbation = 0.02, seed = 1 }
[[fit]]
name = "sets"
objective = "sampled"
[[fit.shapes]]
families = ["uniaxial"]
directions = [[1.0, 0.5]]
count = 4
stretch = 0.2
weight = 2.0
held_out = { families = ["pure-shear"], directions = [[0.5, 1.0, 1.0, 0.0]], count = 2, stretch = [0.1, 0.3], perturbation = 0.01, seed = 2 }
[[fit.shapes]]
gradients = [[1.1, 0.0, 0.05, 0.95]]
count = 1
[[fit.shapes]]
states = "states.csv"
scale = 1.0
held_out = { gradients = [[0.9, 0.1, 0.0, 1.0]], count = 1 }
[[fit]]
name = "law"
objective = "sampled"
force = "k*(exp(a*s) - 1)"
bounds = { a = [0.0, 10.0] }
starts = 2
shapes = { families = ["uniaxial"], count = 4, held_out = 2, stretch = 0.2 }
[newton]
steps = 2
iterations = 8
tolerance = 1e-8
[[fix]]
group = "ymin"
[[load]]
group = "ymax"
traction = [0, 100.0]
"#;

/// A law with fibres and parameters of its own.
pub const FIBRES: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
law = "fibre"
fibre = [1.0, 0.5, 0]
parameters = { stiffness = 0.8, growth = 1.0 }
[[fit]]
objective = "exact"
[[fix]]
group = "zmin"
[[load]]
group = "zmax"
traction = [0, 0, 100.0]
"#;

/// A sheet that bends.
pub const SHEET: &str = r#"
[mesh]
box = { element = "tri3", size = [1.0, 1.0], cells = [2, 2] }
space = 3
[material]
young = 10e3
poisson = 0.3
thickness = 0.02
bending = "plate"
flexural = 0.01
[[fit]]
objective = "exact"
bending = "hinges"
[[fix]]
where = "x < 0.6"
[[load]]
where = "x > 0.9"
force = [0, 0, 1e-4]
"#;

/// Rods that bend.
pub const FRAME: &str = r#"
[mesh]
file = "rods.msh"
space = 3
[material]
young = 10e3
poisson = 0.3
area = 0.01
density = 1000.0
bending = "rod"
flexural = 0.02
torsional = 0.03
[[fit]]
objective = "exact"
[[fix]]
where = "x < 0.5"
clamp = true
[[load]]
where = "x > 0.5"
moment = [1e-3, 2e-3, 3e-3]
[[load]]
where = "x > 0.5"
displacement = [0, "0.1*z", 0.01]
clamp = true
[output]
frequencies = 2
"#;

/// A plane frame whose middle is filled.
pub const CAVITY: &str = r#"
[mesh]
file = "frame.vtk"
[material]
young = 10e3
poisson = 0.3
law = "stable-neo-hookean"
thickness = 1.0
[[fit]]
objective = "exact"
[newton]
steps = 2
iterations = 8
[[fix]]
where = "x < 1e-9 && y < 1e-9"
[[fix]]
where = "x > 2.9 && y < 1e-9"
axes = ["y"]
[[load]]
where = "x > 0.9 && x < 2.1 && y > 0.9 && y < 2.1"
volume = 1.1
"#;

/// Fits to the whole object.
pub const WHOLE: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
density = 1000
[[fit]]
name = "one"
objective = "whole"
start = ["modal"]
higher = 0.3
loads = ["pull"]
regularization = 0.01
iterations = 5
seed = 3
frequencies = 1
[[fit]]
name = "two"
objective = "whole"
start = "divergence"
balance = 0.5
loads = ["pull"]
validate = ["push"]
range = 10.0
iterations = 5
[[fit]]
name = "three"
objective = "whole"
start = "sampled"
law = "neo-hookean"
shapes = { families = ["uniaxial"], count = 4, held_out = 2, stretch = 0.2, perturbation = 0.02, seed = 1 }
huber = 0.5
norm = "huber"
loads = ["pull"]
regularization = 0.01
iterations = 3
[[fit]]
name = "four"
objective = "offdiag"
nonnegative = true
engine = { method = "xpbd", step = 0.01, substeps = 4, iterations = 2, relaxation = 1.0 }
[[fix]]
group = "zmin"
[[load]]
name = "pull"
group = "zmax"
traction = [0, 0, 1.0]
[[load]]
name = "push"
group = "zmax"
traction = [1.0, 0, 0]
"#;

/// A coarse network for a finer body.
pub const COARSE: &str = r#"
[mesh]
box = { element = "tet4", size = [2, 1, 1], cells = [2, 1, 1] }
[material]
young = 10e3
poisson = 0.3
density = 1000.0
[reference]
refine = 1
[[fit]]
objective = "whole"
masses = 1
start = "exact"
shear = "edges"
volume = "patches"
supports = [["xmin"]]
validate_supports = [["xmax"]]
other_supports = [["xmin", "xmax"]]
iterations = 2
[[fix]]
group = "xmin"
[[load]]
group = "xmax"
traction = [0, 0, 1.0]
"#;

/// Moduli of an exact network under loads that stretch a body far.
pub const STRETCHED: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
law = "stable-neo-hookean"
[newton]
steps = 1
iterations = 20
[[fit]]
objective = "whole"
start = "exact"
stretch = 0.2
regularization = 0.01
iterations = 1
[[fix]]
group = "zmin"
[[load]]
group = "zmax"
traction = [0, 0, 1.0]
"#;

/// A disc in motion: pulled, pushed and damped.
pub const MOTION: &str = r#"
[mesh]
disc = { element = "tri3", radius = 1.0, height = 0.2, rings = 2, points = 16, rim = 9 }
[material]
young = 10e3
poisson = 0.3
thickness = 0.01
density = 1000.0
[[fit]]
objective = "offdiag"
nonnegative = true
[[fix]]
group = "rim"
[motion]
duration = 0.02
step = 0.01
iterations = 5
tolerance = 1e-8
solver = "conjugate-gradients"
remainder = 1e-8
gravity = [0, 0, -9.81]
damping = { rayleigh = [0.5, 0.002] }
every = 0.01
watch = { group = "middle" }
[[motion.pull]]
group = "middle"
displacement = ["0.001*t", "free", 0.0]
[[motion.force]]
where = "x > 0 && x^2 + y^2 < 0.5"
force = ["0.1*t", 0.0, 0.1]
"#;

/// A cube in linear motion, its springs with dampers of a ratio; and with symplectic steps.
pub const DAMPED: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
density = 1000
[[fit]]
objective = "exact"
nonnegative = true
[[fix]]
group = "zmin"
[motion]
duration = 0.02
step = 0.01
linear = true
integrator = "newmark"
finite_elements = false
damping = { ratio = 0.1 }
every = 0.01
[[motion.force]]
group = "zmax"
force = ["1 - t", 0, 0]
"#;

/// A cube that creeps, without inertia.
pub const CREEP: &str = r#"
[mesh]
box = { element = "hex8", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
[material.relaxation]
terms = [{ shear = 0.4, bulk = 0.2, time = 0.5 }]
[[fit]]
objective = "exact"
[[fix]]
group = "zmin"
[motion]
quasi-static = true
error = 0.01
linear = true
duration = 0.2
step = 0.1
[[motion.force]]
group = "zmax"
force = [0, 0, 1.0]
"#;

/// A cube of a material that was measured so; and one whose motion is damped as it was measured so, with what else the scene has.
macro_rules! measured {
    ($measured:literal) => {
        measured!(@ "", $measured, "")
    };
    ($measured:literal, $damping:literal, $more:literal) => {
        measured!(
            @ "density = 1000.0\n",
            $measured,
            concat!(
                "[[fix]]\ngroup = \"zmin\"\n[motion]\nduration = 0.2\nstep = 0.1\nlinear = true\ndamping = { measured = ",
                $damping,
                " }\n",
                $more
            )
        )
    };
    (@ $density:literal, $measured:literal, $rest:expr) => {
        concat!(
            "\n[mesh]\nbox = { element = \"hex8\", size = [1, 1, 1], cells = [1, 1, 1] }\n[material]\nyoung = 10e3\npoisson = 0.3\n",
            $density,
            "[material.relaxation]\nmeasured = ",
            $measured,
            "\n[[fit]]\nobjective = \"exact\"\n",
            $rest
        )
    };
}

/// Cubes whose relaxation was measured, over time.
pub const RELAXED: &str = measured!(r#"{ time = [0.1, 1.0, 10.0], modulus = [3.0, 2.0, 1.0], of = "all" }"#);

/// Cubes whose creep was measured.
pub const CREPT: &str = measured!("{ time = [0.1, 1.0, 10.0], compliance = [1.0, 1.5, 2.0] }");

/// Cubes whose moduli were measured over frequency.
pub const DYNAMIC: &str =
    measured!("{ frequency = [0.1, 1.0, 10.0], storage = [1.0, 2.0, 3.0], loss = [0.1, 0.5, 0.1] }");

/// Cubes whose damping was measured, of the material by loss factors, with moduli over frequency; and of the motion by decays.
pub const DECAYED: &str = measured!(
    "{ frequency = [0.1, 1.0, 10.0], loss_factor = [0.1, 0.2, 0.1], band = [0.2, 5.0] }",
    "{ time = [0.0, 0.1, 0.2], amplitude = [1.0, 0.6, 0.4], frequency = 10.0, band = [5.0, 20.0] }",
    "[output]\ndynamic_moduli = { band = [0.5, 2.0], count = 2 }\n"
);

/// Cubes whose damping was measured, of the material by decrements, and of the motion by ratios.
pub const DWINDLED: &str = measured!(
    "{ decrement = 0.3, band = [1.0, 10.0] }",
    "{ ratio = [0.05, 0.04], frequency = [1.0, 10.0] }",
    "[output]\ndynamic_moduli = { frequency = [0.5, 2.0] }\n"
);

/// Cubes whose damping was measured, of the material by amplitudes, and of the motion by loss factors.
pub const RUNG: &str = measured!(
    "{ time = [0.0, 0.1, 0.2], amplitude = [1.0, 0.6, 0.4], frequency = 10.0, band = [5.0, 20.0] }",
    "{ loss_factor = [0.05, 0.04], frequency = [1.0, 10.0], band = [2.0, 5.0] }",
    ""
);

/// Cubes whose damping was measured, of the material by ratios, and of the motion by decrements.
pub const DAMPENED: &str = measured!(
    "{ ratio = [0.1, 0.2], frequency = [1.0, 5.0] }",
    "{ decrement = 0.2, frequency = 2.0, band = [1.0, 4.0] }",
    ""
);

/// Cubes that flow beyond a yield stress.
pub const YIELDING: &str = r#"
[mesh]
box = { element = "hex8", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
law = "stable-neo-hookean"
[material.relaxation]
terms = [{ shear = 0.4, time = 0.5, yield = 30.0 }]
[[fit]]
objective = "exact"
[[fix]]
group = "zmin"
[motion]
quasi-static = true
duration = 1.0
step = 0.5
[[motion.force]]
group = "zmax"
force = ["10*t", 0, 0]
"#;

/// With finite elements that follow a law in motion, explicitly.
pub const EXPLICIT: &str = r#"
[mesh]
box = { element = "tet4", size = [1, 1, 1], cells = [1, 1, 1] }
[material]
young = 10e3
poisson = 0.3
density = 1000
law = "neo-hookean"
[[fit]]
objective = "exact"
energy = "neo-hookean"
[[fix]]
group = "zmin"
[motion]
duration = 0.002
step = 0.0005
integrator = "symplectic-euler"
gravity = [-9.81, 0, 0]
every = 0.001
[[motion.pull]]
group = "zmax"
displacement = ["free", 0, "0.01*t"]
"#;

/// An octahedron in a file, filled with cubes.
pub const FILLED: &str = r#"
[mesh]
fill = { surface = "octahedron.off", cell = 0.2, element = "hex8" }
scale = 1.0
[material]
young = 10e3
lambda = 5e3
[[fit]]
objective = "exact"
[[fix]]
where = "z < 0"
[[load]]
group = "body"
body = [0, 0, 1.0]
"#;

/// The octahedron mended and filled with tetrahedra, by the number of points.
pub const SCANNED: &str = r#"
[mesh]
fill = { surface = "octahedron.off", points = 90, element = "tet4", boundary = "smooth", repair = true }
scale = 1.0
[material]
young = 10e3
poisson = 0.3
[[fit]]
objective = "exact"
[[fix]]
where = "z < 0"
[[load]]
group = "body"
body = [0, 0, 1.0]
"#;

pub const ALL: [(&str, &str); 27] = [
    ("anisotropic", ANISOTROPIC),
    ("linear", LINEAR),
    ("plane", PLANE),
    ("regions", REGIONS),
    ("filled", FILLED),
    ("scanned", SCANNED),
    ("rods", RODS),
    ("large", LARGE),
    ("fibres", FIBRES),
    ("cavity", CAVITY),
    ("sheet", SHEET),
    ("frame", FRAME),
    ("crept", CREPT),
    ("whole", WHOLE),
    ("coarse", COARSE),
    ("stretched", STRETCHED),
    ("motion", MOTION),
    ("damped", DAMPED),
    ("explicit", EXPLICIT),
    ("creep", CREEP),
    ("relaxed", RELAXED),
    ("yielding", YIELDING),
    ("dynamic", DYNAMIC),
    ("decayed", DECAYED),
    ("dwindled", DWINDLED),
    ("rung", RUNG),
    ("dampened", DAMPENED),
];

/// Files that the scenes name.
pub const FILES: [(&str, &str); 7] = [
    (
        "octahedron.off",
        "OFF\n6 8 12\n0.53 0 0\n-0.51 0 0\n0 0.47 0\n0 -0.55 0\n0 0 0.57\n0 0 -0.45\n3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n\
         3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n",
    ),
    ("measured.csv", "point,ux,uy,uz\n4,0.001,0,0.01\n5,0,0,0.01\n6,0,0.001,0.01\n7,0,0,0.01\n"),
    (
        "rods.msh",
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 2 0.5 0.5\n$EndNodes\n$Elements\n2\n\
         1 1 2 0 1 1 2\n2 1 2 0 1 2 3\n$EndElements\n",
    ),
    (
        "frame.vtk",
        "# vtk DataFile Version 3.0\nframe\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 16 double\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n0 1 0\n1 1 0\n2 1 0\n3 1 0\n0 2 0\n1 2 0\n2 2 0\n3 2 0\n0 3 0\n1 3 0\n2 3 0\n3 3 0\nCELLS 8 40\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 4 5 9 8\n4 6 7 11 10\n4 8 9 13 12\n4 9 10 14 13\n4 10 11 15 14\nCELL_TYPES 8\n9\n9\n9\n9\n9\n9\n9\n9\n",
    ),
    ("states.csv", "point,ux,uy\n0,0,0\n1,0.05,0\n2,0,0.1\n3,0.05,0.1\n"),
    ("young.csv", "x,y,E\n0.5,0.5,5e3\n1.5,0.5,2e4\n"),
    ("fibres.csv", "x,y,z,a_x,a_y,a_z\n1.5,0.5,0.5,1,0,0\n1.5,0.5,0.6,1,1,0\n"),
];
