#include "field/field_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/units.hpp"
#include "field/host_maths.hpp"

namespace rabiline {
namespace {

using Here = FieldHere<double>;

/// Coefficients c[-1..n] of the cubic B-spline through f[0..n), whose fourth differences vanish next to the
/// ends
/// ("not a knot"): c[i-1] + 4 c[i] + c[i+1] = 6 f[i], and c[1], c[n-2] at once. All with one stride.
void find_coefficients(const std::vector<double>& f, std::vector<double>& work, double* c,
                       std::size_t stride) {
  const std::size_t n = f.size();
  const auto at = [&](std::size_t i) -> double& { return c[(i + 1) * stride]; };
  at(1) = (8 * f[1] - f[0] - f[2]) / 6;
  at(n - 2) = (8 * f[n - 2] - f[n - 1] - f[n - 3]) / 6;
  work[1] = 0;
  for (std::size_t i = 2; i + 2 < n; ++i) {
    work[i] = 1 / (4 - work[i - 1]);
    const double known = i + 3 == n ? at(n - 2) : 0;
    at(i) = work[i] * (6 * f[i] - at(i - 1) - known);
  }
  for (std::size_t i = n - 3; i > 1; --i)
    if (i + 3 < n) at(i) -= work[i] * at(i + 1);
  at(0) = 6 * f[1] - 4 * at(1) - at(2);
  c[0] = 6 * f[0] - 4 * at(0) - at(1);
  at(n - 1) = 6 * f[n - 2] - 4 * at(n - 2) - at(n - 3);
  at(n) = 6 * f[n - 1] - 4 * at(n - 1) - at(n - 2);
}

}  // namespace

std::vector<double> spline_coefficients(const std::vector<double>& values) {
  std::vector<double> work(values.size()), out(values.size() + 2);
  find_coefficients(values, work, out.data(), 1);
  return out;
}

namespace {

/// The number of numbers at each node of a table: of three components, a fourth is unused.
std::size_t per_node(std::size_t axes) { return axes == 3 ? 4 : 2; }
std::size_t components(std::size_t axes) { return axes; }

/// Nodes of an axis that begins or ends at zero, with those behind the plane. `sign` of each component there.
void mirror(MapNodes& nodes, std::size_t axis, const std::array<double, 3>& sign) {
  MapAxis& along = nodes.axes[axis];
  const bool begins = std::abs(along.begin) < std::abs(along.end());
  const auto n = static_cast<std::size_t>(along.nodes), whole = 2 * n - 1;
  const std::size_t m = components(nodes.axes.size());
  std::size_t inner = m, outer = 1;
  for (std::size_t a = axis + 1; a < nodes.axes.size(); ++a)
    inner *= static_cast<std::size_t>(nodes.axes[a].nodes);
  for (std::size_t a = 0; a < axis; ++a) outer *= static_cast<std::size_t>(nodes.axes[a].nodes);
  std::vector<double> field(outer * whole * inner);
  for (std::size_t o = 0; o < outer; ++o)
    for (std::size_t i = 0; i < whole; ++i) {
      const bool behind = begins ? i + 1 < n : i >= n;
      const std::size_t from = begins ? (i + 1 < n ? n - 1 - i : i + 1 - n) : (i >= n ? whole - 1 - i : i);
      for (std::size_t k = 0; k < inner; ++k)
        field[(o * whole + i) * inner + k] =
            (behind ? sign[k % m] : 1.0) * nodes.field[(o * n + from) * inner + k];
    }
  const double far = begins ? along.end() : -along.begin;
  along = {static_cast<int>(whole), -far, along.step};
  nodes.field = std::move(field);
}

Here at(const FieldMap& map, const std::array<double, 3>& place) {
  return map.is_round() ? field_of<HostMaths>(map.round_shape(1, MapOutside::clamp), place[0], 0.0, place[1])
                        : field_of<HostMaths>(map.shape(1, MapOutside::clamp), place[0], place[1], place[2]);
}
double size_of(const Here& here) {
  return std::sqrt(here.field[0] * here.field[0] + here.field[1] * here.field[1] +
                   here.field[2] * here.field[2]);
}

/// Calls visit(place) at up to some hundred thousand of the places first + i step, i from 0 to count - 1
/// along each axis; of a field about an axis, where r is positive.
template <class Visit>
void for_some_places(const FieldMap& map, double shift, int less, Visit visit) {
  constexpr double most = 1e5;
  double total = 1;
  for (const MapAxis& axis : map.axes()) total *= axis.nodes - less;
  const auto stride = static_cast<std::size_t>(std::ceil(total / most)) | 1;
  for (std::size_t n = 0; n < static_cast<std::size_t>(total); n += stride) {
    std::array<double, 3> place{};
    std::array<std::size_t, 3> index{};
    std::size_t rest = n;
    for (std::size_t a = map.axes().size(); a-- > 0;) {
      const MapAxis& axis = map.axes()[a];
      const auto count = static_cast<std::size_t>(axis.nodes - less);
      index[a] = rest % count;
      rest /= count;
      place[a] = axis.begin + axis.step * (static_cast<double>(index[a]) + shift);
    }
    if (!map.is_round() || place[0] > 0) visit(place, index);
  }
}

class SpreadSum {
 public:
  void add(double x) {
    largest_ = std::max(largest_, std::abs(x));
    squares_ += x * x;
    ++count_;
  }
  Spread over(double unit) const {
    if (count_ == 0 || unit == 0) return {};
    return {largest_ / unit, std::sqrt(squares_ / static_cast<double>(count_)) / unit};
  }

 private:
  double largest_ = 0, squares_ = 0;
  std::size_t count_ = 0;
};

/// How far the map of every second node is off at the nodes between.
SpreadSum difference(const FieldMap& map, const FieldMap& half) {
  SpreadSum sum;
  for_some_places(map, 0, 0,
                  [&](const std::array<double, 3>& place, const std::array<std::size_t, 3>& index) {
                    if ((index[0] | index[1] | index[2]) % 2 == 0) return;
                    for (std::size_t a = 0; a < half.axes().size(); ++a)
                      if (place[a] > half.axes()[a].end() + half.axes()[a].step / 4) return;
                    const Here fine = at(map, place), coarse = at(half, place);
                    Here d{};
                    for (int i = 0; i < 3; ++i) d.field[i] = fine.field[i] - coarse.field[i];
                    sum.add(size_of(d));
                  });
  return sum;
}

/// Which of the steps is the odd one.
std::string different_steps(const std::vector<double>& places, std::string_view name) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < places.size(); ++i) steps.push_back(places[i] - places[i - 1]);
  std::vector<double> sorted = steps;
  std::ranges::sort(sorted);
  const double usual = sorted[sorted.size() / 2];
  const auto odd = static_cast<std::size_t>(
      std::ranges::max_element(steps, {}, [&](double step) { return std::abs(step - usual); }) -
      steps.begin());
  const auto metres = [](double x) { return fmt::format("{:.9g} mm", 1e3 * x); };
  return fmt::format("the steps along {} differ: from {} to {} it is {}, elsewhere {}", name,
                     metres(places[odd]), metres(places[odd + 1]), metres(steps[odd]), metres(usual));
}

}  // namespace

std::optional<MapAxis> even_axis(const std::vector<double>& places, std::string_view name, std::string& why) {
  const auto metres = [](double x) { return pretty_quantity(x, Dimension::length); };
  constexpr std::size_t most = 100000;
  if (places.size() < 3 || places.size() > most)
    return why = fmt::format("there {} along {}, but a map has 4 or more",
                             places.size() == 1 ? "is 1 place" : fmt::format("are {} places", places.size()),
                             name),
           std::nullopt;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (!(places[i] > places[i - 1]))
      return why = fmt::format("the places along {} do not ascend: {} follows {}", name, metres(places[i]),
                               metres(places[i - 1])),
             std::nullopt;
  const MapAxis axis{static_cast<int>(places.size()), places.front(),
                     (places.back() - places.front()) / static_cast<double>(places.size() - 1)};
  if (constexpr double longest = 1e60; !(axis.step >= 1 / longest && axis.step <= longest))
    return why = fmt::format("the places along {} stand {} apart", name, metres(axis.step)), std::nullopt;
  for (std::size_t i = 1; i < places.size(); ++i)
    if (std::abs(places[i] - axis.begin - axis.step * static_cast<double>(i)) > 1e-6 * axis.step)
      return why = different_steps(places, name), std::nullopt;
  return axis;
}

FieldMap::FieldMap(MapNodes nodes, const std::array<MapSymmetry, 3>& symmetry, std::string path)
    : path_(std::move(path)), electric_(nodes.electric) {
  const std::size_t count = nodes.axes.size(), m = components(count), width = per_node(count);
  if (count == 2 && nodes.axes[0].begin == 0) mirror(nodes, 0, {-1, 1, 0});  // B_r is odd in r, B_z even
  for (std::size_t a = count == 2 ? 1 : 0; a < count; ++a) {
    const MapSymmetry plane = symmetry[count == 2 ? 2 : a];
    if (plane == MapSymmetry::none) continue;
    const double along =
        plane == MapSymmetry::same_currents || plane == MapSymmetry::opposite_charges ? -1 : 1;
    std::array<double, 3> sign{along, along, along};
    sign[a] = -along;
    mirror(nodes, a, sign);
  }
  axes_ = nodes.axes;
  // Nodes into the table, shifted by one; then a sweep along each axis, over the edges of those before.
  std::array<std::size_t, 3> n{1, 1, 1}, stride{0, 0, 0};
  std::size_t size = width;
  for (std::size_t a = count; a-- > 0;) {
    n[a] = static_cast<std::size_t>(axes_[a].nodes);
    stride[a] = size;
    size *= n[a] + 2;
  }
  table_.assign(size + 16, 0);
  std::size_t from = 0;
  for (std::size_t i = 0; i < n[0]; ++i)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t k = 0; k < n[2]; ++k)
        for (std::size_t c = 0; c < m; ++c, ++from) {
          const std::size_t last = count == 3 ? (k + 1) * stride[2] : 0;
          table_[(i + 1) * stride[0] + (j + 1) * stride[1] + last + c] = nodes.field[from];
        }
  nodes.field = {};
  for (std::size_t a = 0; a < count; ++a) {
    std::vector<double> line(n[a]), work(n[a]);
    for (std::size_t start = 0; start + stride[a] * (n[a] + 1) < size; ++start) {
      if ((start / stride[a]) % (n[a] + 2) != 0 || start % width >= m) continue;
      for (std::size_t i = 0; i < n[a]; ++i) line[i] = table_[start + (i + 1) * stride[a]];
      find_coefficients(line, work, &table_[start], stride[a]);
    }
  }
}

MapShape FieldMap::shape(double factor, MapOutside outside) const {
  MapShape shape{table_.data(), {}, {}, {}, factor, outside};
  for (std::size_t a = 0; a < 3; ++a) {
    shape.nodes[a] = axes_[a].nodes;
    shape.begin[a] = axes_[a].begin;
    shape.scale[a] = 1 / axes_[a].step;
  }
  return shape;
}

RoundMapShape FieldMap::round_shape(double factor, MapOutside outside) const {
  RoundMapShape shape{table_.data(), {}, {}, {}, factor, outside};
  for (std::size_t a = 0; a < 2; ++a) {
    shape.nodes[a] = axes_[a].nodes;
    shape.begin[a] = axes_[a].begin;
    shape.scale[a] = 1 / axes_[a].step;
  }
  return shape;
}

bool FieldMap::can_be_halved() const {
  return std::all_of(axes_.begin(), axes_.end(), [](const MapAxis& axis) { return axis.nodes >= 7; });
}

FieldMap FieldMap::halved() const {
  MapNodes nodes;
  std::array<std::size_t, 3> n{1, 1, 1};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    nodes.axes.push_back({(axes_[a].nodes + 1) / 2, axes_[a].begin, 2 * axes_[a].step});
    n[a] = static_cast<std::size_t>(nodes.axes[a].nodes);
  }
  for (std::size_t i = 0; i < n[0]; ++i)
    for (std::size_t j = 0; j < n[1]; ++j)
      for (std::size_t k = 0; k < n[2]; ++k) {
        std::array<double, 3> place{};
        const std::size_t index[] = {i, j, k};
        for (std::size_t a = 0; a < axes_.size(); ++a)
          place[a] = axes_[a].begin + 2 * axes_[a].step * static_cast<double>(index[a]);
        const double side = is_round() && place[0] < 0 ? -1 : 1;  // B_x is B_r where x is r
        place[0] *= side;
        const Here here = at(*this, place);
        if (is_round())
          nodes.field.insert(nodes.field.end(), {side * here.field[0], here.field[2]});
        else
          nodes.field.insert(nodes.field.end(), here.field, here.field + 3);
      }
  return {std::move(nodes), {}, path_};
}

MapQuality quality_of(const FieldMap& map) {
  MapQuality out;
  for_some_places(map, 0, 0, [&](const std::array<double, 3>& place, const std::array<std::size_t, 3>&) {
    out.largest_field = std::max(out.largest_field, size_of(at(map, place)));
  });
  double step = 0;
  for (const MapAxis& axis : map.axes()) step = std::max(step, axis.step);
  SpreadSum divergence, curl;
  for_some_places(map, 0.5, 1, [&](const std::array<double, 3>& place, const std::array<std::size_t, 3>&) {
    const Here f = at(map, place);
    const double x = f.slope[7] - f.slope[5], y = f.slope[2] - f.slope[6], z = f.slope[3] - f.slope[1];
    divergence.add(f.slope[0] + f.slope[4] + f.slope[8]);
    curl.add(std::sqrt(x * x + y * y + z * z));
  });
  out.divergence = divergence.over(out.largest_field / step);
  out.curl = curl.over(out.largest_field / step);
  if (!map.can_be_halved()) return out;
  out.halved = true;
  const FieldMap half = map.halved();
  const Spread fine = difference(map, half).over(out.largest_field);
  out.error = {fine.largest / 16, fine.rms / 16};
  if (!half.can_be_halved()) return out;
  const Spread coarse = difference(half, half.halved()).over(out.largest_field);
  if (fine.rms > 1e-14 && coarse.rms < 4 * fine.rms) {
    out.noisy = true;
    out.error = fine;
  }
  return out;
}

}  // namespace rabiline
