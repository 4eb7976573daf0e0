#pragma once
// Single values: numbers with their unit, counts, words. Each reader either fills `out` or reports why not.
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "beamline/beamline.hpp"
#include "core/unit_vector.hpp"
#include "input/document.hpp"
#include "input/words.hpp"
#include "parameter/parameter.hpp"
#include "particle/source.hpp"
#include "particle/species.hpp"
#include "parts/part.hpp"

namespace rabiline {

/// A row of a table without its types.
struct Row {
  std::string_view key;
  Dimension dimension;
  Range range;
  std::string_view meaning;
  std::string_view example{};  // of a struct whose values go together
};

/// Formulas that are sampled and still in use, so that points of a scan which do not touch one share its
/// maps.
class SampledFormulas {
 public:
  std::shared_ptr<const FormulaMaps> find(const FormulaBox&);
  void add(const FormulaBox&, const std::shared_ptr<const FormulaMaps>&);

 private:
  std::mutex mutex_;
  std::vector<std::pair<FormulaBox, std::weak_ptr<const FormulaMaps>>> known_;
};

/// Collects what is wrong while a tree is read, and watches which numbers were read from the scanned nodes.
struct Reading {
  struct Watched {
    const Node* node;
    std::optional<Dimension> dimension;  // set when the node was read as a number
    double value = 0;                    // [SI]
  };
  /// A file that the beamline names beside itself.
  struct File {
    std::shared_ptr<const SourceText> source;
    std::string text;
    std::shared_ptr<const Spectrum> spectrum;  // none where something is wrong with it
    std::map<std::array<MapSymmetry, 3>, std::shared_ptr<const FieldMap>>
        maps{};  // by their planes of symmetry
  };
  std::vector<Diagnostic> errors;
  std::vector<Watched> watched;
  std::string folder;                                      // of the beamline file, where paths begin
  std::shared_ptr<const std::vector<InputText>> stored{};  // texts that stand for files; null: these are read
  std::map<std::string, File> files;                       // by path, each read once

  std::shared_ptr<SampledFormulas> formulas = std::make_shared<SampledFormulas>();  // of all copies

  void error(const Place&, std::string message, std::string suggestion = {});
  void saw_number(const Node&, Dimension, double value);
};

/// What a user wrote, in back quotes; shortened, and "a list" for what does not fit in a line.
std::string quote(const Node&);
/// How a value of that dimension is written: "0.2 mm".
std::string example_for(const Row&);
/// How a bare number may have been meant: "write `6 T`, `6 mT` or `6 uT`".
std::string with_a_unit(const std::string& number, Dimension);

/// What stands behind a key in "mass: 1 kg, torque: {kind: body_fixed, size: 0.5 N m}", or nothing.
std::string_view value_in(std::string_view example, std::string_view key);

bool read_quantity(const Node&, const Row&, Reading&, double& out);
bool read_count(const Node&, const Row&, Reading&, std::uint64_t& out);
bool read_text(const Node&, const Row&, Reading&, std::string& out);
/// The index of the word. `example` helps where no word is near.
std::optional<std::size_t> read_word(const Node&, const Row&, std::span<const Word>, Reading&,
                                     std::string_view example = {});

/// A type with a way of writing of its own: how it is read, and how help and the JSON Schema show it.
/// `schema` may hold @angle and the like, which stand for the schema of that dimension.
template <class T>
struct ValueType {};
template <class T>
concept has_value_type = requires {
  ValueType<T>::example;
};

template <>
struct ValueType<bool> {
  static constexpr std::string_view example = "false", what = "true | false",
                                    schema = R"({"type": "boolean"})";
  static bool read(const Node&, const Row&, Reading&, bool& out);
};
template <>
struct ValueType<HalfInteger> {
  static constexpr std::string_view example = "1/2", what = "half or whole number up to 9/2",
                                    schema =
                                        R"({"enum": [0, "1/2", 1, "3/2", 2, "5/2", 3, "7/2", 4, "9/2"]})";
  static bool read(const Node&, const Row&, Reading&, HalfInteger& out);
};
template <>
struct ValueType<LevelName> {
  static constexpr std::string_view example = "F=4 m=0", what = "F=4 m=0 | m_J=1/2 m_I=-7/2",
                                    schema = R"({"type": "string"})";
  static bool read(const Node&, const Row&, Reading&, LevelName& out);
};
template <>
struct ValueType<Phase> {
  static constexpr std::string_view example = "random", what = "random | locked | angle",
                                    schema = R"({"anyOf": [{"enum": ["random", "locked"]}, @angle]})";
  static bool read(const Node&, const Row&, Reading&, Phase& out);
};
template <>
struct ValueType<Bins> {
  static constexpr std::string_view
      example = "[80, 80]",
      what = "[whole number, whole number]",
      schema =
          R"({"type": "array", "minItems": 2, "maxItems": 2, "items": {"type": "integer", "minimum": 1, "maximum": 10000}})";
  static bool read(const Node&, const Row&, Reading&, Bins& out);
};
/// As itself, as a wavelength or as an energy; a scan over it keeps the unit that it is written in.
template <>
struct ValueType<SpeedQuantity> {
  static constexpr std::string_view example = "1000 m/s", what = "speed, wavelength or energy",
                                    schema = R"({"anyOf": [@speed, @length, @energy]})";
  static bool read(const Node&, const Row&, Reading&, SpeedQuantity& out);
};
template <>
struct ValueType<SpectrumFile> {
  static constexpr std::string_view example = "spectrum.csv", what = "path of a CSV file",
                                    schema = R"({"type": "string"})";
  static bool read(const Node&, const Row&, Reading&, SpectrumFile& out);
};
/// The file's path, or a mapping with the planes of symmetry; the map itself is read.
template <>
struct ValueType<LoadedMap> {
  static constexpr std::string_view
      example = "quadrupole.csv",
      what = "path of a CSV or HDF5 file | {file, x, y, z}",
      schema =
          R"({"anyOf": [{"type": "string"}, {"type": "object", "required": ["file"], "properties": {"file": {"type": "string"}, "x": {"enum": ["none", "same_currents", "opposite_currents"]}, "y": {"enum": ["none", "same_currents", "opposite_currents"]}, "z": {"enum": ["none", "same_currents", "opposite_currents"]}}, "additionalProperties": false}]})";
  static bool read(const Node&, const Row&, Reading&, LoadedMap& out);
};
/// Names of the user's own and their values, of any dimension.
template <>
struct ValueType<NamedValues> {
  static constexpr std::string_view
      example = "{B0: 1 mT}",
      what = "{name: quantity, ...}",
      schema = R"({"type": "object", "additionalProperties": {"type": ["string", "number"]}})";
  static bool read(const Node&, const Row&, Reading&, NamedValues& out);
};
/// The rows of FormulaBox; the formulas are worked out.
template <>
struct ValueType<SampledFormula> {
  static constexpr std::string_view
      example =
          "{Bz: B0 + G*z, Bx: -G*x, constants: {B0: 1 mT, G: 2 T/m}, width: 1 cm, height: 1 cm, "
          "length: 10 cm, step: 1 mm}",
      what = "{Bx, By, Bz | Ex, Ey, Ez, constants, width, height, length, step, frequency, phase, duration}",
      schema =
          R"({"type": "object", "required": ["width", "height", "length", "step"], "properties": {"Bx": {"type": ["string", "number"]}, "By": {"type": ["string", "number"]}, "Bz": {"type": ["string", "number"]}, "Ex": {"type": ["string", "number"]}, "Ey": {"type": ["string", "number"]}, "Ez": {"type": ["string", "number"]}, "constants": {"type": "object", "additionalProperties": {"type": ["string", "number"]}}, "width": @length, "height": @length, "length": @length, "step": @length, "frequency": @frequency, "phase": {"anyOf": [{"enum": ["random", "locked"]}, @angle]}}, "additionalProperties": false})";
  static bool read(const Node&, const Row&, Reading&, SampledFormula& out);
};
/// `x`, `-z` or three components, which need not be normalised.
template <>
struct ValueType<UnitVector> {
  static constexpr std::string_view
      example = "z",
      what = "x | y | z | -x | -y | -z | [x, y, z]",
      schema =
          R"({"anyOf": [{"enum": ["x", "y", "z", "-x", "-y", "-z"]}, {"type": "array", "minItems": 3, "maxItems": 3, "items": {"type": "number"}}]})";
  static bool read(const Node&, const Row&, Reading&, UnitVector& out);
};

/// In any unit; whether it is that of the scan is asked where the scan is known.
template <>
struct ValueType<ScannedQuantity> {
  static constexpr std::string_view example = "5 Hz", what = "quantity of the scanned kind",
                                    schema = R"({"type": ["string", "number"]})";
  static bool read(const Node&, const Row&, Reading&, ScannedQuantity& out);
};

/// One end of a tally's axis: what it is written in follows from the quantity, so the axis reads it.
template <>
struct ValueType<AxisEnd> {
  static constexpr std::string_view example = "0", what = "value of the quantity",
                                    schema = R"({"type": ["string", "number"]})";
  static bool read(const Node&, const Row&, Reading&, AxisEnd& out);
};
/// A mapping, or the name of a quantity alone, which has a bin for each level.
template <>
struct ValueType<TallyAxis> {
  static constexpr std::string_view example = "{quantity: time_of_flight, from: 0 ms, to: 5 ms, bins: 100}",
                                    what = "{quantity, from, to, bins, axis} | level | prepared_level";
  static bool read(const Node&, const Row&, Reading&, TallyAxis& out);
};

}  // namespace rabiline
