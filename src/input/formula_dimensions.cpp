#include "input/formula_dimensions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>

namespace rabiline {
namespace {

/// Powers of m, T, s, A and K, with kg = T s^2 A; nothing of what may be of any kind.
using Powers = std::array<double, 5>;
using FormulaKind = std::optional<Powers>;
constexpr Powers pure{};

/// In the order of Dimension.
constexpr std::array<Powers, static_cast<std::size_t>(last_dimension) + 1> powers{{
    {},               // number
    {1},              // length
    {0, 0, 1},        // time
    {1, 0, -1},       // speed
    {0, 1, 2, 1},     // mass
    {0, 0, 1, 1},     // charge
    {0, 1},           // magnetic_field
    {0, 0, -1},       // frequency
    {},               // angle
    {0, -1, -1},      // gyromagnetic
    {0, 0, 0, 0, 1},  // temperature
    {2, 1, 0, 1},     // energy
    {0, 0, -1},       // rate
    {-1, 1},          // field_gradient
    {0, 0, 0, 1},     // current
    {2, 1, 0, 1},     // torque
    {1, 1, -1},       // electric_field
    {2},              // area
    {-3},             // number_density
    {-1, 1, 0, 1},    // pressure
    {1, 0, -2},       // acceleration
    {-1},             // angle_per_length
    {-1},             // per_length
    {1, 0, 1, 1},     // electric_dipole
}};
constexpr Powers vacuum_permeability{1, 1, 0, -1};
Powers powers_of(Dimension d) { return powers[static_cast<std::size_t>(d)]; }

/// "a magnetic field", or "something in m T" of what has no name.
std::string told(const Powers& of) {
  if (const auto known = std::ranges::find(powers, of); known != powers.end())
    return with_article(name_of(static_cast<Dimension>(known - powers.begin())));
  constexpr std::array<const char*, 5> units{"m", "T", "s", "A", "K"};
  std::string out = "something in";
  for (std::size_t i = 0; i < units.size(); ++i)
    if (of[i] != 0)
      out += of[i] == 1 ? fmt::format(" {}", units[i]) : fmt::format(" {}^{:g}", units[i], of[i]);
  return out;
}

FormulaKind product(const FormulaKind& a, const FormulaKind& b, double power) {
  if (!a || !b) return {};
  Powers out = *a;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += power * (*b)[i];
  return out;
}

/// By recursive descent. Formulas that compare are not read, and taken for right.
class FormulaReader {
 public:
  FormulaReader(const std::string& text, const std::map<std::string, Dimension>& constants)
      : text_(text), constants_(constants) {}

  std::optional<FormulaMisfit> misfit(Dimension wanted) {
    const FormulaKind kind = sum();
    skip();
    if (at_ < text_.size()) return {};  // it compares
    if (kind && *kind != powers_of(wanted))
      note(fmt::format("the formula is {}, not {}", told(*kind), with_article(name_of(wanted))), 0,
           text_.size());
    return misfit_;
  }

 private:
  void note(std::string message, std::size_t from, std::size_t length) {
    if (!misfit_) misfit_ = {std::move(message), from, length};
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool take(std::string_view sign) {
    skip();
    if (text_.compare(at_, sign.size(), sign) != 0) return false;
    at_ += sign.size();
    return true;
  }
  /// Of what must be of one kind; beside a number, only what is pure tells the kind of both.
  FormulaKind alike(const FormulaKind& a, const FormulaKind& b, std::string_view between, std::size_t where) {
    if (a && b && *a != *b)
      note(fmt::format("`{}` stands between {} and {}", between, told(*a), told(*b)), where, between.size());
    return a == b || a == pure ? a : b == pure ? b : FormulaKind{};
  }

  FormulaKind sum() {
    FormulaKind out = factors();
    while (take("+") || take("-")) {
      const std::size_t where = at_ - 1;
      out = alike(out, factors(), text_.substr(where, 1), where);
    }
    return out;
  }
  FormulaKind factors() {
    FormulaKind out = power();
    for (;;)
      if (take("*"))
        out = product(out, power(), 1);
      else if (take("/"))
        out = product(out, power(), -1);
      else
        return out;
  }
  /// A number that begins here; nothing where there is none.
  std::optional<double> number() {
    skip();
    if (at_ == text_.size() || std::string_view("0123456789.").find(text_[at_]) == std::string_view::npos)
      return {};
    char* end = nullptr;
    const double out = std::strtod(text_.c_str() + at_, &end);
    at_ = static_cast<std::size_t>(end - text_.c_str());
    return out;
  }
  FormulaKind power() {
    if (take("-") || take("+")) return power();
    const FormulaKind base = value();
    if (!take("^")) return base;
    const double sign = take("-") ? -1 : 1;
    if (const std::optional<double> exponent = number()) return product(pure, base, sign * *exponent);
    power();
    return base == pure ? base : FormulaKind{};
  }
  FormulaKind value() {
    if (take("(")) {
      const FormulaKind out = sum();
      take(")");
      return out;
    }
    if (number()) return {};
    const std::size_t from = at_;
    while (at_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_'))
      ++at_;
    const std::string word = text_.substr(from, at_ - from);
    if (take("(")) return call(word, from);
    if (const auto known = constants_.find(word); known != constants_.end())
      return known->second == Dimension::number ? FormulaKind{} : powers_of(known->second);
    if (word == "mu_0") return vacuum_permeability;
    return word == "pi" ? pure : powers_of(word == "t" ? Dimension::time : Dimension::length);
  }
  FormulaKind call(const std::string& name, std::size_t from) {
    FormulaKind out = sum();
    while (take(",")) out = alike(out, sum(), name, from);
    take(")");
    if (name == "abs" || name == "min" || name == "max" || name == "hypot") return out;
    if (name == "atan2") return pure;
    if (name == "sq" || name == "sqrt") return product(pure, out, name == "sq" ? 2 : 0.5);
    if (out && *out != pure)
      note(fmt::format("`{}` is taken of {}, not of a pure number", name, told(*out)), from, name.size());
    return pure;
  }

  const std::string& text_;
  const std::map<std::string, Dimension>& constants_;
  std::size_t at_ = 0;
  std::optional<FormulaMisfit> misfit_;
};

}  // namespace

std::optional<FormulaMisfit> misfit_of(const std::string& formula,
                                       const std::map<std::string, Dimension>& constants, Dimension wanted) {
  return FormulaReader(formula, constants).misfit(wanted);
}

}  // namespace rabiline
