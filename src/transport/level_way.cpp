#include "transport/level_way.hpp"

#include <fmt/format.h>

#include "transport/cost.hpp"

namespace rabiline {

LevelWay::LevelWay(LevelFields fields, std::shared_ptr<const LevelTable> table)
    : fields_(std::move(fields)), table_(std::move(table)) {
  course_.manifolds = table_->manifolds().data();
  course_.manifold_of = table_->manifold_of().data();
  course_.place_of = table_->place_of().data();
  course_.sections = fields_.sections.data();
  course_.count = static_cast<int>(fields_.sections.size());
  course_.shaped = fields_.shaped.data();
  course_.begins_in_field = fields_.begins_in_field;
  course_.ends_in_field = fields_.ends_in_field;
  course_.tolerance = 0.2 * fields_.tolerance;  // errors of steps add up
}

std::uint64_t LevelWay::reach(int level) const {
  const std::vector<int>& manifold = table_->manifold_of();
  std::uint64_t bits = 0;
  for (std::size_t to = 0; to < manifold.size(); ++to)
    if (manifold[to] == manifold[static_cast<std::size_t>(level)]) bits |= std::uint64_t{1} << to;
  return bits;
}

double LevelWay::cost() const {
  constexpr double steps = 100;  // in a field that turns
  double sum = 0;
  for (const LevelManifold& manifold : table_->manifolds())
    sum += static_cast<double>(manifold.levels * manifold.levels) /
           static_cast<double>(table_->manifold_of().size());
  return static_cast<double>(fields_.sections.size()) * steps *
         (8 * cost::shaped_field * static_cast<double>(fields_.shaped.size()) +
          60 * cost::operation * 40 * sum);
}

std::string describe(const LevelWay& way) {
  const LevelFields& fields = way.fields();
  return fmt::format(
      "coherent through whole fields of any direction from {:.4g} to {:.4g} m, by their amplitudes in "
      "steps to {:.2g}{}",
      fields.sections.front().field.begin, fields.sections.back().field.end, fields.tolerance,
      way.table().manifolds().size() > 1 ? "; F far apart exchange nothing" : "");
}

}  // namespace rabiline
