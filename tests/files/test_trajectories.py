"""Trajectories, read by the programs that they are for; the forces of their contacts are those of the table."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from core.errors import InputError
from sandbox.files.trajectories.state import State
from sandbox.files.trajectories.trajectory import Trajectory
from sandbox.record.record import Output, repeat
from sandbox.session.commands import Protocol
from sandbox.session.session import Session

RUNS: dict[str, dict[str, object]] = {
    "hopper": {"grains": 40, "width": 9.0, "friction": 0.5},  # walls, friction, grains that leave
    "couette": {"grains": 160},  # discs, and one direction that repeats itself
    "avalanches": {"grains": 60},  # a cell that is sheared
}
EVERY, FRAMES = 8, 4
SUFFIXES = (".xyz", ".npz", ".pvd")


def increments(session: Session) -> Iterator[int]:
    """The start, and the increments of the scripted drive."""
    session.submit(Protocol(True))
    yield 0
    while session.finished < EVERY * (FRAMES - 1):
        if session.advance(10_000):
            yield session.finished


@pytest.fixture(scope="module", params=RUNS)
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return Run(request.param, tmp_path_factory.mktemp(request.param))


class Run:
    """A run with its files, and what they should say."""

    def __init__(self, scene: str, folder: Path) -> None:
        self.folder = folder
        self.session = Session(scene, "mixed", 1, RUNS[scene])
        self.session.build()
        self.states: list[State] = []
        with ExitStack() as stack:
            files = [stack.enter_context(Trajectory(folder / f"run{s}")) for s in SUFFIXES]
            for number in increments(self.session):
                if number % EVERY == 0:
                    self.states.append(State.of(self.session))
                    for file in files:
                        file.write(self.session)

    def on_bodies(self, state: State) -> np.ndarray:
        """What the table says of a frame, (B, 2), for the bodies that grains can touch."""
        return np.array(state.row.on_solids).reshape(-1, 2)

    @property
    def solids(self) -> list[int]:
        """Their places among all bodies."""
        world = self.session.run.setup.world
        return [world.index(body.name) for body in self.session.run.setup.solids]


def added(force: np.ndarray, body: np.ndarray, bodies: list[int]) -> np.ndarray:
    """What forces (C, 2) on grains come to on bodies, (B, 2)."""
    return np.array([-force[body == b].sum(axis=0) for b in bodies]).reshape(-1, 2)


def test_arrays(run: Run) -> None:
    with np.load(run.folder / "run.npz", allow_pickle=False) as file:
        data = dict(file)
    assert data["increment"].tolist() == [EVERY * k for k in range(FRAMES)]
    bodies = [data["bodies"].tolist().index(body.name) for body in run.session.run.setup.solids]
    tangential = 0.0
    for k, state in enumerate(run.states):
        grains = slice(*data["grain_start"][k : k + 2])
        contacts = slice(*data["contact_start"][k : k + 2])
        for name in ("label", "x", "q1", "pressure"):
            assert data[name][grains].tolist() == getattr(state.frame, name).tolist()
        assert data["stroke"][k] == state.row.stroke
        force, body = data["contact_force"][contacts], data["contact_body"][contacts]
        i, j = data["contact_i"][contacts], data["contact_j"][contacts]
        assert len(force) > 0
        assert np.array_equal(j < 0, body >= 0)
        gone = k > 0 and state.frame.grains < run.states[k - 1].frame.grains
        if not gone:  # the table has the force of those that left in the very increment
            np.testing.assert_allclose(added(force, body, bodies), run.on_bodies(state), atol=1e-12)
        sizes = np.hypot(data["contact_normal"], data["contact_tangential"])[contacts]
        tangential += float(data["contact_tangential"][contacts].sum())
        # A slope of the outlines has a part along the contact too: it is no friction.
        assert np.all(np.hypot(*force.T) >= 0.5 * sizes)
        # Without walls the forces on every grain are what is left unbalanced.
        on_grain = np.zeros((state.frame.grains, 2))
        np.add.at(on_grain, i, force)
        np.add.at(on_grain, j[j >= 0], -force[j >= 0])
        left = state.frame.residual_force
        if not gone:
            np.testing.assert_allclose(np.hypot(*on_grain.T), left, atol=1e-9)
    assert (tangential > 0.0) == (run.session.run.setup.friction is not None)


def test_ase_reads_extended_xyz(run: Run) -> None:
    io = pytest.importorskip("ase.io")
    frames = io.read(run.folder / "run.xyz", ":")
    assert len(frames) == FRAMES
    for state, atoms in zip(run.states, frames, strict=True):
        frame = state.frame
        np.testing.assert_array_equal(atoms.positions[:, :2], np.column_stack([frame.x, frame.y]))
        np.testing.assert_array_equal(atoms.arrays["id"], frame.label)
        np.testing.assert_array_equal(atoms.arrays["pressure"], frame.pressure)
        assert [s == "Au" for s in atoms.symbols] == frame.auxetic.tolist()
        assert atoms.info["plotted"] == frame.curve_label
        assert atoms.info["value"] == state.row.resisting
        if frame.box is not None:
            assert atoms.pbc.tolist() == [True, np.isfinite(frame.box[1]), False]
            assert atoms.cell[0, 0] == frame.box[0]
            assert not atoms.pbc[1] or atoms.cell[1, :2].tolist() == [frame.box[2], frame.box[1]]


@pytest.mark.filterwarnings("ignore")
def test_ovito_reads_shapes_unaided(run: Run) -> None:
    io = pytest.importorskip("ovito.io")
    pipeline = io.import_file(run.folder / "run.xyz")
    assert pipeline.source.num_frames == FRAMES
    state = run.states[-1]
    particles = pipeline.compute(FRAMES - 1).particles
    assert particles.count == state.frame.grains
    order = np.argsort(particles.identifiers[...])
    label = np.argsort(state.frame.label)
    long, short = state.axes
    shape = particles["Aspherical Shape"][...][order]
    np.testing.assert_allclose(shape[:, :2], np.column_stack([long, short])[label], rtol=1e-6)
    _, _, sine, cosine = particles["Orientation"][...][order].T
    along = 2.0 * np.arctan2(sine, cosine)
    np.testing.assert_allclose(np.cos(2.0 * (along - state.angle[label])), 1.0, atol=1e-6)


def test_vtk_reads_grains_and_chains(run: Run) -> None:
    xml = pytest.importorskip("vtkmodules.vtkIOXML")
    numpy_support = pytest.importorskip("vtkmodules.util.numpy_support")

    def read(part: str, number: int) -> tuple[object, dict[str, np.ndarray], np.ndarray]:
        reader = xml.vtkXMLPolyDataReader()
        (path,) = run.folder.glob(f"run-*/{part}-{number:06d}.vtp")
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
        cells = data.GetCellData()
        names = [cells.GetArrayName(k) for k in range(cells.GetNumberOfArrays())]
        arrays = {n: numpy_support.vtk_to_numpy(cells.GetArray(n)) for n in names}
        return data, arrays, numpy_support.vtk_to_numpy(data.GetPoints().GetData())

    state, number = run.states[0], 0
    data, arrays, points = read("grains", number)
    assert data.GetNumberOfPolys() == state.frame.grains  # type: ignore[attr-defined]
    np.testing.assert_array_equal(arrays["id"], state.frame.label)
    # The outline reaches as far along x as the support function says, but for its corners.
    outlines = points.reshape(state.frame.grains, -1, 3)
    frame = state.frame
    reach = np.sqrt((frame.p + frame.q1) ** 2 + frame.q2**2)
    np.testing.assert_allclose(np.ptp(outlines[:, :, 0], axis=1), 2.0 * reach, rtol=0.01)
    data, arrays, points = read("contacts", number)
    assert data.GetNumberOfLines() == len(state.frame.contacts)  # type: ignore[attr-defined]
    on_bodies = added(arrays["force"][:, :2], arrays["body"], run.solids)
    np.testing.assert_allclose(on_bodies, run.on_bodies(state), atol=1e-12)
    np.testing.assert_array_equal(points[::2, 0], state.frame.contacts.x0)
    if run.session.run.setup.world.bodies:
        assert set(read("bodies", number)[1]["body"]) == set(run.solids)


def test_the_collection_names_what_is_there_and_an_earlier_one_goes(tmp_path: Path) -> None:
    session = Session("single_grain", "regular", 1)
    session.build()
    with Trajectory(tmp_path / "run.pvd") as file:
        file.write(session)
    first = {path.name for path in tmp_path.iterdir()}
    before = (tmp_path / "run.pvd").read_bytes()
    with pytest.raises(ZeroDivisionError), Trajectory(tmp_path / "run.pvd") as file:
        file.write(session)
        raise ZeroDivisionError
    assert {path.name for path in tmp_path.iterdir()} == first
    assert (tmp_path / "run.pvd").read_bytes() == before
    session.submit(Protocol(True))
    while not session.advance():
        pass
    with Trajectory(tmp_path / "run.pvd") as file:
        file.write(session)
    now = {path.name for path in tmp_path.iterdir()}
    assert len(now) == len(first) == 2
    assert now != first
    (folder,) = (path for path in tmp_path.iterdir() if path.is_dir())
    text = (tmp_path / "run.pvd").read_text()
    assert all(f'file="{folder.name}/{path.name}"' in text for path in folder.iterdir())


def test_any_name_has_a_folder_beside_it_that_xml_can_name(tmp_path: Path) -> None:
    session = Session("single_grain")
    session.build()
    for name in ('a "b" & <c> #1', os.fsdecode(b"\xff"), 250 * "n"):
        path = tmp_path / f"{name}.pvd"
        with Trajectory(path) as file:
            file.write(session)
        named = [data.attrib["file"] for data in ElementTree.parse(path).iter("DataSet")]
        assert len(named) == 3
        assert all((tmp_path / file).is_file() for file in named)
        assert len(list(tmp_path.glob("*-*"))) == 1
        with Trajectory(path) as file:  # what was there goes
            session.advance(1)
            file.write(session)
            file.write(session)
        assert len(list(tmp_path.glob("*-*"))) == 1
        path.unlink()
        shutil.rmtree(next(tmp_path.glob("*-*")))


def test_the_same_run_gives_the_same_bytes_repeated_too(tmp_path: Path) -> None:
    session = Session("grain_row", "mixed", 1)
    session.build()
    with Trajectory(tmp_path / "one.npz") as file, Trajectory(tmp_path / "one.xyz") as other:
        for _ in increments(session):
            file.write(session)
            other.write(session)
    for name in ("npz", "xyz"):
        repeat(session.log(), Output(None, None, trajectory=tmp_path / f"two.{name}"))
        one, two = ((tmp_path / f"{which}.{name}").read_bytes() for which in ("one", "two"))
        assert one == two


def test_what_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    session = Session("single_grain", "regular", 1)
    session.build()
    (tmp_path / "run.npz").mkdir()
    with (
        pytest.raises(InputError, match=r"cannot write .*run\.npz"),
        Trajectory(tmp_path / "run.npz") as file,
    ):
        file.write(session)
    assert [path.name for path in tmp_path.iterdir()] == ["run.npz"]
