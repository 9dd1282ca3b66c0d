"""Formulas of other authors beside programs that have their law."""

import numpy as np
import pytest

import springfit as sf


def test_delingettes_tetrahedra_are_mujocos_flex(tmp_path, monkeypatch):
    """MuJoCo's flex of tetrahedra has the energy of St. Venant-Kirchhoff in squared lengths of edges, which is that of biquadratic springs."""
    mujoco = pytest.importorskip("mujoco")
    # MuJoCo writes its warnings to a file beside the caller.
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(1)
    points = np.array([[0, 0, 0], [1, 0.1, 0], [0.2, 0.9, 0.1], [0.1, 0.2, 1.1], [1.1, 0.9, 0.8]])
    cells = np.array([[0, 1, 2, 3], [1, 4, 2, 3]])
    young, poisson = 2.0, 0.3
    axes = "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    inertia = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    bodies = "".join(
        f'<body name="v{i}" pos="{x[0]} {x[1]} {x[2]}">{axes}{inertia}</body>' for i, x in enumerate(points)
    )
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option gravity="0 0 0"/>
          <worldbody>{bodies}</worldbody>
          <deformable>
            <flex name="f" dim="3" body="{" ".join(f"v{i}" for i in range(len(points)))}"
                  element="{" ".join(map(str, cells.ravel()))}" vertex="{" ".join(["0"] * points.size)}">
              <elasticity young="{young}" poisson="{poisson}" damping="0"/>
              <contact selfcollide="none"/>
            </flex>
          </deformable>
        </mujoco>""")
    data = mujoco.MjData(model)
    mesh = sf.Mesh(points, {"tet4": cells})
    net = sf.fit(mesh, sf.Material(young=young, poisson=poisson), objective="delingette-biquadratic")
    for size in (1e-3, 0.1, 0.3):
        displacement = size * rng.standard_normal(points.shape)
        data.qpos[:] = displacement.ravel()
        mujoco.mj_forward(model, data)
        flex = data.qfrc_passive.reshape(points.shape)
        own = net.forces(points + displacement)
        assert np.allclose(own, flex, rtol=0, atol=1e-10 * abs(flex).max()), size
