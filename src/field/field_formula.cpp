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
          word == "t" ? std::string("a formula is of the place alone; `oscillates` makes it swing in time")
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

MapNodes sampled(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) {
  MapNodes nodes{{axes.begin(), axes.end()}, {}};
  std::array<std::size_t, 3> n{};
  for (std::size_t a = 0; a < 3; ++a) n[a] = static_cast<std::size_t>(axes[a].nodes);
  nodes.field.resize(n[0] * n[1] * n[2] * 3);
  for (std::size_t m = 0; m < 3; ++m) {
    const std::string& text = formula.components[m];
    std::array<double, 3> at{axes[0].begin, axes[1].begin, axes[2].begin};
    FormulaParser parser;
    try {
      for (std::size_t a = 0; a < 3; ++a) parser.DefineVar(places[a], &at[a]);
      for (const auto& [name, value] : formula.constants) parser.DefineConst(name, value);
      parser.SetExpr(text);
      double* to = nodes.field.data() + m;
      for (std::size_t i = 0; i < n[0]; ++i)
        for (std::size_t j = 0; j < n[1]; ++j)
          for (std::size_t k = 0; k < n[2]; ++k, to += 3) {
            at = {axes[0].begin + axes[0].step * static_cast<double>(i),
                  axes[1].begin + axes[1].step * static_cast<double>(j),
                  axes[2].begin + axes[2].step * static_cast<double>(k)};
            *to = parser.Eval();
            if (std::isfinite(*to)) continue;
            throw FormulaFault(
                fmt::format("the formula has no finite value at x = {:.4g} m, y = {:.4g} m, z = {:.4g} m",
                            at[0], at[1], at[2]),
                "keep such places out of the box, or write the formula so that it is finite there");
          }
      if (parser.GetNumResults() > 1)
        throw FormulaFault("the formula has several values", "a comma stands between arguments only");
    } catch (const mu::ParserError& error) {
      FormulaFault fault = fault_of(error, text, parser);
      fault.component = m;
      throw fault;
    } catch (FormulaFault& fault) {
      fault.component = m;
      fault.length = text.size();
      throw;
    }
  }
  return nodes;
}

}  // namespace rabiline
