#include "field/formula_parser.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/diagnostics.hpp"
#include "core/portable_math.hpp"
#include "core/units.hpp"

namespace rabiline {
namespace {

constexpr std::array<const char*, 3> places{"x", "y", "z"};
constexpr double largest_value =
    1e30;  // that a formula comes to, in SI: what is worked out with it stays finite

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
mu::Parser formula_parser() {
  mu::Parser out;
  out.EnableBuiltInOprt(false);
  out.ClearFun();
  out.ClearConst();
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
    out.DefineFun(name, f);
  using Two = double (*)(double, double);
  out.DefineFun("atan2", Two([](double y, double x) { return portable::atan2(y, x); }));
  out.DefineFun("hypot", Two([](double x, double y) { return portable::hypot(x, y); }));
  out.DefineFun("min", Two([](double x, double y) { return std::min(x, y); }));
  out.DefineFun("max", Two([](double x, double y) { return std::max(x, y); }));
  const auto binary = [&](const char* name, Two f, unsigned priority) { out.DefineOprt(name, f, priority); };
  binary(
      "+", [](double x, double y) { return x + y; }, mu::prADD_SUB);
  binary(
      "-", [](double x, double y) { return x - y; }, mu::prADD_SUB);
  binary(
      "*", [](double x, double y) { return x * y; }, mu::prMUL_DIV);
  binary(
      "/", [](double x, double y) { return x / y; }, mu::prMUL_DIV);
  out.DefineOprt("^", Two(&power), mu::prPOW, mu::oaRIGHT);
  binary(
      "<", [](double x, double y) { return x < y ? 1.0 : 0.0; }, mu::prCMP);
  binary(
      ">", [](double x, double y) { return x > y ? 1.0 : 0.0; }, mu::prCMP);
  binary(
      "&&", [](double x, double y) { return x != 0 && y != 0 ? 1.0 : 0.0; }, mu::prLAND);
  binary(
      "||", [](double x, double y) { return x != 0 || y != 0 ? 1.0 : 0.0; }, mu::prLOR);
  out.DefineConst("pi", std::numbers::pi);
  out.DefineConst("mu_0", constants::vacuum_permeability);
  return out;
}

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
      const auto goes_on = [&](std::size_t i) {
        return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
      };
      if (end == from && end < text.size())
        for (++end; end < text.size() && goes_on(end);)
          ++end;  // all of a character that is no letter of ASCII
      const std::string word = text.substr(from, end - from);
      FormulaFault fault(
          fmt::format("`{}` is not a place, a constant or a function", word),
          word == "t"
              ? std::string(
                    "state how often the formulas repeat in time, `frequency: 10 kHz`, or how long they "
                    "are worked out, `duration: 5 ms`")
          : closest(word, words_of(parser)).empty()
              ? word == "*"        ? std::string("a power is written `^`: `t^2`")
                : word == "\u2212" ? std::string("a minus is written `-`")
                : parse_quantity("1 " + word).error.empty()
                    ? fmt::format(
                          "a unit stands with a constant: `constants: {{a: 1 {}}}`; formulas have numbers "
                          "in m, s and T",
                          word)
                    : fmt::format("places are x, y and z [m]; state it as a constant, with the unit "
                                  "that it has: `constants: {{{}: 1 mT}}`",
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
  const mu::Parser parser = formula_parser();
  const std::vector<std::string> words = words_of(parser);
  return !name.empty() && name.size() <= 64 && std::isalpha(static_cast<unsigned char>(name[0])) &&
         std::ranges::all_of(
             name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }) &&
         name != "t" && std::ranges::find(words, name) == words.end();
}

struct FormulaComponent::Parser {
  mu::Parser read = formula_parser();
  std::size_t component = 0;
  std::string text;
  std::array<double, 3> place{};
  double t = 0;

  /// The same fault, of this component.
  FormulaFault own(FormulaFault fault) const {
    fault.component = component;
    return fault;
  }
  FormulaFault of_all(const std::string& message, std::string help) const {
    FormulaFault fault(message, std::move(help));
    fault.length = text.size();
    return own(std::move(fault));
  }
};

FormulaComponent::FormulaComponent(const FieldFormula& formula, std::size_t component)
    : parser_(std::make_unique<Parser>()) {
  Parser& parser = *parser_;
  parser.component = component;
  parser.text = formula.components[component];
  try {
    for (std::size_t a = 0; a < 3; ++a) parser.read.DefineVar(places[a], &parser.place[a]);
    if (formula.moves()) parser.read.DefineVar("t", &parser.t);
    for (const auto& [name, value] : formula.constants) parser.read.DefineConst(name, value);
    parser.read.SetExpr(parser.text);
    parser.read.Eval();  // complains of unknown names, which are variables for what is next
    if (parser.read.GetNumResults() > 1)
      throw parser.of_all("the formula has several values", "a comma stands between arguments only");
  } catch (const mu::ParserError& error) {
    throw parser.own(fault_of(error, parser.text, parser.read));
  }
}
FormulaComponent::~FormulaComponent() = default;

bool FormulaComponent::moves() const { return parser_->read.GetUsedVar().contains("t"); }

double FormulaComponent::at(const std::array<double, 3>& place, double t) {
  parser_->place = place;
  parser_->t = t;
  const double value = parser_->read.Eval();
  if (!(std::abs(value) <= largest_value))
    throw parser_->of_all(fmt::format("the formula has no finite value, or one beyond {:g}, at x = {:.4g} m, "
                                      "y = {:.4g} m, z = {:.4g} m",
                                      largest_value, place[0], place[1], place[2]),
                          "keep such places out of the box, or write the formula so that it is finite there");
  return value;
}

std::string formula_parser_version() { return "muParser " + mu::Parser().GetVersion(mu::pviBRIEF); }

}  // namespace rabiline
