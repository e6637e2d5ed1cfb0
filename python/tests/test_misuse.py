"""Misuse gives an exception with a sentence that helps: no abort, no hang."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
import systems
from conftest import OSCILLATOR

import pcc

POINTS = [
    (np.zeros((3, 3)), r"X has the shape \(3, 3\); it takes a row for each point and 2 columns, mu, k_p"),
    (np.zeros(2), r"for one point with the inputs mu, k_p give X\[np.newaxis\]"),
    (np.zeros((2, 2, 2)), r"shape \(2, 2, 2\)"),
    (0.25, r"shape \(\)"),
    ([[np.nan, 16e6]], "row 0: mu = NaN is not a finite number"),
    ([[0.1, 16e6], [0.1, np.inf]], "row 1: k_p = inf is not a finite number"),
    ([[0.1, 16e6 + 1j]], "complex"),
    ([["a", "b"]], "give real numbers"),
    (np.array([[0.1, None]], dtype=object), "row 0: k_p = NaN|no numbers"),
    (np.array([[True, False]]), "give real numbers"),
    (np.array([["2026-01-01", "2026-01-02"]], dtype="datetime64[D]"), "give real numbers"),
    ([[0.1], [0.2, 16e6]], "no array of numbers|no numbers"),
    ((x for x in [[0.1, 16e6]]), "X is a generator, not points"),
    ("clutch.csv", "X is a str, not points"),
    (None, "X is None, not points"),
    ({"mu": [0.1]}, "X has no column k_p; its columns are mu, the inputs mu, k_p"),
    ({"mu": [0.1, 0.2], "k_p": [16e6, 16e6, 16e6]}, "columns of X differ in length: mu 2, k_p 3"),
    ({"mu": [[0.1]], "k_p": 16e6}, r"column mu has the shape \(1, 1\)"),
    ({"mu": ["high"], "k_p": 16e6}, "column mu is a list of type <U4; give real numbers"),
    (np.ma.masked_array([[0.1, 16e6]], mask=[[True, False]]), "masked values"),
    ([[10**400, 16e6]], "no numbers: .*too large"),
    ([{"mu": 0.1}], "X has no column k_p; its columns are mu"),
    ([{"mu": 0.1, "k_p": 16e6}, {"mu": 0.1}], "row 1: k_p = NaN|column k_p holds what are no numbers"),
    ({0.1, 16e6}, "X is a set"),
    ({"mu": (x for x in [0.1]), "k_p": 16e6}, "column mu is a generator"),
    (zip([0.1], [16e6]), "X is a zip, not points"),
]


@pytest.mark.parametrize("X, sentence", POINTS, ids=range(len(POINTS)))
def test_points_that_are_none(clutch, X, sentence):
    with pytest.raises(pcc.PointsError, match=sentence) as caught:
        clutch.eigenvalues(X)
    assert isinstance(caught.value, (pcc.Error, ValueError))


def test_tables_of_any_library_are_points_or_say_what_they_lack(clutch, points):
    pandas = pytest.importorskip("pandas")
    expected, (mu, k_p) = clutch.max_re(points).tolist(), points.T
    for dtype in ["Float64", "float64", ">f8"]:
        frame = pandas.DataFrame({"mu": np.asarray(mu), "k_p": k_p}).astype(dtype if dtype != ">f8" else "float64")
        assert clutch.max_re(frame).tolist() == expected
    missing = pandas.DataFrame({"mu": pandas.array([0.1, None], dtype="Float64"), "k_p": 16e6})
    with pytest.raises(pcc.PointsError, match="row 1: mu = NaN"):
        clutch.max_re(missing)
    with pytest.raises(pcc.PointsError, match="column mu is a Series of type bool"):
        clutch.max_re(pandas.DataFrame({"mu": [True], "k_p": 16e6}))
    with pytest.raises(pcc.PointsError, match=r"column mu has the shape \(1, 2\)"):
        clutch.max_re(pandas.DataFrame([[0.1, 0.2, 16e6]], columns=["mu", "mu", "k_p"]))
    assert clutch.max_re([{"k_p": k, "mu": m} for m, k in points[:5]]).tolist() == expected[:5]


def test_tables_of_polars_are_points(clutch, points):
    polars = pytest.importorskip("polars")
    expected, (mu, k_p) = clutch.max_re(points).tolist(), points.T
    table = polars.DataFrame({"k_p": k_p, "mu": mu})
    assert clutch.max_re(table).tolist() == expected
    with pytest.raises(pcc.PointsError, match=r"X is a LazyFrame, which has no values yet; give X.collect\(\)"):
        clutch.max_re(table.lazy())
    with pytest.raises(pcc.PointsError, match="row 1: mu = NaN"):
        clutch.max_re(polars.DataFrame({"mu": [0.1, None], "k_p": [16e6, 16e6]}))


@pytest.mark.parametrize("change", ["byte order", "read only", "Fortran", "long double", "reversed"])
def test_numbers_are_read_however_they_lie_in_memory(clutch, points, change):
    expected, given = clutch.max_re(points).tolist(), points.copy()
    if change == "byte order":
        given = points.astype(">f8")
    elif change == "read only":
        given.setflags(write=False)
    elif change == "Fortran":
        given = np.asfortranarray(points)
    elif change == "long double":
        given = points.astype(np.longdouble)
    else:
        given, expected = points[::-1], expected[::-1]
    assert clutch.max_re(given).tolist() == expected


QUESTIONS = [
    (lambda s: s.sample(0), "n is 0; give a whole number from 1"),
    (lambda s: s.sample(1.5), "n is 1.5; give a whole number"),
    (lambda s: s.sample("many"), "n is 'many'"),
    (lambda s: s.sample(True), "n is True"),
    (lambda s: s.sample(100, seed=-1), "seed is -1"),
    (lambda s: s.sample(100, where={"colour": 1.0}), "colour"),
    (lambda s: s.sample(100, where={"mu": (0.2, 0.1)}), "mu"),
    (lambda s: s.sample(100, where={"mu": (0.1, 0.2, 0.3)}), "the lower and the upper end"),
    (lambda s: s.sample(100, where={"mu": "low"}), "give a number"),
    (lambda s: s.sample(100, where=["mu"]), "where is a list; give a dict by inputs"),
    (lambda s: s.sample(100, where=(x for x in "mu")), "where is a generator; give a dict"),
    (lambda s: s.sample(100, where={"mu": 1j}), "give a number"),
    (lambda s: s.sample(100, seed=None), "seed is None"),
    (lambda s: s.sample(np.array([100])), "give a whole number"),
    (lambda s: s.sample(10**30), "give a whole number"),
    (lambda s: s.sample(100, where={"mu": (np.array([0.1]), 0.2)}), "give a number|the lower and the upper end"),
    (lambda s: s.sample(100, quantiles=[np.array([0.5])]), "give a number"),
    (lambda s: s.sample(100, quantiles=0.5), "give a list"),
    (lambda s: s.sample(100, replicates=-1), "replicates is -1"),
    (lambda s: s.sweep("mu"), "what is swept is a str; give a dict by inputs"),
    (lambda s: s.sweep(mu=np.linspace(0, 0.5, 10**7), n=10), "use fewer"),
    (lambda s: s.campbell("mu"), "is a str; give a dict by inputs"),
    (lambda s: s.sample(100).stable.interval("high"), "level is 'high'; give a number"),
    (lambda s: s.sample(100, events="flutter"), "give a list"),
    (lambda s: s.sample(100, events=["max_re=1"]), "is not understood"),
    (lambda s: s.sample(100, events=["size<1"]), "size"),
    (lambda s: s.sample(100, quantiles=[1.5]), "1.5"),
    (lambda s: s.sample(100, histograms=["weight"]), "weight"),
    (lambda s: s.sample(100, sampler="sobol'"), "choose one of 'monte-carlo'"),
    (lambda s: s.sweep(), "there is no input to sweep"),
    (lambda s: s.sweep(mu=[0.0, 0.1, 0.5]), "not equally spaced"),
    (lambda s: s.sweep(mu=[0.1]), "at least two finite"),
    (lambda s: s.sweep(mu=(x for x in [0.0, 0.5])), "generator"),
    (lambda s: s.sweep(colour=[0.0, 0.5]), "colour"),
    (lambda s: s.critical("colour"), "no such input; it has mu, k_p"),
    (lambda s: s.critical(3), "give its name"),
    (lambda s: s.to_bytes("xml"), 'choose "binary" or "json"'),
    (lambda s: s.certify(), "give the function, s.certify"),
    (lambda s: s.certify(lambda mu, k_p: np.eye(2)), "give the study"),
    (lambda s: s.campbell(), "along one input"),
    (lambda s: s.campbell(mu=[0.0, 0.5], k_p=[15.2e6, 16.8e6]), "along one input"),
    (lambda s: s.campbell(mu=0.1), "at least two finite numbers"),
    (lambda s: s.campbell(mu=(x for x in [0.0, 0.5])), "generator"),
    (lambda s: s.campbell(mu=[0.0, 0.5], level=95), "level is 95"),
    (lambda s: s.campbell(mu=[0.0, 0.5], where={"mu": 0.1}), "mu is what the diagram is along"),
    (lambda s: s.campbell(mu=[0.0, 0.5], modes=[9]), "no mode 9; the surrogate has 1, 2, 3, 4"),
    (lambda s: s.campbell(mu=[0.0, 0.5], modes=3), "give a list"),
    (lambda s: s.campbell(mu=[0.0, 0.5], modes=[]), "at least one mode"),
    (lambda s: s.campbell(colour=[0.0, 0.5]), "colour"),
    (lambda s: s.campbell(mu=[0.0, 0.7]), "0.7"),
]


@pytest.mark.parametrize("ask, sentence", QUESTIONS, ids=range(len(QUESTIONS)))
def test_questions_that_do_not_fit(clutch, ask, sentence):
    with pytest.raises(pcc.QuestionError, match=sentence):
        ask(clutch)


def test_files_that_are_none(tmp_path, clutch):
    (tmp_path / "empty.pcc").write_bytes(b"")
    (tmp_path / "cut.pcc").write_bytes(clutch.to_bytes()[:-1])
    for name, sentence in [
        ("missing.pcc", "missing.pcc: cannot be read"),
        ("empty.pcc", "empty.pcc: "),
        ("cut.pcc", "cut.pcc: "),
    ]:
        with pytest.raises(pcc.FileError, match=sentence):
            pcc.load(tmp_path / name)
    with pytest.raises(pcc.FileError, match="cannot be written"):
        clutch.save(tmp_path / "no" / "such.pcc")
    with pytest.raises(pcc.Error, match="missing.toml"):
        pcc.Study.read(tmp_path / "missing.toml")


PATHS = [None, 3, "a\0b.pcc", ["a.pcc"]]


@pytest.mark.parametrize("path", PATHS, ids=range(len(PATHS)))
def test_paths_that_are_none(clutch, path):
    for use in (pcc.load, clutch.save, clutch.report, pcc.Study.read):
        with pytest.raises(pcc.FileError, match="is no path of a file"):
            use(path)


@pytest.mark.skipif(os.name != "posix", reason="there are no such files")
def test_devices_pipes_and_links_are_not_replaced(clutch, tmp_path):
    pipe, link, file, dangling = (tmp_path / name for name in ("pipe", "link.pcc", "file.pcc", "dangling"))
    os.mkfifo(pipe)
    dangling.symlink_to(tmp_path / "missing")
    clutch.save(file)
    link.symlink_to(file)
    for path, sentence in [
        (pipe, "device or a pipe"),
        (tmp_path, "folder"),
        (dangling, "link to a file that does not"),
    ]:
        for write in (clutch.save, clutch.report):
            with pytest.raises(pcc.FileError, match=sentence):
                write(path) if write == clutch.save else write(path, n=100)
    clutch.save(link)
    assert link.is_symlink() and pipe.is_fifo() and pcc.load(file) == clutch


def test_bytes_that_are_none(clutch):
    for form in (bytes, bytearray, memoryview):
        assert pcc.Surrogate.from_bytes(form(clutch.to_bytes())) == clutch
    with pytest.raises(pcc.FileError, match=r"a str is not the bytes of a surrogate; of a file it is pcc.load\(path\)"):
        pcc.Surrogate.from_bytes("clutch.pcc")
    with pytest.raises(TypeError, match=r"surrogates come from files, pcc.load\(path\)"):
        pcc.Surrogate("clutch.pcc")
    with pytest.raises(pcc.StudyError, match=r"the text of a study is a bytes; a file is read by pcc.Study.read"):
        pcc.Study.from_toml(b"format = 1")


def system(**matrices):
    """A function that answers these matrices of one degree of freedom, or what is given in their place."""
    one = {"M": [[1.0]], "C": [[0.1]], "K": [[100.0]]} | matrices
    return lambda k, c: (one["M"], one["C"], one["K"])


ANSWERS = [
    (lambda k, c: None, "the function has returned None; return M, C, K; or A; or eigenvalues"),
    (lambda k, c: (x for x in "MCK"), "has returned a generator"),
    (lambda k, c: "MCK", "has returned a str"),
    (lambda k, c: (np.eye(2), np.eye(2)), "has returned 2 matrices"),
    (lambda k, c: (1.0, c, k), "one degree of freedom"),
    (lambda k, c: np.zeros((2, 3)), "A is 2 × 3; it must be square"),
    (lambda k, c: np.array([]), "shape \\(0,\\)"),
    (lambda k, c: np.eye(2) * 1j, "A is of type complex128; its entries must be real"),
    (lambda k, c: [1.0, np.nan], "eigenvalue 1 is"),
    (lambda k, c: np.array(["a"]), "array of type <U1"),
    (system(C=[[0.1, 0.0], [0.0, 0.1]]), "C is 2 × 2, but M is 1 × 1"),
    (system(K=[[np.nan]]), r"K\[0, 0\] is nan, no finite number"),
    (system(M=[["heavy"]]), "M is of type <U5"),
    (system(M=None), "M is None; C alone may be None"),
    (system(K=None), "K is None; C alone may be None"),
    (system(C=[0.1]), "C is a vector of 1; it must be square"),
    (system(M=np.eye(1, dtype=bool)), "M is of type bool"),
    (system(M=np.array([["heavy"]], dtype=object)), "M is of type object"),
    (system(M=np.zeros((1, 0, 1))), "M is 1 × 0 × 1; it must be square"),
    (lambda k, c: np.ma.masked_array(np.eye(2), mask=[[0, 1], [0, 0]]), "A has masked entries"),
    (lambda k, c: np.ma.masked_array([1.0, 2.0], mask=[0, 1]), "eigenvalues has masked entries"),
    (lambda k, c: {"M": np.eye(1)}, "has returned a dict"),
    (lambda k, c: np.array(1.0), r"shape \(\)"),
    (lambda k, c: lambda: None, "has returned a function"),
    (lambda k, c: object(), "has returned a object"),
    (lambda *values: None, "TypeError: .*unexpected keyword argument"),
    (lambda k: None, r"TypeError: .*unexpected keyword argument 'c'"),
    (lambda k, c: 1 / 0, r"ZeroDivisionError: division by zero \(test_misuse.py, line \d+\)"),
]


@pytest.mark.parametrize("function, sentence", ANSWERS, ids=range(len(ANSWERS)))
def test_functions_that_answer_no_model(function, sentence):
    with pytest.raises(
        pcc.RunError, match=f"with all inputs at their medians, k = 100.0, c = 0.1: .*{sentence}"
    ) as caught:
        pcc.Study(OSCILLATOR, function)
    assert caught.value.inputs == {"k": 100.0, "c": 0.1}


async def promises(k, c):
    return systems.oscillator(k, c)


@pytest.mark.filterwarnings("ignore:coroutine")
def test_coroutines_are_no_answers():
    with pytest.raises(pcc.RunError, match="the function has returned a coroutine; return M, C, K"):
        pcc.Study(OSCILLATOR, promises)


FORMATS = [
    "bsr_array",
    "coo_array",
    "csc_array",
    "csr_array",
    "dia_array",
    "dok_array",
    "lil_array",
    "csr_matrix",
    "dok_matrix",
]


@pytest.mark.parametrize("name", FORMATS)
def test_sparse_matrices_have_any_format(name):
    form = getattr(pytest.importorskip("scipy.sparse"), name)
    answers = [pcc.Study(OSCILLATOR, f).answer(k=95.0, c=0.1) for f in _systems_as(lambda part: form(np.array(part)))]
    expected = [pcc.Study(OSCILLATOR, f).answer(k=95.0, c=0.1) for f in _systems_as(np.array)]
    for found, same in zip(answers, expected):
        assert found[0] == same[0] and all(np.array_equal(a, b) for a, b in zip(found[1:], same[1:]))


def _systems_as(form):
    return [
        lambda k, c: form([[0.0, 1.0], [-k, -c]]),
        lambda k, c: (form([[1.0]]), form([[c]]), form([[k]])),
        lambda k, c: (form([[1.0]]), form([[c]]), form([[k]]), {"k": (None, None, form([[1.0]]))}),
    ]


def reusing():
    """A function that writes its answer where its last one is."""
    here = np.zeros((2, 2))

    def oscillator(k, c):
        here[:] = systems.oscillator(k, c)
        return here

    return oscillator


def frozen(k, c):
    found = systems.oscillator(k, c)
    found.setflags(write=False)
    return found


KINDS = {
    "reused": reusing(),
    "read only": frozen,
    "object": lambda k, c: systems.oscillator(k, c).astype(object),
    "Fortran": lambda k, c: np.asfortranarray(systems.oscillator(k, c)),
    "byte order": lambda k, c: systems.oscillator(k, c).astype(">f8"),
    "long double": lambda k, c: systems.oscillator(k, c).astype(np.longdouble),
    "list": lambda k, c: systems.oscillator(k, c).tolist(),
    "matrix": lambda k, c: np.asmatrix(systems.oscillator(k, c)),
    "keywords": lambda **inputs: systems.oscillator(**inputs),
    "unmasked": lambda k, c: np.ma.masked_array(systems.oscillator(k, c)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_matrices_may_be_arrays_of_any_kind(kind, built):
    assert pcc.build(pcc.Study(OSCILLATOR, KINDS[kind])) == built


def test_functions_with_a_state_of_their_own_are_seen():
    random = np.random.default_rng(1)
    with pytest.raises(pcc.RunError, match="the matrices jump or carry noise"):
        pcc.build(pcc.Study(OSCILLATOR, lambda k, c: systems.oscillator(k, c + 0.01 * random.normal())))


LATER = [
    (lambda k, c: (*system()(k, c), {"q": None}), "derivatives by q, but the inputs are k, c"),
    (lambda k, c: (*system()(k, c), {"k": np.eye(1)}), "the derivatives by k must be three matrices"),
    (lambda k, c: (np.eye(2), {"k": np.eye(3)}), "the derivative by k is 3 × 3, but the matrix 2 × 2"),
    (lambda k, c: np.eye(2 if k < 100.5 else 3) * -k, "2 × 2|3 × 3|eigenvalues at"),
    (lambda k, c: systems.oscillator(k, c + 0.1 * np.sin(1e9 * k)), "by k cannot be had by differences"),
]


@pytest.mark.parametrize("function, sentence", LATER, ids=range(len(LATER)))
def test_functions_that_fail_later(function, sentence):
    with pytest.raises(pcc.Error, match=sentence):
        pcc.build(pcc.Study(OSCILLATOR, function))


STUDIES = [
    (lambda: pcc.Study({}, systems.oscillator, answers="matrices"), "inputs"),
    (lambda: pcc.Study(["k", "c"], systems.oscillator), "inputs is no dict of laws"),
    (lambda: pcc.Study({"k": (90, 110)}, systems.oscillator), "inputs is no dict of laws"),
    (lambda: pcc.Study({"k": pcc.uniform(110, 90)}, systems.oscillator), "^inputs.k: "),
    (lambda: pcc.Study({"k": pcc.uniform(0, float("nan"))}, systems.oscillator), "^inputs.k: "),
    (lambda: pcc.Study({"k": pcc.uniform(0, object())}, systems.oscillator), "inputs.k.upper: a object"),
    (lambda: pcc.Study({"k": {"distribution": "cauchy"}}, systems.oscillator), '"cauchy"'),
    (lambda: pcc.Study({3: pcc.uniform(0, 1)}, systems.oscillator), "the name 3 is no text"),
    (lambda: pcc.Study({"k k": pcc.uniform(0, 1)}, systems.oscillator), "inputs.k k"),
    (lambda: pcc.Study(OSCILLATOR, np.eye(2)), "the model is a ndarray; give a function"),
    (lambda: pcc.Study(OSCILLATOR, (x for x in "MCK")), "the model is a generator"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, fit={"degree": 3}), "fit.degree"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, on_failure="retry"), '"retry"'),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, answers="modes"), '"modes"'),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, name="a/b"), "name"),
    (
        lambda: pcc.Study(OSCILLATOR, systems.oscillator, name=3),
        "^name = 3: invalid type: integer `3`, expected a text",
    ),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, seed=1.5), "^seed = 1.5: .*expected a whole number"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator, fit="fast"), '^fit = "fast": .*expected a table'),
    (lambda: pcc.Study({"k": pcc.uniform("90", 110)}, systems.oscillator), '^k = .*lower = "90".*expected a number'),
    (lambda: pcc.Study({"k": pcc.uniform(np.zeros(2), 110)}, systems.oscillator), "^k = .*expected a number"),
    (lambda: pcc.build("belt.toml"), "build takes a study, not a str"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator).answer(k="a", c=0.1), "takes a number for k, not 'a'"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator).answer(k=np.zeros(1), c=0.1), "takes a number for k, not array"),
    (lambda: pcc.Study(OSCILLATOR, systems.oscillator).answer(k=1.0), "takes the inputs k, c, not k"),
]


@pytest.mark.parametrize("make, sentence", STUDIES, ids=range(len(STUDIES)))
def test_studies_that_are_wrong(make, sentence):
    with pytest.raises(pcc.StudyError, match=sentence):
        make()


def test_functions_belong_to_studies_of_functions(shipped):
    with pytest.raises(pcc.Error, match='kind "clutch"'):
        pcc.Study.read(shipped / "clutch-r1.toml", model=systems.clutch)
    text = pcc.Study(OSCILLATOR, systems.oscillator).to_toml()
    with pytest.raises(pcc.RunError, match="functions of the program that reads the study"):
        pcc.build(pcc.Study.from_toml(text))


def test_functions_may_print_and_call_pcc(capsys, clutch, built):
    def talks(k, c):
        print("at", k)
        clutch.max_re([[0.1, 16e6]] * 1000)
        return systems.oscillator(k, c)

    assert pcc.build(pcc.Study(OSCILLATOR, talks)) == built
    assert "at 100.0" in capsys.readouterr().out


@pytest.mark.parametrize("jobs", [1, 2])
def test_functions_may_call_pcc_where_there_is_one_thread(jobs, shipped):
    program = textwrap.dedent(f"""
        import pcc, systems
        clutch = pcc.load({str(shipped / "clutch-r2.pcc")!r})
        def talks(k, c):
            clutch.max_re([[0.1, 16e6]] * 1000)
            return systems.oscillator(k, c)
        study = pcc.Study({{"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}}, talks)
        print(pcc.build(study, jobs={jobs}).names)
    """)
    environment = os.environ | {"RAYON_NUM_THREADS": "1"}
    here = os.path.dirname(__file__)
    child = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=here, env=environment, timeout=60
    )
    assert child.stdout == "['k', 'c']\n", child.stderr


def test_functions_run_in_the_thread_that_builds(built):
    seen = set()

    def looks(k, c):
        seen.add(threading.get_ident())
        return systems.oscillator(k, c)

    found = []
    thread = threading.Thread(target=lambda: found.append(pcc.build(pcc.Study(OSCILLATOR, looks))))
    thread.start()
    thread.join(60)
    assert found == [built] and seen == {thread.ident}


def test_threads_share_a_surrogate(clutch, points):
    expected, found = clutch.max_re(points).tolist(), [None] * 8

    def work(number):
        found[number] = [clutch.max_re(points).tolist() for _ in range(5)]

    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    [thread.start() for thread in threads]
    [thread.join(60) for thread in threads]
    assert found == [[expected] * 5] * 8


def _in_child(surrogate, points, queue):
    queue.put(surrogate.max_re(points).tolist())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_processes_have_threads_of_their_own(clutch, points):
    expected = clutch.max_re(points).tolist()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_in_child, args=(clutch, points, queue))
    child.start()
    assert queue.get(timeout=60) == expected
    child.join(60)
    assert child.exitcode == 0


def interrupted(code: str) -> str:
    """What a program says that is sent Ctrl-C once it has said "ready"."""
    # Programs that were started in the background do not listen to Ctrl-C unless they say so.
    listening = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    program = listening + "import os, time, pcc, systems\n" + textwrap.dedent(code)
    child = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        cwd=os.path.dirname(__file__),
    )  # fmt: skip
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    try:
        return child.communicate(timeout=30)[0]
    except subprocess.TimeoutExpired:
        child.kill()
        raise


def test_ctrl_c_ends_long_work(shipped):
    said = interrupted(f"""
        s = pcc.load({str(shipped / "clutch-r8.pcc")!r})
        print("ready", flush=True)
        try:
            s.sample(10**12)
        except KeyboardInterrupt:
            print("stopped")
    """)
    assert said == "stopped\n"


@pytest.mark.parametrize("jobs", [1, 2])
def test_ctrl_c_ends_builds_within_a_run(jobs):
    said = interrupted(f"""
        def slow(k, c):
            if k != 100.0:
                os.write(1, b"ready\\n")
                time.sleep({20 if jobs == 1 else 1})
            return systems.eigenvalues_of_oscillator(k, c)
        study = pcc.Study({{"k": pcc.uniform(90, 110), "c": pcc.uniform(-0.1, 0.3)}}, slow)
        try:
            pcc.build(study, jobs={jobs})
        except KeyboardInterrupt:
            print("stopped")
    """)
    assert said.endswith("stopped\n")


def test_system_exit_passes():
    def leaves(k, c):
        if c < 0.0:
            raise SystemExit(3)
        return systems.oscillator(k, c)

    with pytest.raises(SystemExit) as caught:
        pcc.build(pcc.Study(OSCILLATOR, leaves))
    assert caught.value.code == 3
