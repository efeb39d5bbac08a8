"""What `perilat export` says of the frames of the specimens: the numbers that other programs must show."""
import csv
import math

SPECIMENS = ("plane", "space", "irregular", "bars", "linked")
FRAMES = 4
END = 0.3e-3  # s, and not a step more than a hundredth of it


def comparable(values):
    """What has no number (bonds of a bar have no damage) is None, which is equal to itself."""
    return [None if math.isnan(value) else value for value in values]


class Columns:
    """A table by the names of its columns, without their units."""

    def __init__(self, path):
        with open(path, newline="") as file:
            head, *rows = csv.reader(file)
        columns = zip(*rows)
        self.columns = {name.split(" ")[0]: list(map(float, column)) for name, column in zip(head, columns)}
        self.count = len(rows)

    def vectors(self, *names):
        """Tuples of three: what is not there is 0."""
        zeros = [0.0] * self.count
        return list(zip(*(self.columns.get(name, zeros) for name in names)))


class Frame:
    def __init__(self, folder, specimen, frame):
        particles = Columns(f"{folder}/{specimen}_particles_{frame}.csv")
        bonds = Columns(f"{folder}/{specimen}_bonds_{frame}.csv")
        self.places = particles.vectors("x", "y", "z")
        self.displacement = particles.vectors("displacement_x", "displacement_y", "displacement_z")
        self.damage = particles.columns["damage"]
        self.ends = [(int(i), int(j)) for i, j in zip(bonds.columns["i"], bonds.columns["j"])]
        # laws stand in the order of their names, in these decks that of the lattices, too
        omegas = [column for name, column in bonds.columns.items() if name.endswith("/omega")]
        self.omega = comparable([next((w for w in bond if not math.isnan(w)), math.nan) for bond in zip(*omegas)])


class MeshFrame:
    """A frame of the mesh: its nodes, and the points of its crack."""

    NODES = (26, 21)

    def __init__(self, folder, frame):
        nodes = Columns(f"{folder}/mesh_particles_{frame}.csv")
        slit = Columns(f"{folder}/mesh_slit.csv").columns
        self.places = nodes.vectors("x", "y", "z")
        self.displacement = nodes.vectors("displacement_x", "displacement_y", "displacement_z")
        self.stress = nodes.columns["stress_yy"]
        self.crack = [(x, y, 0.0) for k, x, y in zip(slit["frame"], slit["x"], slit["y"]) if k == frame]
        self.cells = [cell for cell in self.all_cells() if not self.is_crossed(cell)]

    @classmethod
    def all_cells(cls):
        along, up = cls.NODES
        lows = (j * along + i for j in range(up - 1) for i in range(along - 1))
        return [(low, low + 1, low + 1 + along, low + along) for low in lows]

    def is_crossed(self, cell):
        """Points close to each other along the crack: is one inside?"""
        low, high = self.places[cell[0]], self.places[cell[2]]
        for a, b in zip(self.crack, self.crack[1:]):
            if any(max(a[c], b[c]) <= low[c] or min(a[c], b[c]) >= high[c] for c in (0, 1)):
                continue
            for k in range(2001):
                x, y = (p + k / 2000 * (q - p) for p, q in zip(a[:2], b[:2]))
                if low[0] < x < high[0] and low[1] < y < high[1]:
                    return True
        return False
