#include "field/field_formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/constants.hpp"
#include "core/diagnostics.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

constexpr std::array<const char*, 3> places{"x", "y", "z"};

double squared(double x) { return x * x; }
double power(double x, double y) {
  if (y == std::floor(y) && std::abs(y) <= 64) return portable::pow(x, static_cast<int>(y));
  if (x == 0) return y > 0 ? 0 : std::numeric_limits<double>::infinity();
  return x > 0 ? portable::pow(x, y) : std::numeric_limits<double>::quiet_NaN();
}
double logarithm(double x) { return x > 0 ? portable::log(x) : std::numeric_limits<double>::quiet_NaN(); }
double hyperbolic_sine(double x) { return (portable::exp(x) - portable::exp(-x)) / 2; }
double hyperbolic_cosine(double x) { return (portable::exp(x) + portable::exp(-x)) / 2; }
double hyperbolic_tangent(double x) {
  const double left = portable::exp(-2 * std::abs(x)), size = (1 - left) / (1 + left);
  return x < 0 ? -size : size;
}

/// The parser's own functions are the C library's, whose last bits hang on the processor: ours instead
/// (core/portable_math.hpp), and no assignment among the operators.
class FormulaParser : public mu::Parser {
 public:
  FormulaParser() {
    EnableBuiltInOprt(false);
    ClearFun();
    ClearConst();
    const auto take = [](double (*f)(double)) { return f; };
    for (const auto& [name, f] : {std::pair{"sin", take(&portable::sin)},
                                  {"cos", take(&portable::cos)},
                                  {"tan", take(&portable::tan)},
                                  {"asin", take(&portable::asin)},
                                  {"acos", take(&portable::acos)},
                                  {"atan", take(&portable::atan)},
                                  {"exp", take(&portable::exp)},
                                  {"erf", take(&portable::erf)},
                                  {"log", &logarithm},
                                  {"sqrt", take([](double x) { return std::sqrt(x); })},
                                  {"abs", take([](double x) { return std::abs(x); })},
                                  {"sinh", &hyperbolic_sine},
                                  {"cosh", &hyperbolic_cosine},
                                  {"tanh", &hyperbolic_tangent},
                                  {"sq", &squared}})
      DefineFun(name, f);
    using Two = double (*)(double, double);
    DefineFun("atan2", Two([](double y, double x) { return portable::atan2(y, x); }));
    DefineFun("hypot", Two([](double x, double y) { return portable::hypot(x, y); }));
    DefineFun("min", Two([](double x, double y) { return std::min(x, y); }));
    DefineFun("max", Two([](double x, double y) { return std::max(x, y); }));
    const auto binary = [&](const char* name, Two f, unsigned priority) { DefineOprt(name, f, priority); };
    binary(
        "+", [](double x, double y) { return x + y; }, mu::prADD_SUB);
    binary(
        "-", [](double x, double y) { return x - y; }, mu::prADD_SUB);
    binary(
        "*", [](double x, double y) { return x * y; }, mu::prMUL_DIV);
    binary(
        "/", [](double x, double y) { return x / y; }, mu::prMUL_DIV);
    DefineOprt("^", Two(&power), mu::prPOW, mu::oaRIGHT);
    binary(
        "<", [](double x, double y) { return x < y ? 1.0 : 0.0; }, mu::prCMP);
    binary(
        ">", [](double x, double y) { return x > y ? 1.0 : 0.0; }, mu::prCMP);
    binary(
        "&&", [](double x, double y) { return x != 0 && y != 0 ? 1.0 : 0.0; }, mu::prLAND);
    binary(
        "||", [](double x, double y) { return x != 0 || y != 0 ? 1.0 : 0.0; }, mu::prLOR);
    DefineConst("pi", std::numbers::pi);
    DefineConst("mu_0", constants::vacuum_permeability);
  }
};

std::vector<std::string> words_of(const mu::Parser& parser) {
  std::vector<std::string> words(places.begin(), places.end());
  for (const auto& [name, value] : parser.GetConst()) words.push_back(name);
  for (const auto& [name, function] : parser.GetFunDef()) words.push_back(name);
  return words;
}

/// In our words, with the place in the text.
FormulaFault fault_of(const mu::ParserError& error, const std::string& text, const mu::Parser& parser) {
  const std::string& token = error.GetToken();
  const auto told = [&](const std::string& message, std::string help) {
    FormulaFault fault(message, std::move(help));
    const std::size_t end = std::min(static_cast<std::size_t>(std::max(error.GetPos(), 0)), text.size()),
                      found = token.empty() ? text.npos : text.rfind(token, end);
    fault.from = found == text.npos ? end : found;  // the parser tells where some tokens end
    fault.length = std::max<std::size_t>(1, token.size());
    return fault;
  };
  switch (error.GetCode()) {
    case mu::ecUNASSIGNABLE_TOKEN: {
      const std::size_t from = static_cast<std::size_t>(std::max(error.GetPos(), 0));
      std::size_t end = from;
      while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
        ++end;
      const std::string word = text.substr(from, std::max<std::size_t>(1, end - from));
      FormulaFault fault(
          fmt::format("`{}` is no place, constant or function", word),
          word == "t" ? std::string("state how often the formulas repeat in time: `frequency: 10 kHz`")
          : closest(word, words_of(parser)).empty()
              ? fmt::format("places are x, y and z [m]; state it as a constant: `constants: {{{}: 1 mT}}`",
                            word)
              : fmt::format("did you mean `{}`?", closest(word, words_of(parser))));
      fault.from = from;
      fault.length = word.size();
      return fault;
    }
    case mu::ecUNEXPECTED_EOF:
    case mu::ecEMPTY_EXPRESSION:
      return told("the formula ends too soon", "write a value behind the last operator");
    case mu::ecMISSING_PARENS:
      return told("a bracket is not closed", "add `)`");
    case mu::ecUNEXPECTED_PARENS:
      return told("this bracket stands at a wrong place", "every `(` has its `)`, with a value between them");
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      return told(fmt::format("`{}` has another number of arguments", token),
                  "atan2, hypot, min and max have two, all others one");
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN:
      return told(fmt::format("an operator is missing before `{}`", token), "write `*` between factors");
    case mu::ecUNEXPECTED_OPERATOR:
      return told(fmt::format("a value is missing before `{}`", token), "write it there, or omit the sign");
    default:
      return told("the formula cannot be read here", "write it like `B0*(1 + (x/a)^2)`");
  }
}

}  // namespace

bool can_name_constant(const std::string& name) {
  const FormulaParser parser;
  const std::vector<std::string> words = words_of(parser);
  return !name.empty() && name.size() <= 64 && std::isalpha(static_cast<unsigned char>(name[0])) &&
         std::ranges::all_of(
             name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }) &&
         name != "t" && std::ranges::find(words, name) == words.end();
}

namespace {

/// Mean values over a period at 16 equal times, so that harmonics up to the seventh do not mix with those
/// that are kept.
constexpr int times = 16, kept = 2 * most_field_harmonics + 1;
/// cos(k a) of number 2 k - 1 and sin(k a) of number 2 k, at a = 2 pi f t.
double wave(int number, double angle) {
  const int k = (number + 1) / 2;
  return number % 2 == 1 ? portable::cos(k * angle) : portable::sin(k * angle);
}
/// The harmonics of one value that follows t, and by how much it differs from them at other times, a few
/// periods later.
std::array<double, kept> harmonics_of(mu::Parser& parser, double& t, double period, double& left_out) {
  std::array<double, kept> out{};
  for (int i = 0; i < times; ++i) {
    t = period * i / times;
    const double value = parser.Eval(), angle = 2 * std::numbers::pi * i / times;
    out[0] += value / times;
    for (int n = 1; n < kept; ++n) out[static_cast<std::size_t>(n)] += 2 * wave(n, angle) * value / times;
  }
  for (const double periods : {1.137, 2.447, 5.829}) {
    t = period * periods;
    double sum = out[0];
    for (int n = 1; n < kept; ++n)
      sum += out[static_cast<std::size_t>(n)] * wave(n, 2 * std::numbers::pi * periods);
    left_out = std::max(left_out, std::abs(parser.Eval() - sum));
  }
  return out;
}

double largest_of(const MapNodes& nodes) {
  double largest = 0;
  for (const double value : nodes.field) largest = std::max(largest, std::abs(value));
  return largest;
}

/// One component of all harmonics.
class Sampler {
 public:
  Sampler(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) : formula_(formula), axes_(axes) {
    for (std::size_t a = 0; a < 3; ++a) n_[a] = static_cast<std::size_t>(axes[a].nodes);
    harmonics_.push_back(empty(0));
  }

  void add(std::size_t component) {
    FormulaParser parser;
    const std::string& text = formula_.components[component];
    try {
      std::array<double, 3> at{};
      double t = 0;
      for (std::size_t a = 0; a < 3; ++a) parser.DefineVar(places[a], &at[a]);
      if (formula_.frequency > 0) parser.DefineVar("t", &t);
      for (const auto& [name, value] : formula_.constants) parser.DefineConst(name, value);
      parser.SetExpr(text);
      parser.Eval();  // complains of unknown names, which are variables for what is next
      const bool moves = parser.GetUsedVar().contains("t");
      for (int n = 1; moves && harmonics_.size() < kept; ++n) harmonics_.push_back(empty(n));
      std::size_t to = component;
      for (std::size_t i = 0; i < n_[0]; ++i)
        for (std::size_t j = 0; j < n_[1]; ++j)
          for (std::size_t k = 0; k < n_[2]; ++k, to += 3) {
            at = {axes_[0].begin + axes_[0].step * static_cast<double>(i),
                  axes_[1].begin + axes_[1].step * static_cast<double>(j),
                  axes_[2].begin + axes_[2].step * static_cast<double>(k)};
            if (!moves) {
              put(0, to, parser.Eval(), at);
              continue;
            }
            const auto values = harmonics_of(parser, t, 1 / formula_.frequency, left_out_);
            for (std::size_t n = 0; n < kept; ++n) put(n, to, values[n], at);
          }
      if (parser.GetNumResults() > 1)
        throw FormulaFault("the formula has several values", "a comma stands between arguments only");
    } catch (const mu::ParserError& error) {
      FormulaFault fault = fault_of(error, text, parser);
      fault.component = component;
      throw fault;
    } catch (FormulaFault& fault) {
      fault.component = component;
      fault.length = text.size();
      throw;
    }
  }

  std::vector<FieldHarmonic> result() {
    double largest = 0;
    for (const FieldHarmonic& harmonic : harmonics_) largest = std::max(largest, largest_of(harmonic.nodes));
    const auto fault = [](const char* message, std::string help) {
      FormulaFault out(message, std::move(help));
      out.component = 3;
      return out;
    };
    if (formula_.frequency > 0 && harmonics_.size() == 1)
      throw fault("no component has t: the field stands", "omit `frequency`, or write `t` [s] where it acts");
    if (!(left_out_ <= 1e-6 * largest))
      throw fault(
          "the formulas do not repeat with this frequency in four harmonics",
          "state that of their slowest part; `cos(2*pi*f*t)` repeats with f, its square with 2*f or f");
    std::erase_if(harmonics_, [&](const FieldHarmonic& h) { return largest_of(h.nodes) <= 1e-12 * largest; });
    if (harmonics_.empty()) harmonics_.push_back(empty(0));
    return std::move(harmonics_);
  }

 private:
  FieldHarmonic empty(int number) const {
    FieldHarmonic out{(number + 1) / 2, number > 0 && number % 2 == 0, {{axes_.begin(), axes_.end()}, {}}};
    out.nodes.field.resize(n_[0] * n_[1] * n_[2] * 3);
    return out;
  }
  void put(std::size_t harmonic, std::size_t to, double value, const std::array<double, 3>& at) {
    if (!std::isfinite(value))
      throw FormulaFault(
          fmt::format("the formula has no finite value at x = {:.4g} m, y = {:.4g} m, z = {:.4g} m", at[0],
                      at[1], at[2]),
          "keep such places out of the box, or write the formula so that it is finite there");
    harmonics_[harmonic].nodes.field[to] = value;
  }

  const FieldFormula& formula_;
  const std::array<MapAxis, 3>& axes_;
  std::array<std::size_t, 3> n_{};
  std::vector<FieldHarmonic> harmonics_;
  double left_out_ = 0;  // [T]
};

}  // namespace

std::vector<FieldHarmonic> sampled(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) {
  Sampler sampler(formula, axes);
  for (std::size_t component = 0; component < 3; ++component) sampler.add(component);
  return sampler.result();
}

}  // namespace rabiline
