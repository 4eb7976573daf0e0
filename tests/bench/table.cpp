#include "bench/table.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rabiline::bench {

bool Table::ReportContext(const Context& context) {
  PrintBasicContext(&GetErrorStream(), context);
  return true;
}

void Table::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs)
    if (run.run_type == Run::RT_Iteration && !run.error_occurred)
      rates_[run.run_name.function_name].push_back(run.counters.at("items_per_second").value);
}

void Table::Finalize() {
  fmt::print("{:<74} {:>10} {:>10} {:>7} {:>6} {:>6}\n", "medians", "limit /s", "program /s", "ratio", "must",
             "aim");
  for (const Row& row : rows_) {
    if (!rates_.contains(row.program)) continue;
    const double program = median_rate(row.program) * row.in_one;
    if (!rates_.contains(row.limit)) {
      fmt::print("{:<74} {:>10} {:>10.3g}\n", row.work, "-", program);
      continue;
    }
    const double limit = median_rate(row.limit) * row.in_one;
    fmt::print("{:<74} {:>10.3g} {:>10.3g} {:>7.3f}", row.work, limit, program, program / limit);
    if (row.must > 0) fmt::print(" {:>6.2g} {:>6.2g}", row.must, row.aim);
    fmt::print("\n");
  }
}

double Table::median_rate(const std::string& name) const {
  std::vector<double> rates = rates_.at(name);
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return *middle;
}

}  // namespace rabiline::bench
