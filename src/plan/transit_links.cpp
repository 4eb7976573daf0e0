#include "plan/transit_links.hpp"

#include <algorithm>

#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// What a stage keeps; its bins are those of what it lists.
class LinkMaker : public SumSink {
 public:
  LinkMaker(const Stage& stage, std::size_t outcomes) {
    link.outcomes = outcomes;
    link.ends = !traits_of(stage).only_reads;
    link.counted = counted_share(stage);
    list_sums(stage, *this);
  }
  TransitLink link;

 private:
  void fate(std::string_view, int, std::size_t) override {}
  void screen(int part, const ScreenSums& layout, std::size_t at) override {
    link.part = part;
    link.bins = layout.bins();
    link.columns = layout.columns;
    link.rows = layout.rows;
    link.first_bin = at + ScreenSums::bin(0);
    link.total = at + layout.total();
    link.groups = at + layout.group(0);
  }
  void plane(int part, int plane, std::size_t at) override {
    link.part = part;
    link.plane = plane;
    link.bins = 1;
    link.first_bin = at + CensusSums::total();
    link.groups = at + CensusSums::group(0);
  }
  void histogram(int part, int, int plane, const HistogramSums& layout, std::size_t at) override {
    link.part = part;
    link.plane = plane;
    link.bins = layout.bins + 1;
    link.axes = layout.axes;
    link.first_bin = at + HistogramSums::bin(0);
  }
};

/// Whether that screen or plane counts in all what the stage divides.
bool counts_whole(const TransitLink& of, const Stage& stage, const TransitLink& link) {
  const int caught = reads_catch_of(stage);
  if (caught != no_part) return of.is_screen() && of.part == caught;
  return !of.ends && of.groups && of.part == link.part && of.plane == link.plane;
}

}  // namespace

std::optional<std::vector<TransitLink>> links_behind(const PlanNode& projection, std::string_view& why_not) {
  std::vector<TransitLink> links;
  auto outcomes = static_cast<std::size_t>(path_of(projection.stage)->outcomes());
  for (const PlanNode* node = &projection; !node->next.empty();) {
    node = &node->next.front();
    why_not = "levels are found once more behind it";
    if (traits_of(node->stage).spins == SpinEffect::set) return {};
    if (traits_of(node->stage).counts_levels && !path_of(node->stage)->keeps_levels()) return {};
    TransitLink link = LinkMaker(node->stage, outcomes).link;
    link.whole = links.size();
    if (traits_of(node->stage).only_reads && !link.groups) {
      const auto whole = std::find_if(links.begin(), links.end(), [&](const TransitLink& of) {
        return counts_whole(of, node->stage, link);
      });
      why_not = "what was caught in front of it is asked for behind it";
      if (whole == links.end()) return {};
      link.whole = static_cast<std::size_t>(whole - links.begin());
      link.counted = whole->counted;
    }
    if (const auto* stop = std::get_if<FilterStop>(&node->stage))
      outcomes = static_cast<std::size_t>(stop->outcome);
    links.push_back(link);
  }
  return links;
}

bool reads_earlier_catch(const Stage& stage, const PlanNode& projection) {
  const int part = reads_catch_of(stage);
  if (part == no_part) return false;
  for (const PlanNode* node = &projection; !node->next.empty();) {
    node = &node->next.front();
    if (catches(node->stage) == part) return false;
  }
  return true;
}

}  // namespace rabiline
