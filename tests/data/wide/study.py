"""A small reader of studies with matrices: M, C, K at a point.

    study = Study(path)
    study.names, study.lower, study.upper     the inputs
    M, C, K = study.matrices(point)           numpy arrays; C holds G, and K holds N
    M, C, K = study.matrices(point, Fraction) lists of rows, exactly (numbers in quotes need + - * / and powers only)

It is written apart from pcc, for tests of it: it knows rows, diagonals, entries, forms, factors, lists of
terms, Matrix Market files in coordinates, constants and helpers, and no more.  It needs NumPy.
"""

import re
import tomllib
from fractions import Fraction
from pathlib import Path

import numpy as np

NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")


class Study:
    def __init__(self, path):
        self.folder = Path(path).resolve().parent
        self.data = tomllib.loads(Path(path).read_text())
        self.name = self.data["name"]
        self.model = self.data["model"]
        self.names = list(self.data["inputs"])
        ranges = [self.range(value) for value in self.data["inputs"].values()]
        self.lower, self.upper = (np.array(side, dtype=float) for side in zip(*ranges))
        self.files = {}

    @staticmethod
    def range(value):
        assert value["distribution"] == "uniform"
        if "nominal" in value:
            half = abs(value["nominal"]) * value["spread"]
            return value["nominal"] - half, value["nominal"] + half
        return value["lower"], value["upper"]

    def matrices(self, point, kind=float):
        known = {name: kind(value) for name, value in self.model.get("constants", {}).items()}
        known.update({name: kind(float(value)) for name, value in zip(self.names, point)})
        for name, text in self.model.get("let", {}).items():
            known[name] = self.value(text, known, kind)
        M, C, K = (self.total(keys, known, kind) for keys in (("M",), ("C", "G"), ("K", "N")))
        if C is None:
            C = [[kind(0)] * len(M) for _ in M]
        return tuple(np.array(A) if kind is float else A for A in (M, C, K))

    @staticmethod
    def value(text, known, kind):
        if not isinstance(text, str):
            return kind(float(text))
        code = NUMBER.sub(lambda match: f"kind(float({match.group()!r}))", text.replace("^", "**"))
        code = re.sub(r"\*\*kind\(float\('(\d+)'\)\)", r"**\1", code)
        return eval(code, {"__builtins__": {}, "kind": kind, "float": float}, known)

    def total(self, keys, known, kind):
        terms = []
        for key in keys:
            given = self.model.get(key, [])
            if isinstance(given, dict):
                given = [given]
            elif given and isinstance(given[0], list):
                given = [{"rows": given}]
            terms += given
        answer = None
        for term in terms:
            A = self.term(term, known, kind)
            if answer is None:
                answer = A
            else:
                assert len(A) == len(answer)
                answer = [[a + b for a, b in zip(*rows)] for rows in zip(answer, A)]
        return answer

    def term(self, term, known, kind):
        def value(text):
            return self.value(text, known, kind)

        factor = value(term.get("factor", 1))
        form = term.get("form", "general")
        items = []
        if "file" in term:
            size, form, items = self.file(term["file"])
        elif "diagonal" in term:
            size = len(term["diagonal"])
            items = [(i, i, text) for i, text in enumerate(term["diagonal"])]
        elif "entries" in term:
            size = term["size"]
            items = [(i - 1, j - 1, text) for i, j, text in term["entries"]]
        else:
            size = len(term["rows"])
            items = [(i, j, text) for i, row in enumerate(term["rows"]) for j, text in enumerate(row)]
        A = [[kind(0)] * size for _ in range(size)]
        for i, j, text in items:
            entry = factor * value(text)
            A[i][j] = entry
            if form != "general" and i != j:
                A[j][i] = entry if form == "symmetric" else -entry
        return A

    def file(self, name):
        if name not in self.files:
            lines = (self.folder / name).read_text().splitlines()
            head = lines[0].lower().split()
            assert head[1:4] == ["matrix", "coordinate", "real"], head
            rows = [line.split() for line in lines[1:] if not line.startswith("%")]
            items = [(int(i) - 1, int(j) - 1, float(value)) for i, j, value in rows[1:]]
            assert len(items) == int(rows[0][2])
            self.files[name] = int(rows[0][0]), head[4], items
        return self.files[name]
