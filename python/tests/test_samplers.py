"""Sampled fits: Python functions as norms and as samplers of shapes, errors as data, and learning curves."""

import numpy as np
import pytest

import springfit as sf

MATERIAL = sf.Material(young=1e4, poisson=0.3)
SHAPES = {"count": 60, "held_out": 20, "stretch": 0.2}


def box(name="tet4"):
    d = sf.Element(name).dimension
    mesh = sf.Mesh.box(name, size=[1.0, 0.8, 0.7][:d], cells=[2, 1, 1][:d])
    x = mesh.points + 0.03 * np.random.default_rng(3).uniform(-1, 1, mesh.points.shape)
    return sf.Mesh(x, dict(mesh.cells))


def squares(r):
    return float((r * r).sum()), 2 * r


def squares_of_shapes(r):
    return (r * r).sum(axis=(1, 2)), 2 * r


@pytest.mark.parametrize("norm", [squares, squares_of_shapes])
@pytest.mark.parametrize("keys", [{}, {"nonnegative": True}, {"force": "free-rest"}, {"higher": 0.3}])
def test_a_sum_of_squares_is_the_two_norm(norm, keys):
    known = sf.sampled(box(), MATERIAL, "neo-hookean", shapes=SHAPES, **keys)
    net = sf.sampled(box(), MATERIAL, "neo-hookean", shapes=SHAPES, norm=norm, **keys)
    assert np.abs(net.constants - known.constants).max() <= 1e-6 * np.abs(known.constants).max()


def test_a_norm_sees_shapes_of_one_cell():
    seen = set()

    def norm(r):
        seen.add(r.shape)
        return squares(r)

    sf.sampled(box("hex8"), MATERIAL, "neo-hookean", shapes=SHAPES, norm=norm)
    assert seen == {(60, 8, 3)}
    seen.clear()
    sf.sampled(box("hex8"), MATERIAL, "neo-hookean", shapes=SHAPES, norm=norm, higher=0.5)
    assert seen == {(60, 11, 3)}


def raises(r):
    raise KeyError("no such table")


@pytest.mark.parametrize(
    "norm, words",
    [
        (raises, "KeyError"),
        (lambda r: 1.0, "a pair"),
        (lambda r: (1.0, r, r), "a pair"),
        (lambda r: (np.nan, r), "finite numbers"),
        (lambda r: (np.zeros(3), r), "shape (60,)"),
        (lambda r: ((r * r).sum(), r[0]), "a gradient of shape (60, 4, 3)"),
        (lambda r: ((r * r).sum(), r), "the gradient of the value"),
        (lambda r: ("one", r), "real numbers"),
    ],
)
def test_wrong_norms_are_named(norm, words):
    with pytest.raises(sf.SpringfitError) as error:
        sf.sampled(box(), MATERIAL, "neo-hookean", shapes=SHAPES, norm=norm)
    assert error.value.key == "norm" and words in str(error.value) and "\n" not in str(error.value), str(error.value)


def test_a_norm_belongs_to_sampled_fits():
    with pytest.raises(sf.SpringfitError) as error:
        sf.fit(box(), MATERIAL, "modal", norm=squares)
    assert error.value.key == "norm"


def pulled(count, random):
    stretch = random.uniform(-0.2, 0.3, count)
    return np.eye(3) + stretch[:, None, None] * np.diag([1.0, 0.0, 0.0])


@pytest.mark.parametrize("held_out", [None, 25, 0, {"families": ["simple-shear"], "count": 40}, {"sampler": pulled, "count": 30}])
def test_samplers_draw_the_shapes(held_out):
    shapes = {"sampler": pulled, "count": 50, "perturbation": 0, "seed": 4}
    if held_out is not None:
        shapes["held_out"] = held_out
    net = sf.sampled(box("hex8"), MATERIAL, "neo-hookean", shapes=shapes, data=held_out != 0)
    assert net.sampled["shapes"] == 50
    if held_out == 0:
        assert net.sampled["held_out"] is None
        return
    number = held_out["count"] if isinstance(held_out, dict) else 25 if held_out == 25 else 100
    errors = {key: np.asarray(column) for key, column in net.sampled["errors"].items()}
    first = errors["cell"] == errors["cell"][0]
    trained, others = first & (errors["part"] == "trained"), first & (errors["part"] == "held-out")
    assert (trained.sum(), others.sum()) == (50, number)
    drawn = pulled(50, np.random.default_rng([4, 0]))
    assert np.allclose(errors["least_det"][trained], np.linalg.det(drawn))
    assert set(errors["family"][others]) == ({"simple-shear"} if isinstance(held_out, dict) and "families" in held_out else {"listed"})
    # No shape is in both parts.
    assert not set(np.round(errors["least_det"][trained], 12)) & set(np.round(errors["least_det"][others], 12)) or "simple-shear" in errors["family"]


@pytest.mark.parametrize(
    "sampler, key, words",
    [
        (raises, "shapes.sampler", "TypeError"),
        (lambda count, random: np.zeros((count, 3)), "shapes.sampler", "shape (40, d, d)"),
        (lambda count, random: pulled(count - 1, random), "shapes.sampler", "shape (39, 3, 3)"),
        (lambda count, random: pulled(count, random) * np.nan, "shapes.sampler", "finite numbers, found others in shape 0"),
        (lambda count, random: -pulled(count, random), "shapes.sampler", "det F = -"),
        (lambda count, random: np.tile(np.eye(2), (count, 1, 1)), "shapes.gradients", "9 numbers"),
        (3, "shapes.sampler", "a function"),
    ],
)
def test_wrong_samplers_are_named(sampler, key, words):
    with pytest.raises(sf.SpringfitError) as error:
        sf.sampled(box(), MATERIAL, "neo-hookean", shapes={"sampler": sampler, "count": 40, "held_out": {"families": ["bending"]}})
    assert error.value.key == key and words in str(error.value) and "\n" not in str(error.value), str(error.value)


def test_a_sampler_is_one_source():
    with pytest.raises(sf.SpringfitError) as error:
        sf.sampled(box(), MATERIAL, "neo-hookean", shapes=[{"sampler": pulled, "families": ["uniaxial"]}])
    assert error.value.key == "shapes[0]" and "sampler" in str(error.value)


def test_arrays_are_lists_of_gradients_and_sets_have_weights():
    gradients = pulled(30, np.random.default_rng(1))
    held = {"gradients": gradients, "count": 30}
    sets = [{"gradients": gradients, "perturbation": 0, "weight": 2, "held_out": held}, {"families": ["simple-shear"], "held_out": 10}]
    net = sf.sampled(box("hex8"), MATERIAL, "neo-hookean", shapes=sets)
    families = {one["family"]: one for one in net.sampled["families"]}
    assert families["listed"]["shapes"] == 30 and families["simple-shear"]["shapes"] == 10
    squares = [families[name]["held_out"]["mean"] ** 2 for name in ("listed", "simple-shear")]
    # Over several cells the means of both differ a little from the whole.
    assert net.sampled["held_out"]["mean"] == pytest.approx(np.sqrt((2 * squares[0] + squares[1]) / 3), rel=0.02)


def test_starts_and_errors_are_columns():
    keys = {"springs": ["edge"], "bounds": {"a": [0.1, 8.0]}, "starts": 3, "data": True}
    net = sf.sampled(box(), MATERIAL, "neo-hookean", force="k*(exp(a*s) - 1)", shapes=SHAPES, **keys)
    found = net.sampled
    ends = found["ends"]
    assert len(ends["error"]) == 3 * len(np.unique(ends["cell"])) and set(ends["start"]) == {0, 1, 2}
    assert all(ends["distance"][ends["start"] >= 0] >= 0) and ends["converged"].dtype == bool
    assert len(found["starts"]) == 3 and found["agreeing_starts"] is not None
    assert len(found["worst"]) == 8 and found["worst"][0]["error"] == pytest.approx(found["errors"]["error"].max())
    assert found["errors"]["stretches"].shape == (len(found["errors"]["cell"]), 2)
    assert sf.fit(box(), MATERIAL, "modal").sampled is None


def test_learning_curves_have_common_shapes_held_out():
    pytest.importorskip("pandas")
    keys = {"springs": ["edge"], "shapes": {"held_out": {"families": ["bending", "uniaxial"], "count": 40}, "count": 7}}
    curve = sf.learning_curve(box(), MATERIAL, "neo-hookean", counts=[20, 80], seeds=[3, 1], **keys)
    assert list(curve["seed"]) == [3, 3, 1, 1] and list(curve["shapes"]) == [20, 80, 20, 80]
    assert {"held_out bending", "held_out uniaxial"} <= set(curve.columns) and (curve["seconds"] > 0).all()
    # A point is the fit with this seed and count, whose held-out shapes have the seed of the whole curve.
    shapes = {**keys["shapes"], "count": 80, "seed": 3, "held_out": {**keys["shapes"]["held_out"], "seed": 1}}
    net = sf.sampled(box(), MATERIAL, "neo-hookean", springs=["edge"], shapes=shapes)
    assert net.sampled["held_out"]["mean"] == pytest.approx(curve["held_out"][1], rel=1e-12)
    assert net.sampled["trained"]["mean"] == pytest.approx(curve["trained"][1], rel=1e-12)
    listed = sf.learning_curve(box(), MATERIAL, "neo-hookean", counts=[5, 10], shapes={"sampler": pulled, "perturbation": 0}, springs=["edge"])
    assert list(listed["shapes"]) == [5, 10]
    for wrong, key in [({"counts": []}, "counts"), ({"counts": [0]}, "counts"), ({"counts": [5], "seeds": []}, "seeds")]:
        with pytest.raises(sf.SpringfitError) as error:
            sf.learning_curve(box(), MATERIAL, "neo-hookean", **wrong)
        assert error.value.key == key
    with pytest.raises(sf.SpringfitError) as error:
        sf.learning_curve(box(), MATERIAL, "neo-hookean", counts=[5], shapes={"held_out": 0})
    assert error.value.key == "shapes.held_out"


def test_norms_without_a_minimum_are_not_answered_by_the_start():
    mesh = sf.Mesh.box("tet4", [1, 1, 1], [1, 1, 1])
    given = dict(law="neo-hookean", shapes={"count": 40, "stretch": 0.2})
    material = sf.Material(1e4, 0.3)

    def fitted(value, slopes):
        return sf.sampled(mesh, material, norm=lambda r: (float(value(r)), slopes(r)), **given)

    squares = fitted(lambda r: np.sum(r * r), lambda r: 2 * r)
    start = sf.sampled(mesh, material, **given)
    assert np.allclose(squares.constants, start.constants, rtol=1e-9)
    assert squares.statistics["unreached_cells"] == 0
    # Least squares are the top of a function that falls without end: it has no minimum.
    with pytest.warns(UserWarning, match="cells has ended before an optimum"):
        fallen = fitted(lambda r: -np.sum(r * r), lambda r: -2 * r)
    assert fallen.statistics["unreached_cells"] > 0

    # A function whose top is at least squares, and whose minima are beside it: that of (S − 4 S0)², S being the sum of squares.
    seen = []
    fitted(lambda r: seen.append(np.sum(r * r)) or np.sum(r * r), lambda r: 2 * r)
    wanted = 4 * max(seen)
    beside = fitted(lambda r: (np.sum(r * r) / wanted - 1) ** 2, lambda r: 4 * r * (np.sum(r * r) / wanted - 1) / wanted)
    assert beside.statistics["unreached_cells"] == 0
    assert not np.allclose(beside.constants, start.constants, rtol=1e-3)
