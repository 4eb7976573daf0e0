"""The folders of src see only those above them; files stay short; nothing points out of the tree."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ("core parameter field spin particle tally section parts beamline transport plan rules simulation models storage input "
          "scan manual face commands python").split()
SOURCES = [path for path in sorted((ROOT / "src").rglob("*")) if path.suffix in (".hpp", ".cpp", ".in")]
FACE = "rabiline.hpp"  # what folder face promises, beside the folders
LONGEST = 400  # lines of a file


def includes(path: Path) -> list[str]:
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(), re.MULTILINE)


def layer(path: Path) -> str:
    first = path.relative_to(ROOT / "src").parts[0]
    return "face" if first == FACE else first


def test_a_folder_includes_only_folders_above_it() -> None:
    assert {layer(path) for path in SOURCES} <= set(LAYERS)
    wrong = []
    for path in SOURCES:
        allowed = LAYERS[:LAYERS.index(layer(path)) + 1]
        for name in includes(path):
            folder = "face" if name == FACE else name.split("/")[0]
            if folder in LAYERS and ("/" in name or name == FACE) and folder not in allowed:
                wrong.append(f"{path.relative_to(ROOT)} includes {name}")
    assert not wrong, "\n".join(wrong)


def test_only_input_sees_yaml_and_only_storage_sees_hdf5() -> None:
    wrong = [f"{path.relative_to(ROOT)} includes {name}" for path in SOURCES for name in includes(path)
             if (name.startswith("yaml-cpp/") and layer(path) != "input")
             or (re.match(r"(hdf5|H5\w+)\.h", name) and layer(path) != "storage")]
    assert not wrong, "\n".join(wrong)


def test_numbers_of_a_run_come_from_functions_with_the_same_bits_everywhere() -> None:
    """The C library's differ between processors; square roots, rounding and their like do not."""
    functions = ("sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 expm1 log log2 log10 log1p pow cbrt "
                 "hypot erf erfc tgamma lgamma polar arg").split()
    names = "|".join(functions)
    library, bare = re.compile(rf"\bstd::(?:{names})\s*\("), re.compile(rf"(?<![\w:.>])(?:{names})\s*\(")
    wrong = []
    for path in SOURCES:
        if layer(path) in ("input", "scan", "manual", "commands") or path.stem in ("lanes", "portable_math"):  # texts, and the functions
            continue
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = re.sub(r'"(?:\\.|[^"\\])*"', '""', line).split("//")[0]
            if library.search(code) or (layer(path) != "transport" and bare.search(code)):  # kernels call those of the lanes
                wrong.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    assert not wrong, "\n".join(["use core/portable_math.hpp:", *wrong])


def test_no_two_headers_define_a_type_of_one_name() -> None:
    """For the linker they would be one, and the functions of a vector of one would serve the other."""
    defined: dict[str, list[str]] = {}
    for path in SOURCES:
        text = path.read_text()
        if path.suffix == ".hpp" and re.search(r"^namespace rabiline {", text, re.MULTILINE):
            for name in re.findall(r"^(?:struct|class|enum class) (\w+)(?: final)?\s*(?::[^;{]*)?{", text, re.MULTILINE):
                defined.setdefault(name, []).append(str(path.relative_to(ROOT)))
    assert len(defined) > 300 and not {name: files for name, files in defined.items() if len(files) > 1}


def test_no_file_is_long() -> None:
    files = SOURCES + sorted(path for folder in ("analysis", "tests") for path in (ROOT / folder).rglob("*.py"))
    long = {str(path.relative_to(ROOT)): lines for path in files
            if (lines := path.read_text().count("\n")) > LONGEST}
    assert not long, long


def test_no_text_points_out_of_the_tree() -> None:
    foreign = re.compile(r"(?<![\w./:-])/(?:home|root|work|mnt|srv|Users)/\w")
    files = [path for path in ROOT.rglob("*") if path.is_file()
             and not {".git", "build", "results"} & set(path.relative_to(ROOT).parts)
             and path.suffix not in (".h5", ".checkpoint", ".pyc", ".png")]
    wrong = [f"{path.relative_to(ROOT)}:{number}: {line.strip()}" for path in files
             for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1) if foreign.search(line)]
    assert not wrong, "\n".join(wrong)
