// Must not compile: a stage that does not say what it costs (StageKind).
#include "transport/stage_concept.hpp"

namespace rabiline {

struct Forgetful {
  bool operator==(const Forgetful&) const = default;
  static constexpr StageTraits traits{};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Forgetful>);

}  // namespace rabiline
