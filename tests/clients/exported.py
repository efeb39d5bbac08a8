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
