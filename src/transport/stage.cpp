#include "transport/stage.hpp"

#include "transport/paths.hpp"

namespace rabiline {

const StageTraits& traits_of(const Stage& stage) {
  return std::visit([](const auto& s) -> const StageTraits& { return s.traits; }, stage);
}
std::size_t sums_needed(const Stage& stage) {
  return std::visit([](const auto& s) { return s.sums(); }, stage);
}
void advance(const Stage& stage, StageContext& context) {
  std::visit([&](const auto& s) { s.pass(context); }, stage);
}
void list_sums(const Stage& stage, SumSink& sink) {
  std::visit([&](const auto& s) { s.list_sums(sink); }, stage);
}
double place_of(const Stage& stage) {
  return std::visit([](const auto& s) { return s.y(); }, stage);
}
double cost_of(const Stage& stage, double speed) {
  return std::visit([&](const auto& s) { return s.cost(speed); }, stage);
}
void explain(const Stage& stage, PlanReport& report) {
  std::visit([&](const auto& s) { s.explain(report); }, stage);
}
bool follows_paths(const Stage& stage) {
  return std::visit([](const auto& s) { return s.follows_paths(); }, stage);
}

const SpinPath* path_of(const Stage& stage) {
  return std::visit(
      [](const auto& s) -> const SpinPath* {
        if constexpr (requires { s.path(); }) return s.path();
        return nullptr;
      },
      stage);
}
Stage with_path(Stage stage, const SpinPath& path) {
  std::visit(
      [&](auto& s) {
        if constexpr (requires { s.spins = path; }) s.spins = path;
      },
      stage);
  return stage;
}
int part_of(const Stage& stage) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.part; }) return s.part;
        return no_part;
      },
      stage);
}
bool splits(const Stage& stage) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.splits(); }) return s.splits();
        return false;
      },
      stage);
}
double counted_share(const Stage& stage) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.counted_share(); }) return s.counted_share();
        return 1.0;
      },
      stage);
}
int catches(const Stage& stage) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.catches(); }) return s.catches();
        return no_part;
      },
      stage);
}
int reads_catch_of(const Stage& stage) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.reads_catch_of(); }) return s.reads_catch_of();
        return no_part;
      },
      stage);
}
std::unique_ptr<PathTally> tally_paths(const Stage& stage) {
  return std::visit(
      [](const auto& s) -> std::unique_ptr<PathTally> {
        if constexpr (requires { s.tally_paths(); }) return s.tally_paths();
        return nullptr;
      },
      stage);
}
std::size_t own_memory(const Stage& stage) {
  return std::visit(
      [](const auto& s) -> std::size_t {
        if constexpr (requires { s.own_memory(); }) return s.own_memory();
        return 0;
      },
      stage);
}

}  // namespace rabiline
