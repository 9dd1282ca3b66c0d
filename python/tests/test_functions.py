"""Python functions as energies and as laws of force."""

import signal
import subprocess
import sys
import threading
import warnings

import numpy as np
import pytest

import springfit as sf

MATERIAL = sf.Material(young=1e4, poisson=0.3)
LAMBDA, MU = 1e4 * 0.3 / (1.3 * 0.4), 1e4 / 2.6
SHAPES = {"count": 60, "held_out": 20, "stretch": 0.2}


def energy(f):
    """Neo-Hookean, as materials/neo-hookean.toml."""
    j = np.linalg.det(f)
    return MU / 2 * (np.einsum("nij,nij->n", f, f) - 3) - MU * np.log(j) + LAMBDA / 2 * np.log(j) ** 2


def stress(f):
    inverse = np.linalg.inv(f).transpose(0, 2, 1)
    j = np.linalg.det(f)[:, None, None]
    return MU * (f - inverse) + LAMBDA * np.log(j) * inverse


def box(name="tet4"):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[2, 1, 1][:d])
    x = mesh.points + 0.03 * np.random.default_rng(3).uniform(-1, 1, mesh.points.shape)
    return sf.Mesh(x, dict(mesh.cells))


def same(net, other, tolerance):
    assert np.array_equal(net.springs, other.springs) and len(net) == len(other) > 0
    scale = max([abs(other.constants).max(initial=0)] + [abs(kind["constants"]).max() for kind in other.contents])
    assert np.abs(net.constants - other.constants).max(initial=0) <= tolerance * scale
    for kind, known in zip(net.contents, other.contents, strict=True):
        assert kind["kind"] == known["kind"] and np.array_equal(kind["points"], known["points"])
        kind, known = ({**each, **each.get("parameters", {})} for each in (kind, known))
        for key in kind:
            if key not in ("kind", "unit", "points", "law", "parameters", "element", "expression"):
                a, b = np.asarray(kind[key], float), np.asarray(known[key], float)
                assert np.abs(a - b).max() <= tolerance * np.abs(b).max(), (key, np.abs(a - b).max())


@pytest.mark.parametrize("name", ["tet4", "hex8", "tri3", "quad4"])
@pytest.mark.parametrize("functions", [(energy, None), (None, stress), (energy, stress)])
def test_a_function_is_the_energy_of_a_file(name, functions):
    known = sf.sampled(box(name), MATERIAL, "neo-hookean", shapes=SHAPES)
    net = sf.sampled(box(name), MATERIAL, functions[0], stress=functions[1], shapes=SHAPES)
    same(net, known, 1e-9)
    assert net.status == known.status


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_plane_states_relax_functions(plane):
    material = sf.Material(1e4, 0.3, plane=plane, thickness=0.02)
    known = sf.sampled(box("quad4"), material, "neo-hookean", shapes=SHAPES, springs=["edge", "diagonal", "bulk"])
    net = sf.sampled(box("quad4"), material, energy, shapes=SHAPES, springs=["edge", "diagonal", "bulk"])
    same(net, known, 1e-9)


LAWS = [
    ("k1*s + k3*s^3", lambda s, k1, k3: k1 * s + k3 * s**3),
    ("k*(c - c0) + a*(c - c0)^2", lambda c, c0, k, a: k * (c - c0) + a * (c - c0) ** 2),
    ("k*(exp(a*s) - 1)", lambda s, k, a: k * (np.exp(a * s) - 1)),
]


@pytest.mark.parametrize("text, function", LAWS)
def test_a_function_is_the_law_of_an_expression(text, function):
    keys = {"shapes": SHAPES, "springs": ["edge"]}
    if "exp" in text:
        keys |= {"bounds": {"a": [0.1, 8.0]}, "starts": 2}
    mesh = box("tet4")
    known = sf.sampled(mesh, MATERIAL, "neo-hookean", force=text, **keys)
    net = sf.sampled(mesh, MATERIAL, "neo-hookean", force=function, **keys)
    same(net, known, 1e-6 if "exp" in text else 1e-9)
    x = mesh.points * [1.1, 0.95, 1.05]
    assert net.energy(x) == pytest.approx(known.energy(x), rel=1e-6)
    assert np.allclose(net.forces(x), known.forces(x), rtol=1e-6, atol=1e-6 * abs(known.forces(x)).max())
    slopes = known.stiffness(x).toarray()
    assert np.abs(net.stiffness(x).toarray() - slopes).max() <= 1e-6 * np.abs(slopes).max()


def test_laws_of_groups_may_be_functions_beside_expressions(tmp_path):
    laws = {"edge": "k*c", "bulk": lambda s, a, b: a / (1 + s) + b * np.log(1 + s) / (1 + s)}
    net = sf.sampled(box(), MATERIAL, energy, force=laws, springs=["edge", "bulk"], shapes=SHAPES)
    bulk = next(kind for kind in net.contents if kind["kind"] == "volume")
    # The neo-Hookean energy of a tetrahedron is that of such springs.
    found = bulk["parameters"]
    assert np.allclose(found["a"], -MU, rtol=1e-8) and np.allclose(found["b"], LAMBDA, rtol=1e-8)
    for write in (lambda: net.write(tmp_path / "net.json"), lambda: net.write(tmp_path / "net.csv"), lambda: net.export("npz", tmp_path / "out")):
        with pytest.raises(sf.SpringfitError) as error:
            write()
        assert error.value.key == "force" and error.value.kind == "unsupported", str(error.value)
    assert not list(tmp_path.iterdir())


def test_two_laws_of_one_name_are_two():
    def pair(stiff):
        return lambda s, k: stiff * k * s

    mesh = sf.Mesh.box("quad4", size=[1, 1], cells=[2, 2])
    net = sf.sampled(mesh, MATERIAL, energy, force={"edge": pair(1.0), "diagonal": pair(3.0)}, shapes=SHAPES)
    known = sf.sampled(mesh, MATERIAL, energy, force={"edge": "k*s", "diagonal": "3*k*s"}, shapes=SHAPES)
    slopes = known.stiffness().toarray()
    assert np.abs(net.stiffness().toarray() - slopes).max() <= 1e-9 * np.abs(slopes).max()


def test_arguments_with_a_default_are_not_fitted():
    net = sf.sampled(box(), MATERIAL, energy, force=lambda s, k, a=2.0: k * (s + a * s**2), springs=["edge"], shapes=SHAPES)
    known = sf.sampled(box(), MATERIAL, energy, force="k*(s + 2*s^2)", springs=["edge"], shapes=SHAPES)
    same(net, known, 1e-9)


def test_parameters_may_have_the_names_of_fields():
    keys = {"springs": ["edge"], "shapes": SHAPES}
    net = sf.sampled(box(), MATERIAL, energy, force=lambda s, points, rest: points * s + rest * s**3, **keys)
    known = sf.sampled(box(), MATERIAL, energy, force=lambda s, k, a: k * s + a * s**3, **keys)
    [own], [other] = net.contents, known.contents
    assert np.array_equal(own["points"], other["points"]) and np.array_equal(own["rest"], other["rest"])
    assert np.array_equal(own["parameters"]["points"], other["parameters"]["k"])
    assert np.array_equal(own["parameters"]["rest"], other["parameters"]["a"])


def wrong_after_the_first(f):
    return stress(f) * np.where(np.arange(len(f)) > 0, 1.001, 1.0)[:, None, None]


def broken(f):
    raise KeyError("no such table")


@pytest.mark.parametrize(
    "given, key, words",
    [
        ({"law": broken}, "law", "KeyError"),
        ({"law": lambda f: f[0]}, "law", "shape (36,)"),
        ({"law": lambda f: np.zeros(len(f), complex)}, "law", "complex"),
        ({"law": lambda f: "stiff"}, "law", "real numbers"),
        ({"law": lambda f: energy(f) * np.nan}, "law", "finite"),
        ({"law": lambda f: energy(f) + 10.0 * f[:, 0, 0]}, "law", "no stress at rest"),
        ({"law": None, "stress": lambda f: f[0]}, "stress", "shape (1, 3, 3)"),
        ({"law": energy, "stress": lambda f: 2 * stress(f)}, "stress", "derivative"),
        ({"law": energy, "stress": wrong_after_the_first}, "stress", "derivative"),
        ({"law": lambda f: energy(f) > 0}, "law", "bool"),
        ({"law": lambda f: np.ma.masked_greater(energy(f), -1e99)}, "law", "masked"),
        ({"law": "neo-hookean", "stress": stress}, "stress", "a function, or none"),
        ({"law": energy, "stress": 3}, "stress", "function"),
        ({"law": None}, "law", "none"),
        ({"law": energy, "shapes": {"loads": ["tension"]}}, "shapes.loads", "expression"),
        ({"law": energy, "force": lambda k: k}, "force", "strain"),
        ({"law": energy, "force": lambda s: s}, "force", "parameters"),
        ({"law": energy, "force": lambda *a: a[0]}, "force", "named"),
        ({"law": energy, "force": lambda s, k: k * s[:1]}, "force", "shape"),
        ({"law": energy, "force": lambda s, k: 1 / 0}, "force", "ZeroDivisionError"),
        ({"law": energy, "force": lambda s, k: k * s * np.nan}, "force", "finite"),
        ({"law": energy, "force": {"edges": lambda s, k: k * s}}, "force", "edge"),
        ({"law": energy, "force": lambda s, k: 1e-3 * k * s * (1.0 if abs(k) < 3e4 else 1.5)}, "force", "linear"),
    ],
)
def test_what_functions_do_wrong_is_named(given, key, words):
    with pytest.raises(sf.SpringfitError) as error:
        sf.sampled(box(), MATERIAL, given.pop("law"), springs=["edge"], **{"shapes": SHAPES, **given})
    assert key in str(error.value.key) and words in str(error.value), (error.value.key, str(error.value))
    if "Error" in words:
        assert type(error.value.__cause__).__name__ == words


@pytest.mark.parametrize("functions", [(energy, None), (None, stress)])
def test_another_stiffness_at_rest_is_told(functions):
    for material, count in [(MATERIAL, 0), (sf.Material(2e4, 0.3), 1), (sf.Material(1e4, 0.35), 1)]:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            sf.sampled(box(), material, functions[0], stress=functions[1], shapes=SHAPES)
        assert len(told) == count and all("at rest" in str(warning.message) for warning in told)


def test_other_objectives_have_no_functions():
    for objective in ("offdiag", "exact", "van-gelder"):
        with pytest.raises(sf.SpringfitError) as error:
            sf.fit(box(), MATERIAL, objective, law=energy)
        assert error.value.key == "law", str(error.value)


def test_functions_that_fail_later_are_heard():
    state = {"fail": False}

    def force(s, k):
        if state["fail"]:
            raise RuntimeError("gone")
        return k * s

    net = sf.sampled(box(), MATERIAL, energy, force=force, springs=["edge"], shapes=SHAPES)
    state["fail"] = True
    x = net.points * 1.1
    for call in (net.forces, net.energy, net.stiffness):
        with pytest.raises(sf.SpringfitError) as error:
            call(x)
        assert isinstance(error.value.__cause__, RuntimeError)
    state["fail"] = False
    assert np.isfinite(net.forces(x)).all()


def test_each_thread_hears_its_own_function():
    failing, mixed = threading.Event(), []

    def force(s, k):
        if failing.is_set():
            raise RuntimeError(threading.current_thread().name)
        return k * s

    net = sf.sampled(box(), MATERIAL, energy, force=force, springs=["edge"], shapes=SHAPES)
    failing.set()

    def call():
        for _ in range(200):
            try:
                net.forces(net.points * 1.1)
                mixed.append("no error")
            except sf.SpringfitError as error:
                if str(error.__cause__) != threading.current_thread().name:
                    mixed.append(str(error))

    threads = [threading.Thread(target=call) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not mixed, mixed[:3]


def test_functions_are_called_while_other_threads_hold_the_lock():
    stop, count = threading.Event(), [0]

    def busy():
        while not stop.is_set():
            count[0] += 1

    thread = threading.Thread(target=busy)
    thread.start()
    try:
        net = sf.sampled(box(), MATERIAL, energy, shapes=SHAPES)
    finally:
        stop.set()
        thread.join()
    assert len(net) > 0 and count[0] > 0


def test_ctrl_c_ends_a_function():
    code = (
        "import signal, time, springfit as sf, numpy as np\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def slow(f):\n"
        "    print('go', flush=True)\n"
        "    time.sleep(0.2)\n"
        "    return ((f - np.eye(3))**2).sum((1, 2))\n"
        "mesh = sf.Mesh.box('hex8', size=[1, 1, 1], cells=[6, 6, 6])\n"
        "x = mesh.points + 1e-3 * np.random.default_rng(1).uniform(-1, 1, mesh.points.shape)\n"
        "sf.sampled(sf.Mesh(x, dict(mesh.cells)), sf.Material(1.0, 0.0), slow)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "go\n"
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert errors.rstrip().endswith("KeyboardInterrupt") and process.returncode != 0, errors


INNER = """
import sys
import numpy as np
import springfit as sf

mesh, material = sf.Mesh.box("tet4", size=[1, 1, 1], cells=[2, 2, 2]), sf.Material(10e3, 0.3)
net = sf.fit(mesh, material)
lam, mu = 10e3 * 0.3 / (1.3 * 0.4), 10e3 / 2.6
inner = {
    "mesh": lambda: sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]),
    "fit": lambda: sf.fit(sf.Mesh.box("tet4", size=[1, 1, 1], cells=[1, 1, 1]), material),
    "energy": net.energy,
    "stiffness": lambda: sf.stiffness(mesh, material),
    "sampled": lambda: sf.sampled(mesh, material, neo_hookean, springs=["edge"], shapes={"count": 3}),
    "none": lambda: None,
}[sys.argv[1]]


def neo_hookean(f):
    j = np.linalg.det(f)
    return mu / 2 * (np.einsum("nij,nij->n", f, f) - 3) - mu * np.log(j) + lam / 2 * np.log(j) ** 2


def energy(f):
    inner()
    return neo_hookean(f)


print(repr(float(sf.sampled(mesh, material, energy, springs=["edge"], shapes={"count": 5}).constants.sum())))
"""


def test_a_function_may_use_the_module():
    """On threads of its own: those of the fit wait for the function. In a process of its own, which a deadlock does not keep."""
    call = lambda what: subprocess.run([sys.executable, "-c", INNER, what], capture_output=True, text=True, timeout=100, check=True).stdout
    expected = call("none")
    assert float(expected) > 0
    for what in ["mesh", "fit", "energy", "stiffness", "sampled"]:
        assert call(what) == expected, what


def test_one_call_serves_all_springs_of_a_cell():
    """And of a network; a function of numbers alone is called for one spring at a time."""
    asked = []

    def many(s, k, a):
        asked.append(np.size(s))
        return k * (np.exp(a * s) - 1)

    def one(s, k, a):
        asked.append(np.size(s))
        return k * (np.exp(a * s) - 1) if k > -1e300 else s

    nets, calls, sizes = [], [], []
    for function in (many, one):
        asked.clear()
        nets.append(sf.sampled(box(), MATERIAL, "neo-hookean", force=function, springs=["edge"], shapes=SHAPES, bounds={"a": [0.1, 8.0]}))
        calls.append(len(asked))
        sizes.append(sum(asked))
    same(nets[0], nets[1], 1e-12)
    # Six springs, each with a force and four around its inner parameter.
    assert 4 * calls[0] < calls[1] and sizes[0] == pytest.approx(sizes[1], rel=0.01)
    known = sf.sampled(box(), MATERIAL, "neo-hookean", force="k*(exp(a*s) - 1)", springs=["edge"], shapes=SHAPES, bounds={"a": [0.1, 8.0]})
    known = known.with_constants(contents=[{"parameters": nets[0].contents[0]["parameters"]}])
    x = known.points + 0.1 * np.random.default_rng(8).uniform(-1, 1, known.points.shape)
    fix = known.points[:, 0] < 0.1
    held = lambda net: net.equilibrium(fix, 5.0 * ~fix[:, None] * [1, 0, 0])
    moved = lambda net: net.simulate(fix, gravity=[0, 0, -9.81], dt=1e-2, steps=5, masses=np.full(len(net.points), 0.1)).positions
    slow = lambda net: net.simulate(
        fix, gravity=[0, 0, -9.81], dt=1e-4, steps=5, masses=np.full(len(net.points), 0.1), method="symplectic-euler"
    ).positions
    for answer in (lambda net: net.energy(x), lambda net: net.forces(x), lambda net: net.stiffness(x).toarray(), held, moved, slow):
        expected, found = np.asarray(answer(known)), np.asarray(answer(nets[0]))
        assert np.abs(found - expected).max() <= 1e-8 * np.abs(expected).max()
    asked.clear()
    nets[0].forces(x)
    assert asked == [len(nets[0])]
    asked.clear()
    nets[0].energy(x)
    assert len(asked) <= 1 + 20 * len(nets[0]) and asked[0] == 53 * len(nets[0])


def test_functions_that_use_what_is_asked_at_once_are_asked_for_one_spring():
    """Its forces depend on the other strains of a call."""
    scaled = lambda s, k: k * s + k * 1e-3 * s * (np.abs(s).max() > 10)
    mixed = lambda s, k: k * (s - 1e-3 * s.mean() * s)
    net = sf.sampled(box(), MATERIAL, "neo-hookean", force=scaled, springs=["edge"], shapes=SHAPES)
    known = sf.sampled(box(), MATERIAL, "neo-hookean", force="k*s", springs=["edge"], shapes=SHAPES)
    same(net, known, 1e-9)
    assert len(sf.sampled(box(), MATERIAL, "neo-hookean", force=mixed, springs=["edge"], shapes=SHAPES)) == len(net)


def test_energies_and_stresses_that_a_rotation_changes_are_told():
    def small(f):
        strain = (f + f.transpose(0, 2, 1)) / 2 - np.eye(3)
        trace = np.trace(strain, axis1=1, axis2=2)
        lam, mu = 1e4 * 0.3 / (1.3 * 0.4), 1e4 / 2.6
        return mu * (strain**2).sum((1, 2)) + lam / 2 * trace**2

    with pytest.warns(UserWarning, match="a rotation changes it"):
        sf.sampled(box(), sf.Material(1e4, 0.3), small, springs=["edge"], shapes={"count": 20})
    with pytest.warns(UserWarning, match="is not symmetric"):
        turned = lambda f: stress(f).transpose(0, 2, 1)  # noqa: E731
        sf.sampled(box(), sf.Material(1e4, 0.3), stress=turned, springs=["edge"], shapes={"count": 20})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sf.sampled(box(), sf.Material(1e4, 0.3), energy, springs=["edge"], shapes={"count": 20})
        sf.sampled(box(), sf.Material(1e4, 0.3), stress=stress, springs=["edge"], shapes={"count": 20})


def test_an_exact_network_tells_that_it_does_not_take_the_law_of_scenes():
    with pytest.warns(UserWarning, match="yeoh"):
        sf.fit(box(), sf.Material(1e4, 0.3, law="yeoh"), "exact")


def test_shapes_without_forces_are_the_fault_of_the_shapes():
    rest = lambda n, random: np.tile(np.eye(3), (n, 1, 1))  # noqa: E731
    # Powers of two, so that gradients at rest are those of the identity to the last bit.
    mesh = sf.Mesh.box("tet4", size=[0.5, 0.25, 0.25], cells=[1, 1, 1])
    with pytest.raises(sf.SpringfitError, match="shapes: expected shapes that deform"):
        sf.sampled(mesh, sf.Material(1e4, 0.3), "neo-hookean", springs=["edge"], shapes={"sampler": rest, "count": 20, "perturbation": 0})
