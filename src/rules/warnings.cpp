#include "rules/warnings.hpp"

#include <algorithm>

#include "plan/explain.hpp"
#include "plan/explain_laws.hpp"
#include "rules/field_lint.hpp"
#include "rules/fringe_warnings.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

bool is_same(const Fault& a, const Fault& b) { return a.subject == b.subject && a.key == b.key; }

void add_once(const Faults& from, Faults& out) {
  for (const Fault& fault : from)
    if (std::none_of(out.begin(), out.end(), [&](const Fault& other) {
          return is_same(fault, other) && fault.message == other.message;
        }))
      out.push_back(fault);
}

/// Those of the first point or the last that every other one has too, but for points that they do not
/// concern.
Faults at_every_point(const ScanPoints& points, Faults (*find)(const Beamline&),
                      bool (*concerns)(const Beamline&, const Fault&)) {
  Faults out = find(points.front());
  for (Fault& fault : find(points[points.size() - 1]))
    if (std::ranges::none_of(out, [&](const Fault& other) { return is_same(fault, other); }))
      out.push_back(std::move(fault));
  for (const Beamline& point : points) {
    if (out.empty()) break;
    const Faults here = find(point);
    std::erase_if(out, [&](const Fault& fault) {
      return concerns(point, fault) &&
             std::ranges::none_of(here, [&](const Fault& other) { return is_same(fault, other); });
    });
  }
  return out;
}
bool is_always_asked(const Beamline&, const Fault&) { return true; }

/// Those of any of some hundred points between the first and the last, each where it is worst.
Faults at_any_point(const ScanPoints& points, Faults (*find)(const Beamline&)) {
  constexpr std::size_t most = 128;
  Faults out;
  const std::size_t step = points.size() / most + 1;
  for (std::size_t i = 0; i < points.size() + step - 1; i += step)
    for (Fault& fault : find(points[std::min(i, points.size() - 1)])) {
      const auto known = std::ranges::find_if(out, [&](const Fault& other) { return is_same(fault, other); });
      if (known == out.end())
        out.push_back(std::move(fault));
      else if (fault.badness > known->badness)
        *known = std::move(fault);
    }
  return out;
}

}  // namespace

std::vector<Fault> warnings_of(const Experiment& experiment, const Plan& plan) {
  Faults out;
  add_once(at_every_point(experiment.points, &blunders_of, &is_always_asked), out);
  add_once(at_every_point(experiment.points, &idle_drives_of, &is_driven), out);
  for (Fault& fault : missed_resonances_of(experiment.points))
    if (std::ranges::none_of(out, [&](const Fault& other) { return is_same(fault, other); }))
      out.push_back(std::move(fault));
  add_once(at_every_point(experiment.points, &endless_turns_of, &is_driven), out);
  add_once(at_every_point(experiment.points, &nuclei_among_atoms_of, &is_deflected), out);
  add_once(at_any_point(experiment.points, &absurd_numbers_of), out);
  add_once(at_any_point(experiment.points, &impossible_magnets_of), out);
  add_once(at_any_point(experiment.points, &zeros_of_magnets_of), out);
  add_once(at_any_point(experiment.points, &turned_magnets_of), out);
  add_once(at_any_point(experiment.points, &jumps_of_sorting_fields_of), out);
  add_once(warnings_of_stages(experiment, plan), out);
  add_once(at_any_point(experiment.points, &odd_fringes_of), out);
  add_once(at_any_point(experiment.points, &approximations_of), out);
  add_once(untold_falls_of(experiment.points.front()), out);
  add_once(unpulsed_choppers_of(experiment.points.front()), out);
  add_once(line_warnings_of(experiment, plan), out);
  add_once(warnings_of_laws(experiment), out);
  add_once(warnings_of_fields(experiment.points.front()), out);
  add_once(warnings_of_fringes(experiment.points.front(), plan), out);
  return out;
}

}  // namespace rabiline
