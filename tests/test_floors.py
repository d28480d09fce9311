"""The shape of the code: what may import what, and what every public name must tell its reader."""

import ast
import importlib
import importlib.metadata
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import engine
import sweeps

ROOT = Path(__file__).parents[1]
PACKAGES = ("engine", "sweeps")
FILES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
}
# What mechanics needs no more than arithmetic does.
NOT_IN_ENGINE = ("sweeps", "h5py", "matplotlib", "click", "tqdm", "tomllib", "tomli_w", "xarray", "csv", "argparse")
# Of these, other packages load the standard library's for themselves.
STANDARD = ("csv", "argparse", "tomllib")


@cache
def tree_of(module: str) -> ast.Module:
    return ast.parse(FILES[module].read_text(encoding="utf8"))


def type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)


def imports_in(node: ast.Module, module: str, typed: bool = False) -> set[str]:
    """Modules imported by a piece of code, inside functions too; `typed`: also those for type checkers alone."""
    found, pending = set(used_of_rooms(node)), [node]
    while pending:
        for child in ast.iter_child_nodes(pending.pop()):
            if type_checking(child) and not typed:
                continue
            if isinstance(child, ast.Import):
                found.update(alias.name for alias in child.names)
            elif isinstance(child, ast.ImportFrom):
                found.update(imported(child, module))
            elif not isinstance(child, ast.expr):
                pending.append(child)
    return found


@cache
def used_of_rooms(tree: ast.Module) -> frozenset[str]:
    """Modules that rooms load on use: `mechanism.friction.rubbing_pairs` after `from engine import mechanism`.

    What is chosen by its name, as in `getattr(mechanism.groups, name)`, may be any module of the room.
    """
    rooms = {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if is_room(f"{node.module}.{alias.name}")
    }
    if not rooms:
        return frozenset()

    def module_of(node: ast.AST) -> str:
        if isinstance(node, ast.Name):
            return rooms.get(node.id, "")
        return f"{module_of(node.value)}.{node.attr}" if isinstance(node, ast.Attribute) else ""

    found = {module_of(node) for node in ast.walk(tree) if isinstance(node, ast.Attribute)} & set(FILES)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "getattr" and is_room(module_of(node.args[0])):
            found.update(name for name in FILES if name.rpartition(".")[0] == module_of(node.args[0]))
    return frozenset(found)


def is_room(module: str) -> bool:
    return module in FILES and FILES[module].name == "__init__.py"


def imported(node: ast.ImportFrom, module: str) -> set[str]:
    """Modules that a from-import loads: a name is a module where there is a file of that name."""
    base = node.module or ""
    if node.level:
        package = module if FILES[module].name == "__init__.py" else module.rpartition(".")[0]
        above = package.split(".")[: len(package.split(".")) - node.level + 1]
        base = ".".join([*above, *([node.module] if node.module else [])])
    within = {f"{base}.{alias.name}" for alias in node.names} & set(FILES)
    # `from engine import jit` needs the module jit; what else the package itself gathers is not needed for it.
    return within if within and len(within) == len(node.names) else within | {base}


@cache
def imports(typed: bool = False) -> dict[str, set[str]]:
    """What each module imports."""
    return {module: imports_in(tree_of(module), module, typed) for module in FILES}


def test_engine__imports_neither_sweeps_nor_files_nor_pictures():
    engine_only = {
        m: {name.split(".")[0] for name in found} for m, found in imports().items() if m.startswith("engine")
    }
    assert {m: found for m, found in engine_only.items() if found.intersection(NOT_IN_ENGINE)} == {}


def test_private_parts_of_the_compiler__are_used_in_compiling_alone():
    private = ("numba.core", "numba.extending", "llvmlite")
    others = {m: found for m, found in imports().items() if m.startswith("engine.") and "compiling" not in m}
    assert {m: found for m, found in others.items() if any(name.startswith(private) for name in found)} == {}


def test_engine_alone__loads_without_what_only_sweeps_needs():
    code = f"import sys, engine; print([m for m in {NOT_IN_ENGINE!r} if m in sys.modules and m not in {STANDARD!r}])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, "[]"), done.stderr


def graph(typed: bool = False) -> dict[str, set[str]]:
    return {m: {n for n in found if n in FILES and n != m} for m, found in imports(typed).items()}


@pytest.mark.parametrize("package", PACKAGES)
def test_imports__run_one_way(package):
    """Every module can be put below all that import it, be it inside functions or for its types alone."""
    left = {
        m: {n for n in needs if n.startswith(package)}
        for m, needs in graph(typed=True).items()
        if m.startswith(package)
    }
    while left:
        ground = [m for m, needs in left.items() if not needs & set(left)]
        assert ground, f"these import each other in a circle: {circle(left)}"
        for module in ground:
            del left[module]


def circle(left: dict[str, set[str]]) -> str:
    path = [min(left)]
    while path[-1] not in path[:-1]:
        path.append(min(left[path[-1]] & set(left)))
    return " -> ".join(path[path.index(path[-1]) :])


def test_circle_finder__sees_a_circle():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == "b -> c -> b"


SLOW = ("numba", "numpy", "scipy", "pydantic", "h5py", "matplotlib")


@pytest.mark.parametrize(
    "start",
    [
        "import engine",
        "import sweeps",
        "import sweeps.cli",
        "from sweeps.cli import main; main(['list'])",
        "from sweeps.cli import main; main(['run', '--help'])",
        "from sweeps.cli import main; main(['run', '--unknown'])",
    ],
)
def test_start__loads_nothing_slow(start):
    code = f"import sys\ntry:\n {start}\nexcept SystemExit:\n pass\nprint([m for m in {SLOW!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "[]")


# What a slider-crank needs

SLIDER_CRANK = """
import sys, tomllib
from pathlib import Path
from engine import Machine, Scene
scene = Scene.model_validate(tomllib.loads(Path("sweeps/templates/linkages/slider_crank.toml").read_text("utf8")))
Machine(scene, ["piston.stroke"]).evaluate({})
print(*(module for module in sys.modules if module.partition(".")[0] == "engine"))
"""
# Of about 380; it may fall, and grows only for what every machine needs.
MOST_FOR_A_SLIDER_CRANK = 147
# All elements start from `element` and its `panels`; of a room that loads on use there is the room itself.
NOT_FOR_A_SLIDER_CRANK = (
    r"engine\.elements\.(?!element$|panels$)",
    r"engine\.(motion|stepping)\.",
    r"engine\.mechanism\.(friction|higher_pairs)",
    r"engine\.mechanism\.actions\.(?!characteristics$|paths$)",
    r"engine\.mechanism\.groups\.(?!rrp$)",
    r"engine\.machine\.(balancing|drives|one_machine)",
    r"engine\.laws\.(cams|governors)",
)


def test_slider_crank__loads_no_chapter_that_it_has_not():
    done = subprocess.run([sys.executable, "-c", SLIDER_CRANK], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    loaded = done.stdout.split()
    assert [m for m in loaded if re.match("|".join(NOT_FOR_A_SLIDER_CRANK), m)] == []
    assert len(loaded) <= MOST_FOR_A_SLIDER_CRANK, "\n".join(sorted(loaded))


def test_room__loads_its_modules_on_use_and_has_no_others():
    code = "import sys; from engine import mechanism; before = 'engine.mechanism.vectors' in sys.modules; "
    code += "print(before, mechanism.vectors.Vector.__name__, hasattr(mechanism, 'vektors'))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout.strip()) == (0, "False Vector False"), done.stderr


def test_finder_of_imports__sees_what_rooms_load_on_use():
    tree = ast.parse("from engine import mechanism\nmechanism.friction.Rub\ngetattr(mechanism.groups, name).add_dyad")
    found = imports_in(tree, "engine.machine.machine")
    assert {"engine.mechanism.friction", "engine.mechanism.groups.rrp", "engine.mechanism.groups.free"} <= found
    assert "engine.mechanism.inertia" not in found


# The engine's door


def test_names_at_the_door__are_those_of_their_modules():
    for package in (engine, sweeps):
        for name in package.__all__:
            assert getattr(package, name) is not None
    assert engine.Scene is importlib.import_module("engine.scene.scene").Scene
    assert engine.v_engine is importlib.import_module("engine.elements.engines.engine_layout").v_engine


def test_version__is_that_of_the_package():
    assert engine.__version__ == importlib.metadata.version("machine-sweeps")
    assert all((ROOT / package / "py.typed").exists() for package in PACKAGES)


def test_name_that_the_engine_does_not_offer__is_no_attribute():
    with pytest.raises(AttributeError, match="no attribute 'Sceen'"):
        engine.Sceen  # noqa: B018


def test_sweeps__uses_the_engine_through_its_door_only():
    passed_by = [
        (module, ast.unparse(node))
        for module in FILES
        if module.startswith("sweeps")
        for node in ast.walk(tree_of(module))
        if (isinstance(node, ast.ImportFrom) and (node.module or "").startswith("engine."))
        or (isinstance(node, ast.Import) and any(alias.name.startswith("engine.") for alias in node.names))
    ]
    assert passed_by == []


@pytest.mark.parametrize("package", [engine, sweeps])
def test_door__offers_nothing_under_two_names(package):
    stub = ast.parse(Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf8"))
    offered = [(node.module, a.name) for node in stub.body if isinstance(node, ast.ImportFrom) for a in node.names]
    assert len(set(offered)) == len(offered) == len(package.__all__)


# Rooms

# Each may use those before it in its package.
ENGINE_ROOMS = (
    "compiling",
    "words",
    "units",
    "laws",
    "graph",
    "cycle",
    "stepping",
    "parts",
    "elements",
    "scene",
    "mechanism",
    "quantities",
    "motion",
    "warnings",
    "machine",
)
SWEEPS_ROOMS = (
    "text",
    "synthesis",
    "imports",
    "guide",
    "store",
    "study",
    "run",
    "report",
    "optimising",
    "pictures",
    "page",
    "python",
    "cli",
)
# Files and folders that one look takes in.
MOST_IN_A_ROOM = 15


@pytest.mark.parametrize(("package", "rooms"), [("engine", ENGINE_ROOMS), ("sweeps", SWEEPS_ROOMS)])
def test_rooms__use_only_those_before_them(package, rooms):
    wrong = []
    for module, needs in graph(typed=True).items():
        parts = module.split(".")
        if parts[0] != package or len(parts) < 2 or parts[1].startswith("__"):
            continue
        later = tuple(f"{package}.{room}" for room in rooms[rooms.index(parts[1]) + 1 :])
        wrong += [f"{module} -> {n}" for n in needs if n.startswith(later)]
    assert wrong == []


def test_rooms__hold_no_more_than_can_be_taken_in():
    entries: dict[Path, set[str]] = {}
    for part in (*PACKAGES, "tests"):
        for path in (ROOT / part).rglob("*.*"):
            if path.is_file() and path.suffix in (".py", ".toml", ".md", ".csv", ".json", ".svg"):
                for entry in (path, *path.parents):
                    if entry == ROOT / part:
                        break
                    entries.setdefault(entry.parent, set()).add(entry.name)
    held = {str(f.relative_to(ROOT)): len({n for n in names if n[:2] != "__"}) for f, names in entries.items()}
    assert {room: count for room, count in held.items() if count > MOST_IN_A_ROOM} == {}


# What is public, and what it says

Definition = ast.FunctionDef | ast.ClassDef


def public(node: ast.AST, prefix: str) -> list[tuple[str, Definition, bool]]:
    """Public functions, classes and methods: name, definition, whether it is a method."""
    found = []
    for child in getattr(node, "body", []):
        if isinstance(child, (ast.FunctionDef, ast.ClassDef)) and not child.name.startswith("_"):
            found.append((f"{prefix}.{child.name}", child, isinstance(node, ast.ClassDef)))
            if isinstance(child, ast.ClassDef):
                found += public(child, f"{prefix}.{child.name}")
    return found


@cache
def everything_public() -> list[tuple[str, Definition, bool]]:
    return [entry for module in FILES for entry in public(tree_of(module), module)]


def decorators(node: Definition) -> set[str]:
    return {ast.unparse(d).split("(")[0] for d in node.decorator_list}


def arguments(node: ast.FunctionDef) -> list[ast.arg]:
    a = node.args
    return [*a.posonlyargs, *a.args, *([a.vararg] if a.vararg else []), *a.kwonlyargs, *([a.kwarg] if a.kwarg else [])]


SECTIONS = ("Parameters", "Attributes", "Returns", "Yields", "Raises", "Notes", "Examples", "References", "See Also")


def section(doc: str, title: str) -> str:
    """Text of a section of a numpydoc docstring."""
    others = "|".join(SECTIONS)
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^(?:{others})\n-+\n|\Z)", doc, re.M | re.S)
    return found[1] if found else ""


def named(doc: str, title: str) -> list[str]:
    """Names that a section describes; several may share a line."""
    heads = re.findall(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: :.*)?$", section(doc, title), re.M)
    return [name.lstrip("*") for head in heads for name in head.split(", ")]


def parameters_of(node: Definition) -> set[str]:
    """Names that may be passed to a function or a class."""
    if isinstance(node, ast.FunctionDef):
        return {a.arg for a in arguments(node)}
    constructors = [c for c in node.body if isinstance(c, ast.FunctionDef) and c.name == "__init__"]
    fields = {c.target.id for c in node.body if isinstance(c, ast.AnnAssign) and isinstance(c.target, ast.Name)}
    return fields.union(*({a.arg for a in arguments(c)} for c in constructors))


def test_described_parameters__exist():
    """That there are docstrings and annotations, linters see to."""
    assert len(everything_public()) > 200
    wrong = []
    for name, node, _ in everything_public():
        described = named(ast.get_docstring(node) or "", "Parameters")
        wrong += [f"{name}: {p}" for p in described if p not in parameters_of(node)]
    assert wrong == []


# Each chapter of the quantities declares its own, under the one name that the register calls; each dyad has its motion
# and its statics, under those that mechanisms call. Roots and the maximum or minimum of some numbers are the same
# algebra twice: of measured values, and of expressions that are yet to be measured.
SHARED = {"add_dyad", "declare", "maximum", "minimum", "sqrt"}


def test_public_names__are_given_once():
    places: dict[str, list[str]] = {}
    for module in FILES:
        for name, _, method in public(tree_of(module), module):
            if not method and name.rpartition(".")[0] == module:
                places.setdefault(name.rpartition(".")[2], []).append(module)
    twice = {name: modules for name, modules in places.items() if len(modules) > 1}
    assert {name: modules for name, modules in twice.items() if name not in SHARED} == {}
    assert SHARED - set(twice) == set(), "these are given once by now: take them off the list"


def test_methods__are_defined_once():
    # The later one would take the place of the earlier one; Python says nothing, nor do linters of private names.
    for module in FILES:
        for kind in (node for node in ast.walk(tree_of(module)) if isinstance(node, ast.ClassDef)):
            names = [f"{part.name} {decorators(part)}" for part in kind.body if isinstance(part, ast.FunctionDef)]
            assert len(names) == len(set(names)), f"{module}.{kind.name}: {names}"


def test_parameters__are_described_all_or_not_at_all():
    wrong = []
    for name, node, _ in everything_public():
        described = set(named(ast.get_docstring(node) or "", "Parameters"))
        if described and isinstance(node, ast.FunctionDef):
            missing = parameters_of(node) - described - {"self", "cls"}
            wrong += [f"{name}: {p}" for p in sorted(missing)]
    assert wrong == []


def test_described_attributes__exist():
    wrong = []
    for name, node, _ in everything_public():
        described = named(ast.get_docstring(node) or "", "Attributes")
        text = ast.unparse(node)
        wrong += [f"{name}: {p}" for p in described if not re.search(rf"\b{p}\b", text.split('"""', 2)[-1])]
    assert wrong == []


def test_finder_of_names__reads_a_docstring():
    doc = "Sum.\n\nParameters\n----------\na, b : float\n    Two.\n*rest\n    More.\n\nReturns\n-------\nfloat\n"
    assert named(doc, "Parameters") == ["a", "b", "rest"]
    assert named(doc, "Attributes") == []
