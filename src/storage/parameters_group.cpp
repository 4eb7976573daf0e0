#include "storage/parameters_group.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline::nexus {

void write_parameters(const hdf5::GroupWriter& entry, const std::vector<ResolvedParameter>& parameters) {
  const hdf5::GroupWriter group = entry.group("parameters", "NXcollection");
  group.attribute(
      "meaning",
      "every parameter as it was flown, defaults included, in SI: those that all scan points share are "
      "listed, a value or a word each; `scanned` has the others, over the points, row-major");
  std::vector<std::string> names, units, words;
  std::vector<double> values;
  const hdf5::GroupWriter scanned = group.group("scanned", "NXcollection");
  for (const ResolvedParameter& parameter : parameters) {
    if (parameter.values.size() > 1) {
      const bool is_number = std::ranges::any_of(parameter.values, [](double x) { return !std::isnan(x); });
      if (is_number)
        scanned.dataset(parameter.name, {parameter.values.size()}, parameter.values,
                        {{"units", parameter.unit.empty() ? "1" : parameter.unit}});
      else
        scanned.dataset(parameter.name, {parameter.words.size()}, parameter.words);
      continue;
    }
    names.push_back(parameter.name);
    units.push_back(parameter.unit);
    values.push_back(parameter.values.front());
    words.push_back(parameter.words.front());
  }
  group.dataset("name", {names.size()}, names, {{"long_name", "as --set calls it"}});
  group.dataset("value", {values.size()}, values, {{"long_name", "in SI; NaN for a word"}});
  group.dataset("unit", {units.size()}, units, {{"long_name", "of SI; empty for a plain number"}});
  group.dataset("word", {words.size()}, words, {{"long_name", "empty for a number"}});
}

}  // namespace rabiline::nexus
