#include "models/faults.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace rabiline {

std::optional<Fault> fault_of_species(std::string_view kind, const std::vector<Component>& species) {
  if (species.size() != 1)
    return Fault{"model", "species",
                 fmt::format("the model `{}` has one particle, and here a mixture of species stands", kind),
                 "write one species"};
  if (species.front().species.structure)
    return Fault{"model", "species",
                 fmt::format("`{}` has levels, but this model needs a particle with one moment",
                             species.front().species.name),
                 "write a species without levels, such as `proton`"};
  return std::nullopt;
}

void refuse(const std::vector<Fault>& faults) {
  if (!faults.empty()) throw std::invalid_argument(faults.front().message);
}

}  // namespace rabiline
