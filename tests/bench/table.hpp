#pragma once
// From repetitions to ratios.
#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace rabiline::bench {

/// Two benchmarks by name, and what the second should reach of the first.
struct Row {
  std::string work, limit, program;
  double must = 0, aim = 0;  // 0: shown for information only
  double in_one = 1;         // items of what is shown in one that was timed
};

/// Collects every repetition's rate and prints a table of medians at the end.
class Table : public benchmark::BenchmarkReporter {
 public:
  explicit Table(std::vector<Row> rows) : rows_(std::move(rows)) {}
  bool ReportContext(const Context&) override;
  void ReportRuns(const std::vector<Run>&) override;
  void Finalize() override;

 private:
  double median_rate(const std::string& name) const;

  std::vector<Row> rows_;
  std::map<std::string, std::vector<double>> rates_;
};

}  // namespace rabiline::bench
