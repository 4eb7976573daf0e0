// Commands of the Python package: the program becomes Python.
#include <array>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "commands/common.hpp"
#include "commands/stop.hpp"

namespace rabiline {
namespace {

struct PackageVerb {
  const char *name, *help;
};
constexpr std::array package_verbs{
    PackageVerb{"new", "write a starter file for an experiment"},
    PackageVerb{"draw", "the apparatus to scale, with a few paths, before a run"},
    PackageVerb{"plot", "the picture that fits a file"},
    PackageVerb{"plot-scan", "curves of scans"},
    PackageVerb{"plot-levels", "populations of the spin levels over a scan"},
    PackageVerb{"plot-image", "a detector's images"},
    PackageVerb{"plot-profiles", "profiles on a detector"},
    PackageVerb{"plot-tally", "a tally"},
    PackageVerb{"plot-angles", "angles of the spin along the beam"},
    PackageVerb{"plot-transit", "times of flight to a detector"},
    PackageVerb{"plot-tracks", "paths of single particles"},
    PackageVerb{"plot-motion", "motions of a model, or its findings"},
    PackageVerb{"plot-field", "the field along a line"},
    PackageVerb{"summary", "what a file holds, in words"},
    PackageVerb{"export", "the numbers of a scan as CSV"},
    PackageVerb{"compare", "whether two results of one scan agree"},
    PackageVerb{"compare-scans", "the same"},
    PackageVerb{"compare-laws", "how well counts tell laws apart"},
    PackageVerb{"bound-kappa", "the kappa that counts allow"},
    PackageVerb{"fit", "parameters of an experiment from measured counts"},
    PackageVerb{"fit-line", "a closed form of a line to a result or to measured counts"},
    PackageVerb{"forecast", "how well a measurement will know parameters"},
};

/// Beside the program in a build; below the prefix where it is installed.
std::filesystem::path package_folder() {
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const std::filesystem::path& folder : {here / "python", here.parent_path() / RABILINE_PYTHON_FOLDER})
    if (std::filesystem::exists(folder / "rabiline" / "__init__.py")) return folder;
  throw ArgumentError(
      fmt::format("the Python package `rabiline` is not beside {}\n  help: install the program "
                  "with `cmake --install`, or call python3 -m rabiline",
                  here.string()));
}

}  // namespace

void add_package_verbs(CLI::App& app) {
  for (const PackageVerb& verb : package_verbs) app.add_subcommand(verb.name, verb.help)->group("Python");
}

bool is_of_the_package(const std::string& verb) {
  for (const PackageVerb& known : package_verbs)
    if (verb == known.name) return true;
  return false;
}

void start_package(const std::vector<std::string>& arguments) {
  const char* const before = std::getenv("PYTHONPATH");
  const std::string path =
      package_folder().string() + (before != nullptr && *before != '\0' ? fmt::format(":{}", before) : "");
  setenv("PYTHONPATH", path.c_str(), 1);
  // What would keep this Python from starting.
  unsetenv("PYTHONHOME");
  if (const char* const encoding = std::getenv("PYTHONIOENCODING");
      encoding != nullptr && strncasecmp(encoding, "utf", 3) != 0)
    unsetenv("PYTHONIOENCODING");
  struct stat input {};
  if (fstat(STDIN_FILENO, &input) == 0 && S_ISDIR(input.st_mode))
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  setenv("PYTHONSAFEPATH", "1", 1);  // else a `csv.py` in the current folder would be run for Python's own
  std::vector<std::string> words{RABILINE_PYTHON, "-m", "rabiline"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  hold_back_signals();  // until Python has started, which would tell of them in its own way
  execv(pointers.front(), pointers.data());
  throw ArgumentError(fmt::format("{}: {}", RABILINE_PYTHON, std::strerror(errno)));
}

}  // namespace rabiline
