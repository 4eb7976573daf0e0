// What a scan must have for the precision that is wanted of it.
#include "rules/room.hpp"
#include "rules/rules.hpp"

namespace rabiline {
namespace {

/// A slope needs neighbours, and a line a baseline; of more points the covariance is not known.
constexpr std::size_t fewest_points = 5, most_points = 2048;

std::optional<Fault> fault_of_centre(const ScannedQuantity& wanted, const std::vector<ScanAxis>& axes) {
  const auto fault = [](std::string message, std::string help) {
    return Fault{"until", "centre_error", std::move(message), std::move(help)};
  };
  if (axes.size() != 1 || !axes.front().dimension)
    return fault(fmt::format("`centre_error` asks for the place of a line along one scanned number, but {}",
                             axes.empty()       ? "nothing is scanned"
                             : axes.size() == 1 ? fmt::format("`{}` is scanned", axes.front().parameter)
                                                : fmt::format("{} parameters are scanned", axes.size())),
                 "scan one number, or omit `centre_error`");
  const ScanAxis& axis = axes.front();
  if (wanted.dimension != *axis.dimension)
    return fault(fmt::format("`centre_error` is {}, but `{}` is scanned, which is {}",
                             with_article(name_of(wanted.dimension)), axis.parameter,
                             with_article(name_of(*axis.dimension))),
                 fmt::format("give it as {}, such as `{}`", with_article(name_of(*axis.dimension)),
                             example_of(*axis.dimension)));
  if (axis.values.size() < fewest_points || axis.values.size() > most_points)
    return fault(fmt::format("`centre_error` needs from {} to {} scan points, but there are {}",
                             fewest_points, most_points, axis.values.size()),
                 "scan that many, or omit `centre_error`");
  return std::nullopt;
}

}  // namespace

std::vector<Fault> faults_of_scan(const Experiment& experiment) {
  const std::optional<Until>& until = experiment.points.front().until;
  if (!until) return {};
  if (!until->detected_error && !until->centre_error)
    return {{"until", "", "`until` does not say which precision is enough",
             "write it like `until: {detected_error: 0.1 %}`"}};
  if (!until->centre_error) return {};
  const std::optional<Fault> fault = fault_of_centre(*until->centre_error, experiment.axes);
  return fault ? Faults{*fault} : Faults{};
}

}  // namespace rabiline
