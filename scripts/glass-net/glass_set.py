"""Sets of glass-make(1) as tensors: mapped into memory, cells drawn without a copy of the rest."""
import csv
import hashlib
import sys
from pathlib import Path

import numpy
import torch

INPUTS = {"rgb": 3, "stokes": 3, "intensities": 4}
LIGHTS = ("bare", "lit")
SHARES = ("training", "validation", "test")


def fail(text, status=65):
    print("glass-net: " + text, file=sys.stderr)
    raise SystemExit(status)


class Share:
    """One share of a set. What a cell gives: (input, truth); truth has mask, depth, front, back."""

    def __init__(self, folder, share, kind, light):
        if kind not in INPUTS or light not in LIGHTS:
            fail(f"{kind}-{light} is no input: one of {', '.join(INPUTS)}, with {' or '.join(LIGHTS)}", 64)
        self.folder, self.share, self.kind = Path(folder), share, kind
        self.paths = {name: Path(folder) / "tensors" / f"{share}-{name}.npy"
                      for name in (f"{kind}-{light}", "mask", "depth", "front", "back")}
        arrays = {}
        for name, path in self.paths.items():
            try:
                arrays[name] = numpy.load(path, mmap_mode="c")  # a write would not reach the file
            except OSError as error:
                fail(f"{path}: {error.strerror or error}; glass-make --gather writes it", 66)
        self.input = arrays.pop(f"{kind}-{light}")
        self.truth = arrays
        if self.input.shape[1] != INPUTS[kind]:
            fail(f"{path}: has {self.input.shape[1]} channels, {kind} has {INPUTS[kind]}")

    @classmethod
    def there(cls, folder, share, kind, light):
        """None where the set has no such share: it is too small."""
        path = Path(folder) / "tensors" / f"{share}-mask.npy"
        return cls(folder, share, kind, light) if path.exists() else None

    def __len__(self):
        return len(self.input)

    def batch(self, cells):
        seen = torch.from_numpy(numpy.ascontiguousarray(self.input[cells]))
        truth = {name: torch.from_numpy(numpy.ascontiguousarray(array[cells])) for name, array in self.truth.items()}
        return in_mean_light(seen, self.kind), truth

    def objects(self):
        """The number of each cell's object, in the order of the cells."""
        path = self.folder / "cells.csv"
        try:
            with open(path, newline="") as file:
                numbers = [int(row["object"]) for row in csv.DictReader(file) if row["share"] == self.share]
        except OSError as error:
            fail(f"{path}: {error.strerror or error}; glass-make --gather writes it", 66)
        if len(numbers) != len(self):
            fail(f"{path}: has {len(numbers)} cells for {self.share}, the tensors have {len(self)}")
        return numbers

    def fingerprint(self):
        """Of the files' heads and sizes, and of their first cells: which set it was."""
        digest = hashlib.sha256()
        for name in sorted(self.paths):
            path = self.paths[name]
            digest.update(f"{name} {path.stat().st_size}\n".encode())
            with open(path, "rb") as file:
                digest.update(file.read(1 << 20))
        return digest.hexdigest()


def in_mean_light(seen, kind):
    """In units of each picture's mean light before polarizers, so that exposures do not count."""
    light = seen[:, :1] if kind == "stokes" else seen
    mean = light.mean(dim=(1, 2, 3), keepdim=True).clamp_min(1e-6)
    return seen / (mean * (2.0 if kind == "intensities" else 1.0))
