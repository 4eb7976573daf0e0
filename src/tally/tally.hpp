#pragma once
// A histogram that a user wants of what crosses a plane.
#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "core/unit_vector.hpp"
#include "parameter/parameter.hpp"
#include "tally/quantity.hpp"

namespace rabiline {

template <>
inline constexpr auto choices<Quantity> = [] {
  std::array<Choice<Quantity>, std::size(quantity_rows)> all{};
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = {quantity_rows[i].word, quantity_rows[i].quantity, quantity_rows[i].meaning};
  return all;
}();
constexpr std::string_view word_of(Quantity q) { return row_of(q).word; }

/// One end of an axis, in SI; its unit follows the quantity.
struct AxisEnd {
  double value = 0;
  bool operator==(const AxisEnd&) const = default;
};
inline constexpr std::uint64_t most_tally_bins = 1'000'000;  // of one tally
inline constexpr std::size_t most_tally_axes = 3;
inline constexpr Range tally_bins{1, static_cast<double>(most_tally_bins), true, true, "from 1 to 1000000"};

struct TallyAxis {
  Quantity quantity = Quantity::x;
  std::optional<AxisEnd> from, to;    // none of a categorical quantity
  std::optional<std::uint64_t> bins;  // likewise
  std::optional<UnitVector> axis;     // of `spin` only
  bool operator==(const TallyAxis&) const = default;
};
template <>
inline constexpr auto parameters<TallyAxis> = std::tuple{
    param("quantity", &TallyAxis::quantity, "what the axis is over"),
    param("from", &TallyAxis::from, "where the axis begins, in the unit of the quantity; not of levels"),
    param("to", &TallyAxis::to, "where it ends; this end belongs to the last bin"),
    param("bins", &TallyAxis::bins, Dimension::number, tally_bins,
          "how many; those of all axes multiply to at most 1000000"),
    param("axis", &TallyAxis::axis, "direction that `spin` is projected on, and of nothing else"),
};

struct Tally {
  std::string name;
  std::vector<TallyAxis> axes;
  bool operator==(const Tally&) const = default;
};
template <>
inline constexpr auto parameters<Tally> = std::tuple{
    param("name", &Tally::name, "results call it by the part's name, `_` and this name"),
    param("axes", &Tally::axes, "one to three axes"),
};
/// The default of a list of tallies.
struct NoTallies {
  operator std::vector<Tally>() const { return {}; }
};

}  // namespace rabiline
