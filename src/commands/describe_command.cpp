// rabiline describe: parts, species, laws and their keys, from the tables that the reader uses.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands/common.hpp"
#include "manual/describe.hpp"

namespace rabiline {

void add_describe(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("describe", "explain parts, species, laws, models and their keys");
  auto topic = std::make_shared<std::vector<std::string>>();
  verb->add_option("KIND", *topic,
                   "a part, a law, a model, a species such as Rb-87, source, species, scan or units; an "
                   "overview where it is "
                   "missing");
  auto schema = std::make_shared<bool>(false);
  verb->add_flag("--schema", *schema, "print the JSON Schema of beamlines and models, for editors");
  verb->callback([topic, schema] {
    if (*schema) return put(stdout, json_schema() + "\n");
    say(stdout, "{}",
        topic->empty() ? describe_overview() : describe(fmt::format("{}", fmt::join(*topic, " "))));
  });
}

}  // namespace rabiline
