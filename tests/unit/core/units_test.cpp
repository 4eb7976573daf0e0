#include "core/units.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/spelling.hpp"
#include "particle/species.hpp"

namespace rabiline::units_test {
namespace {

using testing::HasSubstr;

double value_of(std::string_view text) {
  const ParsedQuantity parsed = parse_quantity(text);
  EXPECT_EQ(parsed.error, "") << text;
  return parsed.value;
}

TEST(Units, GiveTheSameBitsForTheSameLengthInAnyPrefix) {
  EXPECT_EQ(value_of("250 mm"), 0.25);
  EXPECT_EQ(value_of("0.35 m"), value_of("350 mm"));
  EXPECT_EQ(value_of("0.3 uT"), 0.3e-6);
  EXPECT_EQ(value_of("266.6 kHz"), 266600.0);
  EXPECT_EQ(value_of("0.1 km"), value_of("1e4 cm"));
  EXPECT_EQ(value_of("3.4 mT"), value_of("34 G"));
}

TEST(Units, AreUnderstoodWithAndWithoutASpace) {
  EXPECT_EQ(value_of("250mm"), 0.25);
  EXPECT_EQ(value_of(" 1e-3 m "), 1e-3);
  EXPECT_EQ(value_of("+1E3m"), 1e3);
  EXPECT_EQ(value_of("-.5 mT"), -0.5e-3);
  EXPECT_EQ(value_of("5. m"), 5.0);
}

TEST(Units, TakeBothCharactersForMicroAndTheDegreeSign) {
  EXPECT_EQ(value_of("3 \u00b5m"), 3e-6);
  EXPECT_EQ(value_of("3 \u03bcm"), 3e-6);
  EXPECT_EQ(value_of("180\u00b0"), std::numbers::pi);
  EXPECT_EQ(value_of("90 deg"), std::numbers::pi / 2);
}

TEST(Units, ReadTheTypographicMinusAsTheOneOfTheKeyboard) {
  EXPECT_EQ(parse_quantity("\u22123.4e\u22123 T").value, -3.4e-3);
}

TEST(Units, TellAnglesInPiHowTheyAreWrittenHere) {
  for (const auto& [written, degrees] : {std::pair{"pi/2", "90 deg"},
                                         {"0.5 pi", "90 deg"},
                                         {"2*pi/3", "120 deg"},
                                         {"\u03c0", "180 deg"},
                                         {"-\u03c0/4 rad", "-45 deg"},
                                         {"\u2212Pi", "-180 deg"}}) {
    EXPECT_EQ(degrees_of_pi(written), degrees);
    EXPECT_EQ(parse_quantity(written, Dimension::angle).suggestion, fmt::format("write `{}`", degrees));
  }
  for (const char* none : {"pint", "pi/0", "pi+1", "30 deg", "", "a pi"}) EXPECT_EQ(degrees_of_pi(none), "");
}

TEST(Units, AreFoundInAQuantity) {
  for (const auto& [quantity, unit] : {std::pair{"280 kHz", "kHz"},
                                       {"1e3m", "m"},
                                       {"1 e", "e"},
                                       {"0.5 N m", "N m"},
                                       {"16.5 MHz/T", "MHz/T"},
                                       {"7", ""}})
    EXPECT_EQ(unit_in(quantity), unit);
}

TEST(Units, TellTheChargeEFromAPowerOfTen) {
  EXPECT_EQ(value_of("1 e"), 1.602176634e-19);
  EXPECT_EQ(value_of("-1e"), -1.602176634e-19);
  EXPECT_EQ(value_of("1e3e"), 1e3 * 1.602176634e-19);
  EXPECT_EQ(parse_quantity("1e3").dimension, Dimension::number);
}

TEST(Units, TurnAGyromagneticRatioInTurnsIntoRadians) {
  EXPECT_DOUBLE_EQ(value_of("1 Hz/T"), 2 * std::numbers::pi);
  EXPECT_NEAR(value_of("-29.1646935 MHz/T"), -1.83247174e8, 1);
  EXPECT_DOUBLE_EQ(value_of("1 MHz/G"), value_of("10 GHz/T"));
  EXPECT_EQ(value_of("5 rad/s/T"), 5.0);
}

TEST(Units, KnowTemperaturesEnergiesRatesAndAtomicLengths) {
  EXPECT_EQ(value_of("20 mK"), 0.02);
  EXPECT_EQ(value_of("1.2 kK"), 1200.0);
  EXPECT_DOUBLE_EQ(value_of("25 meV"), 25e-3 * 1.602176634e-19);
  EXPECT_DOUBLE_EQ(value_of("3 \u00b5eV"), value_of("3e-6 eV"));
  EXPECT_EQ(value_of("4 \u00c5"), 4e-10);
  EXPECT_EQ(value_of("4 \u212b"), value_of("4 angstrom"));
  EXPECT_EQ(value_of("400 pm"), value_of("0.4 nm"));
  EXPECT_EQ(value_of("1e6/s"), 1e6);
  EXPECT_EQ(value_of("5 1/s"), 5.0);
  EXPECT_DOUBLE_EQ(value_of("120 1/min"), 2.0);
  EXPECT_DOUBLE_EQ(value_of("7200 /h"), 2.0);
  EXPECT_EQ(parse_quantity("5 1/s").dimension, Dimension::rate);
}

TEST(Units, AreAbsoluteForTemperatures) {
  EXPECT_THAT(parse_quantity("20 \u00b0C", Dimension::temperature).suggestion, HasSubstr("write `293.15 K`"));
  EXPECT_THAT(parse_quantity("20 degC", Dimension::temperature).suggestion, HasSubstr("write `293.15 K`"));
}

TEST(Units, HaveEachSymbolOnceAndReadItBack) {
  for (const UnitSymbol& unit : unit_table()) {
    const ParsedQuantity parsed = parse_quantity("1 " + std::string(unit.symbol));
    EXPECT_EQ(parsed.error, "") << unit.symbol;
    EXPECT_EQ(parsed.dimension, unit.dimension) << unit.symbol;
    EXPECT_EQ(parsed.value, unit.factor) << unit.symbol;
  }
}

TEST(Units, RefuseWhatIsNoDecimalNumber) {
  for (const char* text : {"", "m", "0x10 m", "inf m", "nan", ".inf", "1_000 m", "1,5 m", "1.2.3 m", "- 1 m",
                           "--1 m", ".", "e5"})
    EXPECT_EQ(parse_quantity(text).error, "is not a number") << text;
}

TEST(Units, RefuseAsManyCommasAsATextHolds) {
  EXPECT_EQ(parse_quantity("3" + std::string(1'000'000, ',')).error, "is not a number");
}

TEST(Units, RefuseNumbersThatWouldOverflowOrVanish) {
  EXPECT_EQ(parse_quantity("1e999 m").error, "is too large for a number");
  EXPECT_EQ(parse_quantity("1e-400 m").error, "is too small for a number");
  EXPECT_EQ(parse_quantity("1e99999999999999999999 m").error, "is too large for a number");
  EXPECT_EQ(parse_quantity("1e306 km").error, "is too large for a number");
  EXPECT_EQ(parse_quantity("1e-310 u").error, "is too small for a number");
  EXPECT_EQ(value_of("0e-400 m"), 0.0);
  EXPECT_EQ(parse_quantity(std::string(100, '9') + " m").error, "has too many digits");
}

TEST(Units, SuggestTheUnitThatWasMeant) {
  EXPECT_THAT(parse_quantity("1 KHz").suggestion, HasSubstr("`kHz`"));
  EXPECT_THAT(parse_quantity("1 mt").suggestion, HasSubstr("`mT`"));
  EXPECT_EQ(parse_quantity("1 metre", Dimension::length).suggestion, "write `1 m`");
  EXPECT_EQ(parse_quantity("1 Gauss", Dimension::magnetic_field).suggestion, "write `1 G`");
  EXPECT_EQ(parse_quantity("1 Gauss", Dimension::length).suggestion, "");
  EXPECT_EQ(parse_quantity("10 muT", Dimension::magnetic_field).suggestion, "write `10 uT`");
  EXPECT_EQ(parse_quantity("10 microtesla", Dimension::magnetic_field).suggestion, "write `10 uT`");
  EXPECT_EQ(parse_quantity("3 milliGauss", Dimension::magnetic_field).suggestion, "write `3 mG`");
  EXPECT_EQ(parse_quantity("7 amu", Dimension::mass).suggestion, "write `7 u`");
  EXPECT_EQ(parse_quantity("2 inch", Dimension::length).suggestion, "write `50.8 mm`");
  EXPECT_EQ(parse_quantity("2 inch", Dimension::magnetic_field).suggestion, "");
  EXPECT_EQ(parse_quantity("0.001 c", Dimension::speed).suggestion, "write `299792.458 m/s`");
  EXPECT_EQ(parse_quantity("6 Gs", Dimension::magnetic_field).suggestion, "did you mean `G`?");  // no 6e9 s
  EXPECT_EQ(parse_quantity("1 uT/m", Dimension::field_gradient).value, 1e-6);
  EXPECT_EQ(parse_quantity("1 pT/m", Dimension::field_gradient).suggestion, "write `1e-12 T/m`");
  EXPECT_EQ(parse_quantity("-2.5e3 GT/m", Dimension::field_gradient).suggestion, "write `-2.5e12 T/m`");
  EXPECT_EQ(parse_quantity("1 uTt", Dimension::magnetic_field).suggestion, "did you mean `uT`?");
}

TEST(Units, ReadTheSameUnderALocaleWithDecimalCommas) {
  const char* const before = std::setlocale(LC_ALL, nullptr);
  const std::string kept = before ? before : "C";
  std::setlocale(LC_ALL, "de_DE.UTF-8");
  EXPECT_EQ(value_of("0.5 mm"), 0.5e-3);
  EXPECT_EQ(write_quantity(0.5, Dimension::length), "0.5 m");
  std::setlocale(LC_ALL, kept.c_str());
}

TEST(Units, WriteQuantitiesThatReadBackToTheSameBits) {
  for (int d = 0; d <= static_cast<int>(last_dimension); ++d)
    for (double x = 1.1e-30; x < 1e30; x *= 37.21) {
      const std::string text = write_quantity(-x, static_cast<Dimension>(d));
      EXPECT_EQ(value_of(text), -x) << text;
      EXPECT_EQ(parse_quantity(text).dimension, static_cast<Dimension>(d)) << text;
    }
}

TEST(Units, ArePrettyForPeople) {
  EXPECT_EQ(pretty_quantity(291600, Dimension::frequency), "291.6 kHz");
  EXPECT_EQ(pretty_quantity(0.3e-6, Dimension::magnetic_field), "300 nT");
  EXPECT_EQ(pretty_quantity(0.999999, Dimension::length), "1 m");
  EXPECT_EQ(pretty_quantity(-0.25, Dimension::length), "-250 mm");
  EXPECT_EQ(pretty_quantity(0, Dimension::speed), "0 m/s");
  EXPECT_EQ(pretty_quantity(0.25, Dimension::number), "0.25");
  EXPECT_EQ(pretty_quantity(1e-12, Dimension::length), "0.001 nm");
  EXPECT_EQ(pretty_quantity(7.517e-18, Dimension::magnetic_field), "7.517e-18 T");
  EXPECT_EQ(pretty_quantity(-1e-30, Dimension::length), "-1e-30 m");
  EXPECT_EQ(pretty_quantity(1.602176634e-47, Dimension::electric_dipole), "1e-26 e cm");
  EXPECT_EQ(pretty_quantity(4.005441585e-21, Dimension::energy), "25 meV");
  EXPECT_EQ(pretty_quantity(0.002, Dimension::temperature), "2 mK");
  EXPECT_EQ(pretty_quantity(1e6, Dimension::rate), "1e+06 1/s");
}

TEST(Units, WriteMeasuredNumbersWithTwoDigitsOfTheirUncertainty) {
  EXPECT_EQ(write_measured(42.577478461, 1.8e-8), "42.577478461(18)");
  EXPECT_EQ(write_measured(-28024.9513861, 8.7e-6), "-28024.9513861(87)");
  EXPECT_EQ(write_measured(0.39147, 3e-5), "0.391470(30)");
  EXPECT_EQ(write_measured(2.5, 0.0996), "2.50(10)");
  EXPECT_EQ(write_measured(2.5, 0.996), "2.5(10)");
  EXPECT_EQ(write_measured(1234.4, 25.4), "1234(25)");
  EXPECT_EQ(write_measured(1234.4, 2540), "1234(2540)");
  EXPECT_EQ(write_measured(-16.5, 0), "-16.5");
}

TEST(Constants, ObeyTheIdentitiesThatConnectThem) {
  using namespace constants;
  const double electron_mass = find_species("electron")->mass, proton_mass = find_species("proton")->mass;
  EXPECT_NEAR(bohr_magneton / (elementary_charge * hbar / (2 * electron_mass)), 1, 1e-9);
  EXPECT_NEAR(nuclear_magneton / (elementary_charge * hbar / (2 * proton_mass)), 1, 1e-9);
  EXPECT_NEAR(proton_mass / atomic_mass, 1.0072764665789, 1e-9);
}

}  // namespace
}  // namespace rabiline::units_test
